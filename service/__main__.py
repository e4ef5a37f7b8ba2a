"""The command `paretour`, also `python -m service`."""

from collections.abc import Sequence

from service.cli.commands import app


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command."""
    app(args=arguments, prog_name="paretour")


if __name__ == "__main__":
    main()
