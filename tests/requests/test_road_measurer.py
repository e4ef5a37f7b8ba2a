"""Tasks are measured once, also those of an earlier process, and not after they are stopped."""

import asyncio
import json
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from service.errors import Cancelled, RouterUnusable
from service.requests.limits import Limits
from service.requests.road_measurer import BlockingMeasurer, RoadMeasurer, needs_roads
from service.requests.stops import Matrix, UnmeasuredStops
from service.requests.task import Task, TaskSource, parse_task
from service.roads.client import RoadClient
from service.roads.router import RouterSettings
from tests.helpers.actors import info_of
from tests.helpers.fake_router import fake_osrm, replying, road_costs, sleeping
from tests.helpers.serving import LIMITS

PLACES = np.array([[24.1, 60.2], [24.3, 60.9], [24.8, 60.5], [24.4, 60.1]])
ACTORS = {
    "pa-one": info_of("pa-one", "coordinates"),
    "pa-one-matrix": info_of("pa-one-matrix", "matrices"),
}


def _source(*measures: str) -> TaskSource:
    stops = [{"id": str(i), "location": place} for i, place in enumerate(PLACES.tolist())]
    objectives: list[dict[str, Any]] = [{"name": each, "from": each} for each in measures]
    objectives += [{"name": "risk", "matrix": np.ones((4, 4)).tolist()}]
    body = {"stops": stops, "objectives": objectives[:2]}
    return TaskSource("front", json.dumps(body).encode())


def _parsed(source: TaskSource) -> Task:
    limits: Limits = replace(LIMITS, roads=True)
    return parse_task(source, limits, ACTORS)


@contextmanager
def _blocking(settings: RouterSettings) -> Iterator[BlockingMeasurer]:
    measurer = BlockingMeasurer(RoadClient(settings))
    try:
        yield measurer
    finally:
        measurer.close()


def _settings(url: str) -> RouterSettings:
    return RouterSettings(url=url, router="osrm", profile="driving")


@pytest.mark.parametrize("parsed", [True, False])
def test_a_task_is_measured_whether_it_is_parsed_or_not(parsed: bool) -> None:
    source = _source("road_time")
    given = replace(source, task=_parsed(source)) if parsed else source

    async def measure(url: str) -> Task | None:
        measurer = RoadMeasurer(RoadClient(_settings(url)), _parsed)
        assert measurer.needed(given)
        measured = await measurer.measured(given)
        assert not measurer.needed(measured)
        await measurer.close()
        return measured.task

    with fake_osrm() as fake:
        task = asyncio.run(measure(fake.url))
    assert task is not None
    assert isinstance(task.subject, UnmeasuredStops)
    time_source, risk_source = task.subject.sources
    assert isinstance(time_source, Matrix)
    assert isinstance(risk_source, Matrix)
    np.testing.assert_array_equal(time_source.costs, road_costs(PLACES, PLACES)[0])
    assert task.timings["roads"] > 0


def test_a_task_without_roads_needs_no_engine() -> None:
    source = _source("great_circle")
    measurer = RoadMeasurer(RoadClient(_settings("http://127.0.0.1:1")), _parsed)
    assert not measurer.needed(source)
    task = _parsed(source)
    assert not needs_roads(task)
    assert not measurer.needed(replace(source, task=task))


def test_an_unparsed_task_that_only_speaks_of_roads_is_left_as_it_is() -> None:
    plane = {"coordinates": [[0, 0]]}
    objectives = [{"name": "distance", **plane}, {"name": "climb", **plane}]
    body = {"stops": [{"id": "road_side"}], "objectives": objectives}
    source = TaskSource("front", json.dumps(body).encode())

    async def measure() -> TaskSource:
        measurer = RoadMeasurer(RoadClient(_settings("http://127.0.0.1:1")), _parsed)
        assert measurer.needed(source)
        measured = await measurer.measured(source)
        await measurer.close()
        return measured

    measured = asyncio.run(measure())
    assert measured.task is not None
    assert not measured.task.timings


def test_a_process_measures_one_task_after_another() -> None:
    task = _parsed(_source("road_time", "road_distance"))
    replies = iter([None, None, (500, b"", {})])
    with ExitStack() as stack:
        fake = stack.enter_context(fake_osrm(lambda *_: next(replies, None)))
        measurer = stack.enter_context(_blocking(replace(_settings(fake.url), cache_bytes=0)))
        assert not needs_roads(measurer.measured(task, lambda: False))
        with pytest.raises(RouterUnusable):
            measurer.measured(task, lambda: False)
        assert not needs_roads(measurer.measured(task, lambda: False))


def test_a_process_that_is_told_to_stop_waits_no_longer() -> None:
    task = _parsed(_source("road_time"))
    with fake_osrm(sleeping(1.0)) as fake, _blocking(_settings(fake.url)) as measurer:
        began = time.monotonic()
        with pytest.raises(Cancelled):
            measurer.measured(task, lambda: time.monotonic() > began + 0.2)
        assert time.monotonic() - began < 0.7
        fake.misbehave = replying(500)
        with pytest.raises(RouterUnusable):
            measurer.measured(task, lambda: False)
