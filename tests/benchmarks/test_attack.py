"""The crowds of `attack`: they reach a service, and note what must not be."""

import multiprocessing
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from typing import Any

import psutil
import pytest

from service.api.app import Edge
from service.api.transport.connections import ConnectionLimits
from tests.benchmarks import attack, crowds
from tests.benchmarks.crowds import Crowds
from tests.helpers.serving import app_of, serving


@contextmanager
def answering(status: int, content: bytes) -> Iterator[tuple[str, int]]:
    """Serve this answer to every request that plans, in a thread until the block ends."""

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            self.rfile.read(int(self.headers["Content-Length"]))
            self._answer(status, content)

        def do_GET(self) -> None:
            self._answer(404, b"{}")

        def log_message(self, *_: object) -> None:
            pass

        def _answer(self, status: int, content: bytes) -> None:
            self.send_response(status)
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    thread = Thread(target=server.serve_forever)
    thread.start()
    try:
        yield ("127.0.0.1", server.server_port)
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


Attack = Callable[[Crowds, tuple[str, int], float], dict[str, Any]]


@pytest.fixture(scope="module")
def seen_by() -> Iterator[Attack]:
    """Attack in a process of its own, as the benchmark does, and return what was seen."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        yield lambda kinds, address, seconds: pool.submit(
            crowds.attack, address, seconds, kinds
        ).result()


@pytest.mark.parametrize(
    ("status", "content", "fault"),
    [
        (500, b"{}", "500 {}"),
        (422, b'{"actual": NaN}', "NaN is not JSON"),
        (200, b'{"front": []}', "a front without a tour"),
        (202, b'{"id": "x"}', "job x is lost: 404"),
    ],
)
def test_a_crowd_notes_what_must_not_be(
    seen_by: Attack, status: int, content: bytes, fault: str
) -> None:
    name = "repeats of a key"
    with answering(status, content) as address:
        seen = seen_by({name: crowds.CROWDS[name]}, address, 3)
    assert seen[name]["answers"][str(status)]
    assert seen[name]["faults"][0].startswith(fault)


def test_every_crowd_reaches_a_service_and_sees_no_fault_of_it(seen_by: Attack) -> None:
    two_of_each = {name: kind._replace(count=2) for name, kind in crowds.CROWDS.items()}
    limits = ConnectionLimits(head_seconds=0.5)
    app = app_of(edge=Edge(body_seconds=0.5))
    with serving(app, connections=limits) as url:
        address = ("127.0.0.1", int(url.rpartition(":")[2]))
        seen = seen_by(two_of_each, address, 6)
    assert [name for name, each in seen.items() if not each["answers"]] == []
    assert [each["faults"] for each in seen.values()] == [[]] * len(seen)


def test_honest_requests_are_asked_for_when_due_and_told_lost() -> None:
    with serving(app_of()) as url:
        address = ("127.0.0.1", int(url.rpartition(":")[2]))
        answers = attack.honest(address, 2)
    assert [answer.status for answer in answers] == [200] * 4
    assert {answer.status for answer in attack.honest(address, 1)} == {0}


def test_memory_counts_the_pages_of_children_and_shared_ones_once() -> None:
    def hold() -> None:
        mine = bytearray(50 * 2**20)
        mine[::4096] = b"x" * len(mine[::4096])
        time.sleep(3)

    shared = bytearray(100 * 2**20)
    shared[::4096] = b"x" * len(shared[::4096])
    context = multiprocessing.get_context("fork")
    own = attack._pages(psutil.Process().pid)
    # Servers of the tests before leave processes behind.
    others = sum(attack._pages(each.pid) for each in psutil.Process().children(recursive=True))
    with attack.Memory(psutil.Process()) as memory:
        child = context.Process(target=hold)
        child.start()
        child.join()
    # Twice would be as much again: the child shares all that this process has.
    assert 0.9 * (own + others) + 45 * 2**20 < memory.largest < 1.8 * own + others
