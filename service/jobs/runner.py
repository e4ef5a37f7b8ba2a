"""Run a task in a worker process: from its source to the JSON of its front."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from service.actor import NamedActor, load_actors
from service.coverage.coverage import Coverage
from service.coverage.survey import CoveragePath, Survey, survey
from service.errors import Cancelled, NoTour
from service.instance import Instance, cumulated_lengths
from service.jobs.compiled_code import warm_up
from service.jobs.fleets.fleet_run import run_fleet
from service.jobs.fleets.robot_run import run_robots
from service.jobs.front_document import FrontDocument, encode_front
from service.planner import Front, plan
from service.replanning.replan import replan
from service.requests.fleets.subject import UnmeasuredFleet
from service.requests.limits import Limits, within_network
from service.requests.maps.robots import SharedCoverage
from service.requests.road_measurer import BlockingMeasurer, needs_roads
from service.requests.stops import UnmeasuredStops, make_instance
from service.requests.task import Task, TaskSource, check_instance, parse_task
from service.roads.client import RoadClient
from service.roads.router import RouterSettings
from service.search.improve import Progress

REPORT_TOURS = 100  # at most in a reported front
REPORT_SECONDS = 0.25  # at least between two reports
REPORT_SHARE = 0.05  # the share of the time that reports may take

Report = Callable[[Progress, Callable[[int], FrontDocument]], None]


class Runner(Protocol):
    """Runs tasks, one at a time."""

    def warm_up(self) -> None:
        """Compile the search, or load it from the cache."""

    def run(
        self, task: TaskSource | Task, stop: Callable[[], bool], report: Report
    ) -> FrontDocument:
        """Return the front of a task, parsed or not.

        Args:
            task: The task, or its source.
            stop: Called often; planning ends soon after it returns True.
            report: Called now and then with the progress, and with a function that writes the best
                n tours found so far, which is valid until the report returns.
        """

    def terminate(self) -> None:
        """End the running call of a network, if one runs; from any thread."""


MakeRunner = Callable[[], Runner]


@dataclass(frozen=True)
class TaskRunner:
    """Plans fronts within limits, with the actors that are loaded.

    With a measurer, it asks for missing costs by road.
    """

    actors: Mapping[str, NamedActor]
    limits: Limits
    measurer: BlockingMeasurer | None = None

    def warm_up(self) -> None:
        """Open the networks, and compile the search or load it from the cache."""
        for actor in self.actors.values():
            actor.load()
        warm_up()

    def parse(self, source: TaskSource) -> Task:
        """Return the task in a source; the exceptions are those of `parse_task`."""
        infos = {name: actor.info for name, actor in self.actors.items()}
        return parse_task(source, self.limits, infos)

    def run(
        self, task: TaskSource | Task, stop: Callable[[], bool], report: Report
    ) -> FrontDocument:
        """Return the front of a task, parsed or not."""
        if isinstance(task, TaskSource):
            task = self.parse(task)
        if self.measurer is not None and needs_roads(task):
            task = self.measurer.measured(task, stop)
        if isinstance(task.subject, UnmeasuredFleet):
            return run_fleet(task, task.subject, self.actors.get(task.actor), stop, report)
        if isinstance(task.subject, SharedCoverage):
            actor = self.actors.get(task.actor)
            return run_robots(task, task.subject, actor, self.limits, stop, report)
        if isinstance(task.subject, Coverage):
            return self._cover(task, task.subject, stop, report)
        if isinstance(task.subject, UnmeasuredStops):
            return self._plan_stops(task, task.subject, stop, report)
        return self._plan_instance(task, task.subject, stop, report, {})

    def terminate(self) -> None:
        """End the running call of a network, if one runs; from any thread."""
        for actor in self.actors.values():
            actor.terminate()

    def _plan_stops(
        self, task: Task, stops: UnmeasuredStops, stop: Callable[[], bool], report: Report
    ) -> FrontDocument:
        began = time.perf_counter()
        instance = make_instance(stops)
        check_instance(task, instance)
        timings = {**task.timings, "costs": 1000 * (time.perf_counter() - began)}
        return self._plan_instance(task, instance, stop, report, timings)

    def _plan_instance(
        self,
        task: Task,
        instance: Instance,
        stop: Callable[[], bool],
        report: Report,
        timings: Mapping[str, float],
    ) -> FrontDocument:
        """Plan the front of an instance, whose costs took these milliseconds to find."""
        front = self._plan(task, instance, stop, report)
        if timings:
            front = replace(front, timings={**timings, **front.timings})
        arrivals = _arrivals(task, instance, front)
        return encode_front(front, self._identity(task), labels=task.labels, arrivals=arrivals)

    def _cover(
        self, task: Task, coverage: Coverage, stop: Callable[[], bool], report: Report
    ) -> FrontDocument:
        began = time.perf_counter()
        surveyed = survey(coverage, self.limits.most_places(shared=False), stop)
        check_instance(task, surveyed.instance)
        survey_seconds = time.perf_counter() - began
        options = within_network(task.options, surveyed.instance.n, self.limits)
        task = replace(task, options=replace(options, start=surveyed.start))
        front = self._plan(task, surveyed.instance, stop, report, surveyed)
        began = time.perf_counter()
        paths = self._paths(surveyed, front, stop) if task.paths else None
        timings = {
            "survey": 1000 * survey_seconds,
            **front.timings,
            "paths": 1000 * (time.perf_counter() - began),
        }
        front = replace(front, timings=timings)
        arrivals = _arrivals(task, surveyed.instance, front)
        return encode_front(front, self._identity(task), surveyed, paths, arrivals=arrivals)

    def _paths(
        self, surveyed: Survey, front: Front, stop: Callable[[], bool]
    ) -> list[CoveragePath] | None:
        """Return the path of each tour; None if the task is stopped."""
        try:
            return list(surveyed.paths(front.tours, self.limits.path_cells, stop))
        except Cancelled:
            return None

    def _plan(
        self,
        task: Task,
        instance: Instance,
        stop: Callable[[], bool],
        report: Report,
        surveyed: Survey | None = None,
    ) -> Front:
        identity = self._identity(task)

        def report_encoded(progress: Progress, best: Callable[[int], Front]) -> None:
            report(
                progress,
                lambda size: encode_front(best(size), identity, surveyed, labels=task.labels),
            )

        actor = self.actors[task.actor]
        try:
            if task.earlier is not None:
                return replan(actor, instance, task.options, task.earlier, stop, report_encoded)
            return plan(actor, instance, task.options, stop, report_encoded)
        except NoTour as refusal:
            raise refusal.named(task.city_names) from None

    def _identity(self, task: Task) -> dict[str, str]:
        return self.actors[task.actor].info.identity


def _arrivals(task: Task, instance: Instance, front: Front) -> NDArray[np.float64] | None:
    """Return both lengths of each tour up to each of its stops, where the task asks for them."""
    return cumulated_lengths(instance, front.tours) if task.arrivals else None


class Reporter:
    """Sends progress with the best front now and then; less often if sending takes long."""

    def __init__(self, send: Callable[[Progress, FrontDocument], None]) -> None:
        self._send = send
        self._next = time.monotonic() + REPORT_SECONDS

    def __call__(self, progress: Progress, best: Callable[[int], FrontDocument]) -> None:
        """Send a report, if one is due."""
        began = time.monotonic()
        if began < self._next:
            return
        self._send(progress, best(REPORT_TOURS))
        ended = time.monotonic()
        self._next = ended + max(REPORT_SECONDS, (ended - began) / REPORT_SHARE)


def load_runner(
    directory: Path,
    threads: int,
    limits: Limits,
    own_directory: Path | None = None,
    roads: RouterSettings | None = None,
) -> TaskRunner:
    """Return a runner with the actors of a directory, and of one of the user's.

    With a routing engine, it asks that for missing costs by road.
    """
    measurer = None if roads is None else BlockingMeasurer(RoadClient(roads))
    return TaskRunner(load_actors(directory, threads, own_directory), limits, measurer)
