"""Tasks are measured once, and not after they are stopped."""

import asyncio
import json
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from threading import Event
from typing import Any

import numpy as np
import pytest

from service.errors import Cancelled, RouterUnusable
from service.kinds.parsing import parse_task
from service.requests.limits import Limits
from service.requests.road_measurer import BlockingMeasurer, measured_by_road
from service.requests.stops import Matrix, Stops
from service.requests.task import Task, TaskSource, UnmeasuredFleet
from service.requests.task_codec import decode_task, encode_task
from service.roads.client import RoadClient
from service.roads.router import RouterSettings
from tests.helpers.actors import info_of
from tests.helpers.fake_router import fake_osrm, replying, road_costs, waiting
from tests.helpers.fake_traffic import SLOWER, fake_traffic
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


def test_a_task_is_measured_once() -> None:
    task = _parsed(_source("road_time"))
    assert task.needs_roads

    async def measure(url: str) -> Task:
        client = RoadClient(_settings(url))
        try:
            return await measured_by_road(task, client)
        finally:
            await client.close()

    with fake_osrm() as fake:
        measured = asyncio.run(measure(fake.url))
    assert not measured.needs_roads
    assert isinstance(measured.subject, Stops)
    time_source, risk_source = measured.subject.sources
    assert isinstance(time_source, Matrix)
    assert isinstance(risk_source, Matrix)
    np.testing.assert_array_equal(time_source.costs, road_costs(PLACES, PLACES)[0])
    assert measured.timings["roads"] > 0


def test_vehicles_of_each_profile_are_measured_by_themselves() -> None:
    stops = [{"id": str(i), "location": place} for i, place in enumerate(PLACES.tolist())]
    vehicles = [{"id": "van"}, {"id": "lorry", "profile": "truck"}, {"id": "car"}]
    time, metres = ({"name": each, "from": each} for each in ("road_time", "road_distance"))
    body = {"stops": stops, "vehicles": vehicles, "objectives": [time, metres]}
    limits = replace(LIMITS, roads=True, profiles=("truck",))
    task = parse_task(TaskSource("fleet", json.dumps(body).encode()), limits, ACTORS)
    task = decode_task(encode_task(task))
    with fake_osrm() as fake:
        settings = replace(_settings(fake.url), profiles={"truck": "truck"})
        with _blocking(settings) as measurer:
            measured = measurer.measured(task, lambda: False)
    assert isinstance(measured.subject, UnmeasuredFleet)
    fleet, seconds = measured.subject.fleet(), road_costs(PLACES, PLACES)[0]
    for vehicle, times in ((0, 1), (1, 2), (2, 1)):
        assert fleet.legs_along(0, (0, 1, 3), vehicle) == [
            pytest.approx(times * seconds[leg]) for leg in ((0, 1), (1, 3))
        ]
        assert fleet.legs_along(1, (0, 1), vehicle) == [road_costs(PLACES, PLACES)[1][0, 1]]


def test_vehicles_of_each_profile_have_the_traffic_of_each_time() -> None:
    stops = [{"id": str(i), "location": place} for i, place in enumerate(PLACES.tolist())]
    vehicles = [{"id": "van"}, {"id": "lorry", "profile": "truck"}]
    traffic = {"date": "2026-11-30", "at": [6 * 3600, 7 * 3600]}
    time = {"name": "time", "from": "road_time", "traffic": traffic}
    metres = {"name": "metres", "from": "road_distance", "over_the_day": [[0, 1], [3600, 2]]}
    body = {"stops": stops, "vehicles": vehicles, "objectives": [time, metres], "clock": "time"}
    limits = replace(LIMITS, roads=True, traffic=True, profiles=("truck",))
    task = parse_task(TaskSource("fleet", json.dumps(body).encode()), limits, ACTORS)
    task = decode_task(encode_task(task))
    with fake_traffic() as fake:
        settings = replace(_settings(fake.url), router="valhalla", profile="auto")
        with _blocking(replace(settings, profiles={"truck": "truck"})) as measurer:
            measured = measurer.measured(task, lambda: False)
    asked = {(each["costing"], each.get("date_time", {}).get("value")) for each in fake.asked}
    times = (None, "2026-11-30T06:00", "2026-11-30T07:00")
    assert asked == {(costing, time) for costing in ("auto", "truck") for time in times}
    assert isinstance(measured.subject, UnmeasuredFleet)
    seconds, metres_of = road_costs(PLACES, PLACES)
    for seconds_by, metres_by in measured.subject.fleet().days:
        assert seconds_by.at(7 * 3600, 0, 1) == pytest.approx(SLOWER * seconds[0, 1])
        assert metres_by.at(7 * 3600, 0, 1) == pytest.approx(2 * metres_of[0, 1])


def test_a_task_without_roads_needs_no_engine() -> None:
    assert not _parsed(_source("great_circle")).needs_roads


def test_a_process_measures_one_task_after_another() -> None:
    task = _parsed(_source("road_time", "road_distance"))
    replies = iter([None, None, (500, b"", {})])
    with ExitStack() as stack:
        fake = stack.enter_context(fake_osrm(lambda *_: next(replies, None)))
        measurer = stack.enter_context(_blocking(replace(_settings(fake.url), cache_bytes=0)))
        assert not measurer.measured(task, lambda: False).needs_roads
        with pytest.raises(RouterUnusable):
            measurer.measured(task, lambda: False)
        assert not measurer.measured(task, lambda: False).needs_roads


def test_a_process_that_is_told_to_stop_waits_no_longer() -> None:
    task = _parsed(_source("road_time"))
    gate = Event()
    with fake_osrm(waiting(gate)) as fake, _blocking(_settings(fake.url)) as measurer:
        with pytest.raises(Cancelled):
            measurer.measured(task, lambda: len(fake.asked) > 0)
        gate.set()
        fake.misbehave = replying(500)
        with pytest.raises(RouterUnusable):
            measurer.measured(task, lambda: False)
