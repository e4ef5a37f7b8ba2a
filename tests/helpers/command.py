"""The command `paretour`, run as a process of its own."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "service/examples/city-deliveries.json"
COMMAND = [sys.executable, "-m", "service"]


def paretour(*arguments: object, **settings: str) -> subprocess.CompletedProcess[str]:
    """Run the command to its end, with settings from the environment."""
    return subprocess.run(
        [*COMMAND, *map(str, arguments)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
        env={**os.environ, **settings},
    )


@contextmanager
def started(*arguments: object, stderr: int | None = None) -> Iterator[subprocess.Popen[bytes]]:
    """Start the command, which SIGINT interrupts as Ctrl-C does, and wait for its end.

    Under nohup and in the background of a shell this process ignores SIGINT, and so would the
    command. A signal that is handled here when the command starts has its default effect there.
    """
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        process = subprocess.Popen(
            [*COMMAND, *map(str, arguments)], cwd=ROOT, stdout=subprocess.PIPE, stderr=stderr
        )
    finally:
        signal.signal(signal.SIGINT, before)
    with process:
        yield process
