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
from pathlib import Path

import httpx

from tests.helpers.ports import free_port

PATIENCE = 300.0  # seconds, against hanging
_LINES = 20  # of a log, in an error
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
        tempfile.NamedTemporaryFile() as log,
        subprocess.Popen(command, env=environment, stderr=log) as process,
    ):
        service = ServeProcess(f"http://127.0.0.1:{port}", process)
        try:
            url = f"{service.url}/health/{'ready' if ready else 'live'}"
            until_ok(url, process, Path(log.name))
            yield service
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(timeout=60)
            service.log = Path(log.name).read_bytes()


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


def until_ok(url: str, process: subprocess.Popen[bytes], log: Path) -> None:
    """Wait until a service answers with 200; an error has the last lines that it logged."""
    ends = time.monotonic() + PATIENCE
    while time.monotonic() < ends and process.poll() is None:
        with suppress(httpx.TransportError):
            if httpx.get(url).status_code == 200:
                return
        time.sleep(0.05)
    # Our own questions are logged too.
    lines = [line for line in log.read_text().splitlines() if '"request"' not in line]
    came = f"in {PATIENCE:g} s" if process.poll() is None else "before the service ended"
    raise TimeoutError("\n".join([f"{url} did not answer with 200 {came}:", *lines[-_LINES:]]))
