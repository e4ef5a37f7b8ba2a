"""Run a task in a worker process: from its source to the JSON of its front."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from service.actor import NamedActor, load_actors
from service.actor_info import ActorInfo
from service.coverage.coverage import Coverage
from service.coverage.path import CoveragePath
from service.coverage.survey import Survey, survey
from service.errors import Cancelled, NoTour
from service.front import Front, Progress
from service.instance import Instance, cumulated_lengths
from service.jobs.compiled_code import warm_up
from service.jobs.fleets.fleet_run import run_fleet
from service.jobs.fleets.robot_run import run_robots
from service.jobs.front_document import FrontDocument
from service.jobs.runner import Report
from service.jobs.tour_document import encode_front
from service.planner import plan
from service.replanning.replan import replan
from service.requests.fleets.subject import UnmeasuredFleet
from service.requests.limits import Limits, within_network
from service.requests.maps.robots import SharedCoverage
from service.requests.parser import check_instance
from service.requests.road_measurer import BlockingMeasurer, needs_roads
from service.requests.stops import Stops
from service.requests.stored_task import read_task
from service.requests.task import Task, TaskSource
from service.roads.client import RoadClient
from service.roads.router import RouterSettings


@dataclass(frozen=True)
class TaskRunner:
    """Plans fronts within limits, with the actors that are loaded.

    With a measurer, it asks for the costs by road of tasks that come without.
    """

    actors: Mapping[str, NamedActor]
    limits: Limits
    measurer: BlockingMeasurer | None = None

    def warm_up(self) -> None:
        """Open the networks, and compile the search or load it from the cache."""
        for actor in self.actors.values():
            actor.load()
        warm_up()

    @property
    def infos(self) -> Mapping[str, ActorInfo]:
        """The metadata of the actors by name."""
        return {name: actor.info for name, actor in self.actors.items()}

    def read(self, source: TaskSource) -> Task:
        """Return a stored task; errors as of `read_task`."""
        return read_task(source, self.limits, self.infos)

    def run(self, task: Task, stop: Callable[[], bool], report: Report) -> FrontDocument:
        """Return the front of a task."""
        if self.measurer is not None and needs_roads(task):
            task = self.measurer.measured(task, stop)
        if isinstance(task.subject, UnmeasuredFleet):
            return run_fleet(task, task.subject, self.actors.get(task.actor), stop, report)
        if isinstance(task.subject, SharedCoverage):
            actor = self.actors.get(task.actor)
            return run_robots(task, task.subject, actor, self.limits, stop, report)
        if isinstance(task.subject, Coverage):
            return self._cover(task, task.subject, stop, report)
        return self._plan_stops(task, task.subject, stop, report)

    def terminate(self) -> None:
        """End the running call of a network, if one runs; from any thread."""
        for actor in self.actors.values():
            actor.terminate()

    def _plan_stops(
        self, task: Task, stops: Stops, stop: Callable[[], bool], report: Report
    ) -> FrontDocument:
        began = time.perf_counter()
        instance, timings = stops.instance, {}
        if task.timings or not stops.measured:  # else it was checked when it came
            check_instance(task, instance)
            timings = {**task.timings, "costs": 1000 * (time.perf_counter() - began)}
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
        """Return the path of each tour; None where the task is stopped, which waits for none."""
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


def load_runner(
    directory: Path,
    threads: int,
    limits: Limits,
    own_directory: Path | None = None,
    roads: RouterSettings | None = None,
) -> TaskRunner:
    """Return a runner with the actors of a directory, and of one of the user's.

    With a routing engine, it asks that for the costs by road of tasks that come without.

    Raises:
        ValueError: As of load_actors.
    """
    measurer = None if roads is None else BlockingMeasurer(RoadClient(roads))
    return TaskRunner(load_actors(directory, threads, own_directory), limits, measurer)
