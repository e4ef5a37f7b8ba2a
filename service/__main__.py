"""The command `paretour`, also `python -m service`."""

import sys
from collections.abc import Sequence

from service.own_code import keep_for_children

_INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command; Ctrl-C while it loads ends it as it does later."""
    try:
        keep_for_children()
        from service.cli.commands import app
    except KeyboardInterrupt:
        sys.exit(_INTERRUPTED)
    app(args=arguments, prog_name="paretour")


if __name__ == "__main__":
    main()
