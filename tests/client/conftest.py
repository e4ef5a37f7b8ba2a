"""Clients of both kinds, and services for them."""

import asyncio
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest
from paretour import AsyncClient, Client

from tests.helpers.answers import Connect
from tests.helpers.serving import LIMITS, app_of, serving
from tests.helpers.sync_adapter import SyncAdapter


@pytest.fixture(params=[Client, AsyncClient])
def connect(request: pytest.FixtureRequest) -> Iterator[Connect]:
    """A function that makes a client of either kind, to be called as if it were synchronous."""
    with asyncio.Runner() as runner:
        opened = []

        def make(url: str = "http://service", **options: Any) -> Any:
            made = request.param(url, **options)
            opened.append(made if isinstance(made, Client) else SyncAdapter(made, runner))
            return opened[-1]

        yield make
        for client in opened:
            client.close()


@pytest.fixture(scope="package")
def url() -> Iterator[str]:
    with serving(app_of()) as address:
        yield address


@pytest.fixture(scope="package")
def long_search_url() -> Iterator[str]:
    """The address of a service that lets a search take a minute."""
    with serving(app_of(limits=replace(LIMITS, seconds=60, cities=300))) as address:
        yield address
