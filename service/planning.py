"""What a worker process does with a request: from JSON to a front as JSON."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

from service import improve, shortest
from service.actor import ActorFacts, load_actors
from service.asked import parse
from service.coverage import survey
from service.covering import CoverageRequest
from service.messages import Work
from service.planner import Constructor, Report, plan
from service.rendered import Rendered, Sketch, rendered, sketched
from service.roster import choose_actor
from service.schemas import FrontRequest, Limits


class NamedActor(Constructor, Protocol):
    """A constructor that says who it is."""

    @property
    def facts(self) -> ActorFacts:
        """Who it is."""


@dataclass(frozen=True)
class FrontPlanner:
    """Plans what is asked for within the limits, with the actors that it has."""

    actors: Mapping[str, NamedActor]
    limits: Limits

    def warm_up(self) -> None:
        """Compile the search, or load it."""
        improve.warm_up()
        shortest.warm_up()

    def plan(
        self, work: Work, stop: Callable[[], bool], report: Callable[[Sketch], None]
    ) -> Rendered:
        """The front that a request asks for."""
        match parse(work, self.limits):
            case CoverageRequest() as asked:
                return self._cover(asked, stop, report)
            case asked:
                actor = self._actor(asked)
                named = actor.facts.named
                sketch = _sketching(report, actor=named)
                front = plan(actor, asked.instance(), asked.demand(), stop, sketch)
                return rendered(front, actor=named)

    def _cover(
        self, asked: CoverageRequest, stop: Callable[[], bool], report: Callable[[Sketch], None]
    ) -> Rendered:
        actor = self._actor(asked)
        began = time.perf_counter()
        found = survey(asked.coverage(), self.limits.cities, stop)
        surveyed = time.perf_counter()
        more = {"actor": actor.facts.named, "places": found.places.tolist()}
        front = plan(actor, found.instance, asked.demand(), stop, _sketching(report, **more))
        planned = time.perf_counter()
        # Who stops the work is not kept waiting.
        paths = list(found.paths(front.tours)) if asked.paths and not stop() else None
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

    def _actor(self, asked: FrontRequest | CoverageRequest) -> NamedActor:
        facts = {name: actor.facts for name, actor in self.actors.items()}
        return self.actors[choose_actor(facts, asked.kind, asked.named_actor)]


def _sketching(report: Callable[[Sketch], None], **more: Any) -> Report:
    return lambda interim: report(sketched(interim, **more))


def load_planner(directory: Path, threads: int, limits: Limits) -> FrontPlanner:
    """A planner with the actors of a directory."""
    return FrontPlanner(load_actors(directory, threads), limits)
