"""Measure tasks by road: ask a routing engine for the costs that they lack."""

import asyncio
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from service.errors import Cancelled, Refusal
from service.errors.parts import by_stop
from service.requests.stops import Array, Measured, Stops, Traffic
from service.requests.task import Task, UnmeasuredFleet
from service.roads.client import RoadClient
from service.search.forbidden_legs import check_ways

_POLL_SECONDS = 0.05  # between two checks whether to stop


async def measured_by_road(task: Task, client: RoadClient) -> Task:
    """Return a task with its costs by road, and the time that it took to ask for them.

    Raises:
        Refusal: Every tour has a leg for which the engine knows no way, or the engine fails; see
            RoadClient.costs.
    """
    try:
        return await _measured(task, client)
    except Refusal as refusal:
        raise by_stop(refusal, task.city_names) from None


async def _measured(task: Task, client: RoadClient) -> Task:
    subject, labels = task.subject, task.labels
    assert isinstance(subject, Stops | UnmeasuredFleet)
    assert labels is not None
    began = time.perf_counter()
    stops = subject.stops
    ids = [stop.id for stop in labels.stops]
    found: dict[Measured | Traffic, Array] = {}
    for profile in stops.road_profiles:
        costs = await client.costs(stops.locations, ids, profile)
        found[Measured("road_time", profile=profile)] = costs.seconds
        found[Measured("road_distance", profile=profile)] = costs.metres
    for each in stops.traffic:
        found[each] = await client.seconds_at(each.departures, stops.locations, ids, each.profile)
    if subject is stops:  # a fleet may leave stops out
        n = len(ids)
        none = [np.isinf(costs.reshape(-1, n, n)).any(axis=0) for costs in found.values()]
        check_ways(np.logical_or.reduce(none), stops.ends, task.city_names, "no-road")
    measured = subject.measured_by_road(found)
    return replace(task, subject=measured, timings={"roads": 1000 * (time.perf_counter() - began)})


class BlockingMeasurer:
    """Measures the tasks of a process that runs one at a time."""

    def __init__(self, client: RoadClient) -> None:
        self._client = client
        self._runner = asyncio.Runner()

    def measured(self, task: Task, stop: Callable[[], bool]) -> Task:
        """Return the task with its costs by road.

        Raises:
            Cancelled: `stop` returned True before.
            Refusal: The costs cannot be found; see RoadClient.costs.
        """
        return self._runner.run(self._until_stopped(task, stop))

    def close(self) -> None:
        """Close the connections to the engine."""
        self._runner.run(self._client.close())
        self._runner.close()

    async def _until_stopped(self, task: Task, stop: Callable[[], bool]) -> Task:
        asking = asyncio.create_task(measured_by_road(task, self._client))
        try:
            while not asking.done():
                if stop():
                    raise Cancelled
                await asyncio.wait((asking,), timeout=_POLL_SECONDS)
            return asking.result()
        finally:
            asking.cancel()
