"""The engine of a replica, with one worker: time limits, clients that leave, lost messages."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from functools import partial

import httpx
import pytest
from redis.asyncio import Redis as AsyncRedis

from service.api.app import Edge
from service.cluster.redis_engine import RedisEngine
from service.cluster.redis_store import RedisStore
from tests.helpers.actors import Shuffler
from tests.helpers.engines import PATIENT, Served, engine_of
from tests.helpers.jobs import LONG, check, ended, first_found, later
from tests.helpers.serving import engine_app, problem, serving

Serve = Callable[..., AbstractContextManager[Served]]


@pytest.fixture(scope="module")
def actor(tmp_path_factory: pytest.TempPathFactory) -> Shuffler:
    actor = Shuffler(tmp_path_factory.mktemp("gated") / "gate")
    actor.open()
    return actor


@pytest.fixture(scope="module")
def serve(request: pytest.FixtureRequest, actor: Shuffler) -> Iterator[Serve]:
    """Serves with a replica in this process, all with the same worker."""
    with engine_of("cluster", request) as cluster:
        yield partial(cluster.serve, actor)


def test_who_waits_too_long_is_given_the_best_front_so_far(serve: Serve) -> None:
    with serve(edge=Edge(request_seconds=2.0)) as served:
        answer = first_found(served.client, LONG).json()
        assert (answer["status"], answer["terminated"]) == ("done", "time_limit")
        check(answer)


def test_work_that_found_nothing_in_time_is_504_and_its_worker_is_free_again(
    serve: Serve, actor: Shuffler
) -> None:
    actor.close()
    with serve(edge=Edge(request_seconds=1.0)) as served:
        problem(served.client.post("/front", json=LONG), 504, "overdue")
        actor.open()
        assert ended(served.client, later(served.client))["status"] == "done"


def test_a_client_that_goes_away_frees_its_worker(serve: Serve) -> None:
    with serve() as served:
        with pytest.raises(httpx.ReadTimeout):
            served.client.post("/front", json=LONG, timeout=1)
        assert ended(served.client, later(served.client))["status"] == "done"


def test_a_job_whose_message_was_lost_is_done_all_the_same(serve: Serve) -> None:
    with serve() as served:
        connection = AsyncRedis.from_url(served.redis_url)
        store = RedisStore(connection, entries=9, max_age=60)
        forgetful = RedisEngine(connection, store, lambda _: None, queue=8)
        app = engine_app(store, forgetful, limits=PATIENT)
        with serving(app) as url, httpx.Client(base_url=url) as client:
            path = later(client)
        assert ended(served.client, path)["status"] == "done"
