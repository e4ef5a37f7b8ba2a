"""The commands `paretour serve` and `paretour work` as processes of their own."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass

import httpx

from tests.helpers.ports import free_port

UNLIMITED = "1000000/second"  # for tests and benchmarks, which all call from one address


@dataclass
class ServeProcess:
    """A running `paretour serve`; `log` is what it wrote to standard error, once it has ended."""

    url: str
    process: subprocess.Popen[bytes]
    log: bytes = b""

    @property
    def tracebacks(self) -> Counter[str]:
        """How often each error was logged with a traceback: what was said, and its last line."""
        lines = [json.loads(line) for line in self.log.splitlines() if b"Traceback" in line]
        return Counter(f"{line['message']}: {line['exc_info'].splitlines()[-1]}" for line in lines)


@contextmanager
def serve_process(
    settings: Mapping[str, str], ready: bool = False, descriptors: int | None = None
) -> Iterator[ServeProcess]:
    """Run `paretour serve` with these environment variables until the block ends.

    Args:
        settings: environment variables beside the test's own; by default there is no rate.
        ready: whether to wait until its workers are warm, and not only until it answers. Without,
            the search is interpreted, because compiled code would not be used.
        descriptors: how many files and sockets it may have open, as by `ulimit -n`.
    """
    port = free_port()
    command = [sys.executable, "-m", "service", "serve", "--port", str(port)]
    if descriptors is not None:
        command = ["bash", "-c", f'ulimit -n {descriptors}; exec "$@"', "bash", *command]
    defaults = {"NUMBA_DISABLE_JIT": "0" if ready else "1", "PARETOUR_RATE": UNLIMITED}
    environment = {**os.environ, **defaults, **settings}
    with (
        tempfile.TemporaryFile() as log,
        subprocess.Popen(command, env=environment, stderr=log) as process,
    ):
        service = ServeProcess(f"http://127.0.0.1:{port}", process)
        try:
            _wait_until_ok(f"{service.url}/health/{'ready' if ready else 'live'}")
            yield service
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(timeout=60)
            log.seek(0)
            service.log = log.read()


@contextmanager
def work_process(settings: Mapping[str, str]) -> Iterator[subprocess.Popen[bytes]]:
    """Run `paretour work` with these environment variables until the block ends."""
    command = [sys.executable, "-m", "service", "work"]
    environment = {**os.environ, **settings}
    with subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL) as process:
        try:
            yield process
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(timeout=60)


def _wait_until_ok(url: str) -> None:
    deadline = time.monotonic() + 300
    while time.monotonic() < deadline:
        with suppress(httpx.ConnectError):
            if httpx.get(url).status_code == 200:
                return
        time.sleep(0.05)
    raise TimeoutError(f"{url} must answer within five minutes")
