"""On many machines the worker that takes a job asks the routing engine."""

import time
from functools import partial

import httpx
import numpy as np

from service.jobs.task_runner import load_runner
from service.server import Ending, build
from service.settings import Settings
from tests.helpers.celery_workers import celery_worker
from tests.helpers.cluster_state import ClusterState
from tests.helpers.fake_router import BEYOND, fake_osrm, road_costs
from tests.helpers.processes import UNLIMITED
from tests.helpers.redis_server import Redis
from tests.helpers.serving import problem, serving

PLACES = np.array([[24.1, 60.2], [24.3, 60.9], [24.8, 60.5], [24.4, 60.1], [24.9, 60.9]])


def _request(places: np.ndarray) -> dict[str, object]:
    return {
        "stops": [{"id": f"s{i}", "location": place} for i, place in enumerate(places.tolist())],
        "objectives": [
            {"name": "time", "from": "road_time"},
            {"name": "distance", "from": "road_distance"},
        ],
        "time_limit": 0.1,
    }


def test_the_worker_asks_the_engine_and_refuses_what_it_cannot_reach(redis: Redis) -> None:
    with fake_osrm() as fake:
        settings = Settings(
            redis_url=f"{redis.url.removesuffix('/0')}/7",
            router_url=fake.url,
            router="osrm",
            rate=UNLIMITED,
        )
        assert settings.redis_url is not None
        make_runner = partial(load_runner, settings.actors, 1, settings.limits)
        with (
            celery_worker(settings.redis_url, make_runner, 60.0, 1, settings.roads),
            serving(build(settings, Ending())) as url,
        ):
            while not ClusterState(settings.redis_url).workers():
                time.sleep(0.05)
            answer = httpx.post(f"{url}/front", json=_request(PLACES), timeout=300).json()
            costs = road_costs(PLACES, PLACES)
            for each in answer["front"]:
                tour = each["tour"]
                lengths = costs[:, tour, np.roll(tour, -1)].sum(axis=1)
                np.testing.assert_allclose(each["lengths"], lengths)
            assert answer["timings_ms"]["roads"] > 0
            apart = PLACES + np.array([[BEYOND, 0]] + 4 * [[0, 0]])
            refused = httpx.post(f"{url}/front", json=_request(apart), timeout=300)
            assert "'s0'" in problem(refused, 422, "no-road")["detail"]
