"""The command `paretour`, also `python -m service`."""

import os
import sys
from collections.abc import Sequence

from service.own_code import keep_for_children

_INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command; Ctrl-C while it loads ends it as it does later."""
    arguments = sys.argv[1:] if arguments is None else arguments
    try:
        keep_for_children()
        if arguments[:1] == ["serve"]:
            _start_fork_server()
        from service.cli.commands import app
    except KeyboardInterrupt:
        sys.exit(_INTERRUPTED)
    app(args=arguments, prog_name="paretour")


def _start_fork_server() -> None:
    """Start the process that workers are forked from: it imports as long as this process does."""
    from service.jobs.workers import fork_server

    if not any(name.upper() == "PARETOUR_REDIS_URL" for name in os.environ):
        fork_server.start()


if __name__ == "__main__":
    main()
