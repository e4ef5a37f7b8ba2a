"""The commands of an operator: serve, work, key."""

import sys

import typer

from service.api.auth import KeyHash, new_key
from service.cli.errors import UsageError, configured, ended, explaining, loaded
from service.server import build, build_work, serve, takes_work


def run_serve(host: str | None, port: int | None, workers: int | None) -> None:
    """Answer requests until told to stop. What is None is left to the settings."""
    with explaining():
        settings = configured(host=host, port=port, workers=workers)
        app = loaded(build, settings)
    serve(app, settings)


STALLED = 1


def run_work(workers: int | None) -> None:
    """Plan what replicas ask for until told to stop. What is None is left to the settings."""
    with explaining():
        work = loaded(build_work, configured(workers=workers))
    sys.exit(work())


def run_alive() -> None:
    """End with 0, or where what works on this machine takes no work with 1."""
    with explaining():
        if not loaded(takes_work, configured()):
            raise ended("no worker of this machine takes what waits", STALLED)


def run_key(caller: str) -> None:
    """Print a new key, and what the settings need to know of it."""
    key, digest = new_key()
    with explaining():
        try:
            KeyHash(caller=caller, digest=digest)
        except ValueError as error:
            raise UsageError(str(error)) from None
    typer.echo(f"{key}\n{caller}:{digest}")
    typer.echo("The key, for its caller alone; then its entry for PARETOUR_API_KEYS.", err=True)
