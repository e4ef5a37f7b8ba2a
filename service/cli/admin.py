"""The commands of an operator: serve, work and key."""

import sys
from functools import partial

import typer

from service.api.auth import KeyHash, new_key
from service.cli.configuration import load_settings, load_with
from service.cli.errors import EXIT_STALLED, UsageError, exit_on_error, exit_with
from service.server import Ending, build, build_worker, serve, takes_work


def run_serve(host: str | None, port: int | None, workers: int | None) -> None:
    """Answer requests until a signal ends it. An option that is None is left to the settings."""
    with exit_on_error():
        settings = load_settings(host=host, port=port, workers=workers)
        ending = Ending()
        app = load_with(partial(build, ending=ending), settings)
    serve(app, settings, ending)


def run_work(workers: int | None) -> None:
    """Run a worker of a cluster until a signal ends it; exit with its status."""
    with exit_on_error():
        work = load_with(build_worker, load_settings(workers=workers))
    sys.exit(work())


def run_alive() -> None:
    """Exit with 0 if the worker on this machine takes tasks, with EXIT_STALLED if it does not."""
    with exit_on_error():
        if not load_with(takes_work, load_settings()):
            raise exit_with("no worker on this machine takes waiting tasks", EXIT_STALLED)


def run_key(caller: str) -> None:
    """Print a new API key for a caller, and its entry for PARETOUR_API_KEYS."""
    key, digest = new_key()
    with exit_on_error():
        try:
            KeyHash(caller=caller, digest=digest)
        except ValueError as error:
            raise UsageError(str(error)) from None
    typer.echo(f"{key}\n{caller}:{digest}")
    typer.echo("The key, for its caller alone; then its entry for PARETOUR_API_KEYS.", err=True)
