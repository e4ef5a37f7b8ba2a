"""The command `paretour`."""

import argparse
from collections.abc import Sequence

from pydantic import ValidationError

from service.serve import build, serve
from service.settings import Settings


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
    serve(app, settings)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("paretour", description="Pareto fronts of tours, over HTTP.")
    commands = parser.add_subparsers(dest="command", required=True)
    command = commands.add_parser(
        "serve", help="answer requests; other settings come from PARETOUR_* variables"
    )
    for option, kind in (("host", str), ("port", int), ("workers", int)):
        # What is not given is left to the settings.
        command.add_argument(
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


if __name__ == "__main__":
    main()
