"""Measure tasks by road: ask a routing engine for the costs that they lack."""

import asyncio
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from service.errors import Cancelled
from service.requests.fleets.subject import UnmeasuredFleet
from service.requests.stops import UnmeasuredStops
from service.requests.task import Task, TaskSource
from service.roads.client import RoadClient
from service.search.forbidden_legs import check_ways

_POLL_SECONDS = 0.05  # between two checks whether to stop


def needs_roads(task: Task) -> bool:
    """Return whether a task lacks costs by road."""
    match task.subject:
        case UnmeasuredStops() as stops:
            return bool(stops.road_measures)
        case UnmeasuredFleet(stops=stops):
            return bool(stops.road_measures)
    return False


async def measured_by_road(task: Task, client: RoadClient) -> Task:
    """Return a task with its costs by road, and the time that it took to ask for them.

    Raises:
        Refusal: Every tour has a leg for which the engine knows no way, or the engine fails; see
            RoadClient.costs.
    """
    subject, labels = task.subject, task.labels
    assert isinstance(subject, UnmeasuredStops | UnmeasuredFleet)
    assert labels is not None
    began = time.perf_counter()
    stops = subject.stops if isinstance(subject, UnmeasuredFleet) else subject
    costs = await client.costs(stops.locations, [stop.id for stop in labels.stops])
    if isinstance(subject, UnmeasuredStops):
        check_ways(np.isinf(costs.seconds), subject.ends, task.city_names, "no-road")
    measured = subject.measured_by_road({"road_time": costs.seconds, "road_distance": costs.metres})
    return replace(task, subject=measured, timings={"roads": 1000 * (time.perf_counter() - began)})


class RoadMeasurer:
    """Measures the tasks of an engine that runs in an event loop.

    Args:
        client: The client of the routing engine.
        parse: Parses the source of a job that an earlier process left unfinished.
    """

    def __init__(self, client: RoadClient, parse: Callable[[TaskSource], Task]) -> None:
        self._client = client
        self._parse = parse

    def needed(self, source: TaskSource) -> bool:
        """Return whether costs by road are missing, or may be missing if the task is not parsed."""
        if source.task is not None:
            return needs_roads(source.task)
        return b"road_" in source.body

    async def measured(self, source: TaskSource) -> TaskSource:
        """Return the source with a task that has its costs by road.

        Raises:
            Refusal: The costs cannot be found; see RoadClient.costs.
        """
        task = source.task
        if task is None:
            task = await asyncio.to_thread(self._parse, source)
        if needs_roads(task):
            task = await measured_by_road(task, self._client)
        return replace(source, task=task)

    async def close(self) -> None:
        """Close the connections to the engine."""
        await self._client.close()


class BlockingMeasurer:
    """Measures the tasks of a process that runs one at a time."""

    def __init__(self, client: RoadClient) -> None:
        self._client = client
        self._runner = asyncio.Runner()

    def measured(self, task: Task, stop: Callable[[], bool]) -> Task:
        """Return the task with its costs by road.

        Raises:
            Cancelled: It was told to stop before.
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
