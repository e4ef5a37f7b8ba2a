"""Listening sockets, and how many connections descriptors are left for."""

import asyncio
import errno
import resource
import socket
from typing import Any

import pytest

from service.api.transport.listener import ListeningSocket, bound_sockets, most_connections


def test_without_descriptors_a_line_a_second_is_logged_and_idle_connections_are_closed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def accept(_: socket.socket) -> tuple[int, Any]:
        raise OSError(errno.EMFILE, "Too many open files")

    monkeypatch.setattr(socket.socket, "accept", accept)
    closed: list[None] = []
    logged = []

    async def main() -> None:
        loop = asyncio.get_running_loop()
        loop.set_exception_handler(lambda _, context: logged.append(context["message"]))
        [listening] = bound_sockets("127.0.0.1", 0, lambda: closed.append(None))
        server = await loop.create_server(asyncio.Protocol, sock=listening, backlog=16)
        with socket.create_connection(listening.getsockname()):
            await asyncio.sleep(1.5)
        server.close()
        # asyncio's next try, which it had scheduled, finds no socket any more
        await asyncio.sleep(0.6)

    asyncio.run(main())
    assert 1 <= len([each for each in logged if "out of system resource" in each]) <= 3
    assert 1 <= len(closed) <= 3


def test_an_address_that_is_taken_leaves_no_socket_open() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken, pytest.raises(OSError, match="in use"):
        bound_sockets("127.0.0.1", taken.getsockname()[1], lambda: None)


def test_a_name_is_listened_to_at_all_its_addresses() -> None:
    sockets = bound_sockets("localhost", 0, lambda: None)
    assert {each.family for each in sockets} <= {socket.AF_INET, socket.AF_INET6}
    assert all(isinstance(each, ListeningSocket) for each in sockets)
    for each in sockets:
        each.close()


@pytest.mark.parametrize(
    ("descriptors", "most"), [(1024, 864), (100_000, 1000), (64, 8), (resource.RLIM_INFINITY, 1000)]
)
def test_connections_leave_descriptors_for_everything_else(
    monkeypatch: pytest.MonkeyPatch, descriptors: int, most: int
) -> None:
    monkeypatch.setattr(resource, "getrlimit", lambda _: (descriptors, descriptors))
    assert most_connections(1000, workers=4) == most
