"""The command `paretour`, run in a process of its own."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory

from service.__main__ import main

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "service/examples/city-deliveries.json"
COMMAND = [sys.executable, "-m", "service"]


def paretour(
    *arguments: object, folder: Path = ROOT, **settings: str
) -> subprocess.CompletedProcess[str]:
    """Run the command to its end in a folder, with settings from the environment.

    It is forked like a worker of the service, with the compiled search in memory: to start Python
    and to load that takes as long as the rest of most commands.
    """
    command = ["paretour", *map(str, arguments)]
    with TemporaryDirectory() as written:
        streams = [Path(written, name) for name in ("stdout", "stderr")]
        process = get_context("forkserver").Process(
            target=_run, args=(command, folder, {**os.environ, **settings}, streams)
        )
        process.start()
        process.join()
        stdout, stderr = (stream.read_text() for stream in streams)
    assert process.exitcode is not None
    return subprocess.CompletedProcess(command, process.exitcode, stdout, stderr)


def _run(command: list[str], folder: Path, settings: dict[str, str], streams: list[Path]) -> None:
    os.environ.clear()
    os.environ.update(settings)
    os.chdir(folder)
    for descriptor, stream in enumerate(streams, start=1):
        os.dup2(os.open(stream, os.O_WRONLY | os.O_CREAT), descriptor)
    sys.argv = command
    main()


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
