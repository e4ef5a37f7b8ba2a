"""How property tests run: never against a clock, and in continuous integration always alike."""

import os
from collections.abc import Iterator

import pytest
from hypothesis import settings

from tests.helpers.redis_server import Redis, redis_server

settings.register_profile("project", deadline=None, derandomize="CI" in os.environ)
settings.load_profile("project")


@pytest.fixture(scope="session")
def redis(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Redis]:
    """A real Redis, for tests that leave it running."""
    with redis_server(tmp_path_factory.mktemp("redis")) as server:
        yield server
