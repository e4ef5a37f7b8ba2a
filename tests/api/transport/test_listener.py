"""Listening sockets, and how many connections descriptors are left for."""

import resource
import socket

import pytest

from service.api.transport.listener import bound_sockets, most_connections


def test_an_address_that_is_taken_leaves_no_socket_open() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken, pytest.raises(OSError, match="in use"):
        bound_sockets("127.0.0.1", taken.getsockname()[1])


def test_a_name_is_listened_to_at_all_its_addresses() -> None:
    sockets = bound_sockets("localhost", 0)
    assert {each.family for each in sockets} <= {socket.AF_INET, socket.AF_INET6}
    for each in sockets:
        each.close()


@pytest.mark.parametrize(
    ("descriptors", "most"), [(1024, 736), (100_000, 1000), (64, 8), (resource.RLIM_INFINITY, 1000)]
)
def test_connections_leave_descriptors_for_everything_else(
    monkeypatch: pytest.MonkeyPatch, descriptors: int, most: int
) -> None:
    monkeypatch.setattr(resource, "getrlimit", lambda _: (descriptors, descriptors))
    assert most_connections(1000, workers=4) == most
