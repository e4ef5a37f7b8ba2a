"""The command `paretour`, run in this process, or in one of its own."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import chdir, contextmanager, redirect_stderr, redirect_stdout
from io import BytesIO, TextIOWrapper
from pathlib import Path
from unittest.mock import patch

from service.__main__ import main

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "service/examples/city-deliveries.json"
COMMAND = [sys.executable, "-m", "service"]


def paretour(
    *arguments: object, folder: Path = ROOT, **settings: str
) -> subprocess.CompletedProcess[str]:
    """Run the command to its end in a folder, with settings from the environment.

    It runs in this process: to import what plans takes another longer than most commands.
    """
    command = [str(argument) for argument in arguments]
    stdout, stderr = (TextIOWrapper(BytesIO(), encoding="utf-8") for _ in range(2))
    status: object = 0
    with (
        patch.dict(os.environ, settings),  # and without what the command sets
        chdir(folder),
        redirect_stdout(stdout),
        redirect_stderr(stderr),
    ):
        try:
            main(command)
        except SystemExit as ended:
            status = ended.code or 0
    assert isinstance(status, int), status
    return subprocess.CompletedProcess(command, status, _written(stdout), _written(stderr))


def _written(stream: TextIOWrapper) -> str:
    stream.seek(0)
    return stream.read()


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
