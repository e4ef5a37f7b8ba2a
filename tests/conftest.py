"""Set-up of every test run: Ctrl-C, property tests, and the servers that a session shares."""

import gc
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from httpx._config import DEFAULT_TIMEOUT_CONFIG
from hypothesis import settings

from service.jobs.compiled_code import warm_up
from tests.helpers.artifacts import by_coordinates, by_row_sums
from tests.helpers.redis_server import Redis, redis_server
from tests.helpers.sampled import third
from tests.helpers.serving import serving_released
from tests.helpers.valhalla import RunningValhalla, valhalla_service

NO_CERTIFICATES = Path(__file__).parent
LONGEST = ("tests/cluster/", "tests/search/", "tests/test_", "tests/webhooks/")

settings.register_profile(
    "project", deadline=None, derandomize="CI" in os.environ, max_examples=third(100)
)
settings.load_profile("project")


def pytest_configure(config: pytest.Config) -> None:
    """Prepare what child processes inherit: Ctrl-C, threads, certificates, the compiled search."""
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # see tests/__init__.py
    # A shell starts background jobs, and nohup its command, with SIGINT ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    # Tests run side by side; torch's threads spin while they wait, and take the cores from others.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    # No test calls https, and httpx takes 40 ms to load certificates at each httpx.get.
    os.environ.pop("SSL_CERT_FILE", None)
    os.environ["SSL_CERT_DIR"] = str(NO_CERTIFICATES)
    # On a busy machine an answer may take longer than the five seconds that httpx waits.
    DEFAULT_TIMEOUT_CONFIG.read = 60.0
    if config.getoption("numprocesses") and not hasattr(config, "workerinput"):
        warm_up()  # once, before the processes of the tests and of their servers all do it at once
    else:
        gc.disable()  # until the tests are collected, which takes half as long without


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest files, so that no process has one left when the others are done."""
    items.sort(key=lambda item: not item.nodeid.startswith(LONGEST))


def pytest_collection_finish() -> None:
    """Collect garbage again, and look for none among what was imported and collected."""
    gc.freeze()
    gc.enable()


@pytest.fixture(scope="session")
def redis(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Redis]:
    """A real Redis, for tests that leave it running."""
    with redis_server(tmp_path_factory.mktemp("redis")) as server:
        yield server


@pytest.fixture(scope="session")
def valhalla(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningValhalla]:
    """A real routing engine of central Helsinki, for tests that leave it running."""
    with valhalla_service(tmp_path_factory.mktemp("valhalla")) as running:
        yield running


@pytest.fixture(scope="session")
def compiled() -> None:
    """The compiled search, for tests that give it some tenths of a second to search in."""
    warm_up()


@pytest.fixture(scope="session")
def quick_actors(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The setting of networks that are opened in no time, for processes where any will do.

    To open those released takes each process that plans two seconds and more.
    """
    folder = tmp_path_factory.mktemp("actors")
    by_coordinates(folder / "pa-one.onnx", "pa-one")
    by_row_sums(folder / "pa-one-matrix.onnx", "pa-one-matrix")
    return {"PARETOUR_ACTORS": str(folder)}


@pytest.fixture(scope="session")
def released() -> Iterator[str]:
    """The address of the service with the released actors and one worker."""
    with serving_released() as address:
        yield address
