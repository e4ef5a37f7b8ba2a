"""The client that places in the queue are counted for: the caller, or without keys the address."""

import pytest
from starlette.requests import Request

from service.api.auth import client_of
from service.api.middleware import ANONYMOUS


@pytest.mark.parametrize(
    ("caller", "address", "client"),
    [
        ("us", "10.0.0.1", "us"),
        (ANONYMOUS, "10.0.0.1", "10.0.0.1"),
        (ANONYMOUS, "2001:db8:1:2:3:4:5:6", "2001:db8:1:2::/64"),
        (ANONYMOUS, "2001:db8:1:2:ffff::1", "2001:db8:1:2::/64"),
        (ANONYMOUS, "not:an:address", "not:an:address"),
        (ANONYMOUS, None, ""),
    ],
)
def test_places_are_counted_for_a_caller_or_its_address(
    caller: str, address: str | None, client: str
) -> None:
    scope = {"type": "http", "caller": caller, "client": address and (address, 1)}
    assert client_of(Request(scope)) == client
