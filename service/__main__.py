"""The command `paretour`, also `python -m service`."""

import codecs
import os
import sys
from collections.abc import Sequence
from io import TextIOWrapper

from service.own_code import keep_for_children

_INTERRUPTED = 130
_USAGE = 2


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command; Ctrl-C while it loads ends it as it does later."""
    arguments = sys.argv[1:] if arguments is None else arguments
    _let_print_any_name()
    try:
        keep_for_children()
        if arguments[:1] == ["serve"]:
            _start_fork_server()
        from service.cli.commands import app
    except KeyboardInterrupt:
        sys.exit(_INTERRUPTED)
    app(args=arguments, prog_name="paretour")


def _let_print_any_name() -> None:
    """Let stdout take every character: as UTF-8 in place of ASCII, else escaped if it must be."""
    if not isinstance(sys.stdout, TextIOWrapper):
        return
    if codecs.lookup(sys.stdout.encoding).name == "ascii":
        sys.stdout.reconfigure(encoding="utf-8")
    sys.stdout.reconfigure(errors="backslashreplace")


def _start_fork_server() -> None:
    """Start the process that workers are forked from: it imports as long as this process does."""
    from service.jobs.workers import fork_server

    if any(name.upper() == "PARETOUR_REDIS_URL" for name in os.environ):
        return
    try:
        fork_server.start()
    except OSError as error:  # the folder for its socket cannot be used
        sys.stderr.write(f"paretour: TMPDIR must be a folder that can be written: {error}\n")
        sys.exit(_USAGE)


if __name__ == "__main__":
    main()
