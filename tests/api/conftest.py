"""A service that the tests of the HTTP interface share where any will do."""

from collections.abc import Iterator

import httpx
import pytest

from tests.helpers.serving import app_of, serving


@pytest.fixture(scope="session")
def client() -> Iterator[httpx.Client]:
    """A client of the service with actors that shuffle, for tests that leave it as it was."""
    with serving(app_of()) as address, httpx.Client(base_url=address, timeout=300) as client:
        yield client
