"""What a worker process does with a task: a front as JSON."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

from service.actor import ActorInfo, load_actors
from service.coverage import shortest_paths
from service.coverage.survey import Coverage, survey
from service.jobs.front_document import FrontDocument, Sketch, rendered, sketched
from service.planner import Constructor, Report, plan
from service.requests.limits import Limits
from service.requests.task import Task, Work, read
from service.search import improve


class NamedActor(Constructor, Protocol):
    """A constructor that says who it is."""

    @property
    def info(self) -> ActorInfo:
        """Who it is."""


@dataclass(frozen=True)
class TaskRunner:
    """Plans what is asked for within the limits, with the actors that it has."""

    actors: Mapping[str, NamedActor]
    limits: Limits

    def warm_up(self) -> None:
        """Compile the search, or load it."""
        warm_up()

    def plan(
        self, work: Work | Task, stop: Callable[[], bool], report: Callable[[Sketch], None]
    ) -> FrontDocument:
        """The front that is asked for, by work that has not been read yet, or by what it says."""
        task = work if isinstance(work, Task) else read(work, self.limits, self._facts)
        actor = self.actors[task.actor]
        if isinstance(task.subject, Coverage):
            return self._cover(task, task.subject, stop, report)
        named = actor.info.identity
        sketch = _sketching(report, actor=named)
        return rendered(plan(actor, task.subject, task.demand, stop, sketch), actor=named)

    def _cover(
        self,
        task: Task,
        coverage: Coverage,
        stop: Callable[[], bool],
        report: Callable[[Sketch], None],
    ) -> FrontDocument:
        actor = self.actors[task.actor]
        began = time.perf_counter()
        found = survey(coverage, self.limits.cities, stop)
        surveyed = time.perf_counter()
        more = {"actor": actor.info.identity, "places": found.places.tolist()}
        front = plan(actor, found.instance, task.demand, stop, _sketching(report, **more))
        planned = time.perf_counter()
        # Who stops the work is not kept waiting.
        paths = list(found.paths(front.tours)) if task.paths and not stop() else None
        timings = {
            "survey": 1000 * (surveyed - began),
            **front.timings,
            "paths": 1000 * (time.perf_counter() - planned),
        }
        return rendered(
            replace(front, timings=timings),
            [{"path": {"cells": path.cells.tolist(), "metres": path.metres}} for path in paths]
            if paths
            else None,
            **more,
        )

    @property
    def _facts(self) -> dict[str, ActorInfo]:
        return {name: actor.info for name, actor in self.actors.items()}


def _sketching(report: Callable[[Sketch], None], **more: Any) -> Report:
    return lambda interim: report(sketched(interim, **more))


def warm_up() -> None:
    """Compile all that is compiled, or load it, where this process has not."""
    improve.warm_up()
    shortest_paths.warm_up()


def load_planner(directory: Path, threads: int, limits: Limits) -> TaskRunner:
    """A planner with the actors of a directory."""
    return TaskRunner(load_actors(directory, threads), limits)
