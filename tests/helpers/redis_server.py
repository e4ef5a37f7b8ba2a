"""A redis-server process on a port of its own, which tests may end and begin again."""

import shutil
import socket
import subprocess
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from tests.helpers.ports import free_port
from tests.helpers.required import give_up

FORGETFUL = ("redis-server", "--save", "", "--appendonly", "no")
LASTING = ("redis-server", "--save", "", "--appendonly", "yes")


@dataclass
class Redis:
    """A server with its files in a folder; it keeps port and folder when it begins again."""

    port: int
    folder: Path
    command: Sequence[str]
    process: subprocess.Popen[bytes] | None = None

    @property
    def url(self) -> str:
        """Its first database."""
        return f"redis://127.0.0.1:{self.port}/0"

    def begin(self) -> None:
        """Start the process, and wait until it listens."""
        options = ["--port", str(self.port), "--bind", "127.0.0.1", "--dir", str(self.folder)]
        self.process = subprocess.Popen(
            [*self.command, *options], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        _wait_until_listening(self.port)

    def end(self) -> None:
        """Kill the process."""
        if self.process is not None:
            self.process.kill()
            self.process.wait()


@contextmanager
def redis_server(folder: Path, command: Sequence[str] = FORGETFUL) -> Iterator[Redis]:
    """Run redis-server with these options until the block ends; skip where it is not installed."""
    if shutil.which("redis-server") is None:
        give_up("redis-server is not installed")
    port = free_port()
    redis = Redis(port, folder, command)
    try:
        redis.begin()
        yield redis
    finally:
        redis.end()


def _wait_until_listening(port: int) -> None:
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        with suppress(OSError):
            socket.create_connection(("127.0.0.1", port), timeout=1).close()
            return
        time.sleep(0.02)
    raise TimeoutError("redis-server must listen within 60 s")
