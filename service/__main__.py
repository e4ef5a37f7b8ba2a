"""The command `paretour`: reads the settings, puts everything together, serves it."""

import argparse
import signal
import sys
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from types import FrameType
from typing import NoReturn

import uvicorn
from fastapi import FastAPI
from pydantic import ValidationError

from service.actor import load_actors
from service.app import create_app
from service.improve import warm_up
from service.settings import Settings
from service.store import Store
from service.workers import Workers


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command."""
    parser = _parser()
    given = vars(parser.parse_args(arguments))
    del given["command"]
    try:
        settings = Settings(**given)
        app = build(settings)
    except ValidationError as error:
        parser.error(_explained(error))
    except (OSError, ValueError) as error:
        parser.error(str(error))
    # Without a handler, uvicorn ends by the signal and the exit status says so.
    signal.signal(signal.SIGTERM, _exit)
    uvicorn.run(
        app,
        host=settings.host,
        port=settings.port,
        server_header=False,
        timeout_graceful_shutdown=settings.drain_seconds,
    )


def build(settings: Settings) -> FastAPI:
    """The application that the settings ask for."""
    return create_app(
        load_actors(settings.actors, settings.threads),
        Store(settings.store_entries, settings.store_seconds),
        Workers(settings.workers, settings.queue, warm_up),
        settings.limits,
        _version(),
    )


def _version() -> str:
    try:
        return version("paretour")
    except PackageNotFoundError:
        return "not installed"


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("paretour", description="Pareto fronts of tours, over HTTP.")
    commands = parser.add_subparsers(dest="command", required=True)
    serve = commands.add_parser(
        "serve", help="answer requests; other settings come from PARETOUR_* variables"
    )
    for option, kind in (("host", str), ("port", int), ("workers", int)):
        # What is not given is left to the settings.
        serve.add_argument(
            f"--{option}",
            type=kind,
            default=argparse.SUPPRESS,
            help=Settings.model_fields[option].description,
        )
    return parser


def _explained(error: ValidationError) -> str:
    return "; ".join(
        f"{'.'.join(str(part) for part in fault['loc'])}: {fault['msg']}, got {fault['input']!r}"
        for fault in error.errors()
    )


def _exit(_signal: int, _frame: FrameType | None) -> NoReturn:
    sys.exit(0)


if __name__ == "__main__":
    main()
