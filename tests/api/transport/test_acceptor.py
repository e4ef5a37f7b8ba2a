"""Connections that are accepted: whose turn it is, and what happens where there are too many."""

import asyncio
import errno
import socket
from collections.abc import Awaitable, Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import pytest

from service.api.transport.acceptor import Acceptor, WaitingConnections
from service.api.transport.connections import PROXY, ConnectionLimits, Connections

CROWD, HONEST = "127.0.0.2", "127.0.0.3"


def test_addresses_take_turns() -> None:
    with socket_pool() as new:
        waiting = WaitingConnections(most=8)
        crowd, honest = [new() for _ in range(3)], new()
        for each in crowd:
            waiting.append(CROWD, each)
        waiting.append(HONEST, honest)
        assert [waiting.take() for _ in range(len(waiting))] == [crowd[0], honest, *crowd[1:]]


def test_where_too_many_wait_the_longest_line_loses_its_last() -> None:
    with socket_pool() as new:
        waiting = WaitingConnections(most=3)
        first, last, honest = new(), new(), new()
        for network, each in ((CROWD, first), (HONEST, honest), (CROWD, last)):
            assert waiting.make_room()
            waiting.append(network, each)
        assert waiting.make_room()
        assert last.fileno() == -1
        assert [waiting.take(), waiting.take()] == [first, honest]
        assert len(waiting) == 0


def test_the_line_of_proxies_is_not_cut() -> None:
    with socket_pool() as new:
        waiting = WaitingConnections(most=2)
        waiting.append(PROXY, new())
        waiting.append(PROXY, new())
        assert not waiting.make_room()
        assert len(waiting) == 2


def test_a_connection_overtakes_a_crowd_that_came_before_it() -> None:
    async def test(connect: Connect, served: list[str]) -> None:
        for _ in range(50):
            connect(CROWD)
        connect(HONEST)
        while len(served) < 51:
            await asyncio.sleep(0.01)
        assert served.index(HONEST) < 8

    beside_an_acceptor(test)


def test_without_descriptors_one_line_is_logged_and_an_idle_connection_makes_way(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def accept(_: socket.socket) -> tuple[int, Any]:
        raise OSError(errno.EMFILE, "Too many open files")

    monkeypatch.setattr(socket.socket, "accept", accept)
    made_room: list[None] = []
    monkeypatch.setattr(Connections, "make_room", lambda _: made_room.append(None))

    async def test(connect: Connect, served: list[str]) -> None:
        connect(HONEST)
        while not made_room:
            await asyncio.sleep(0.01)
        monkeypatch.undo()
        while not served:
            await asyncio.sleep(0.01)

    beside_an_acceptor(test)
    assert len(made_room) == 1
    assert [each.message for each in caplog.records if each.name == "paretour"] == [
        "no connection can be accepted for 1 s: [Errno 24] Too many open files"
    ]


Connect = Callable[[str], None]


def beside_an_acceptor(test: Callable[[Connect, list[str]], Awaitable[None]]) -> None:
    """Run a test with a function that connects from an address, and the addresses served so far."""
    served: list[str] = []

    class Note(asyncio.Protocol):
        def connection_made(self, transport: asyncio.BaseTransport) -> None:
            served_by = transport.get_extra_info("socket")
            assert served_by.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
            served.append(transport.get_extra_info("peername")[0])
            transport.close()

    async def main() -> None:
        listening = socket.create_server(("127.0.0.1", 0), backlog=100)
        address = listening.getsockname()
        acceptor = Acceptor(Connections(ConnectionLimits()))
        acceptor.start([listening], Note)
        with ExitStack() as clients:

            def connect(source: str) -> None:
                clients.enter_context(socket.create_connection(address, 10, (source, 0)))

            try:
                await asyncio.wait_for(test(connect, served), timeout=60)
            finally:
                acceptor.close()

    asyncio.run(main())


@contextmanager
def socket_pool() -> Iterator[Callable[[], socket.socket]]:
    """Yield a function that makes sockets, which are closed at the end."""
    with ExitStack() as stack:
        yield lambda: stack.enter_context(socket.socket())
