"""What a worker process does with a request: from JSON to a front as JSON."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from service.actor import ActorFacts, load_actors
from service.improve import warm_up
from service.messages import Work
from service.planner import Constructor, Report, plan
from service.rendered import Rendered, rendered
from service.requests import parse_front_request
from service.roster import choose_actor
from service.schemas import Limits


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
        warm_up()

    def plan(self, work: Work, stop: Callable[[], bool], report: Report) -> Rendered:
        """The front that a request asks for."""
        request = parse_front_request(work.body, self.limits)
        loaded = {name: actor.facts for name, actor in self.actors.items()}
        actor = self.actors[choose_actor(loaded, request.kind, request.named_actor)]
        front = plan(actor, request.instance(), request.demand(), stop, report)
        facts = {"name": actor.facts.name, "digest": actor.facts.digest}
        return rendered(front, actor=facts)


def load_planner(directory: Path, threads: int, limits: Limits) -> FrontPlanner:
    """A planner with the actors of a directory."""
    return FrontPlanner(load_actors(directory, threads), limits)
