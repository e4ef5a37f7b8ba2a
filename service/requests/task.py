"""Parse a request body into a Task: what is to be planned, how, and by which actor."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from service.actor import ActorInfo
from service.coverage.survey import Coverage
from service.errors import Refusal
from service.instance import Instance, Kind
from service.planner import PlanOptions
from service.requests.coverage import parse_coverage_request
from service.requests.front import parse_front_request
from service.requests.limits import Limits

TaskKind = Literal["front", "coverage"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Task:
    """Cities, or places on a map, what is asked of their front, and the actor that begins it.

    Over a map, each tour may come with its path.
    """

    subject: Instance | Coverage
    demand: PlanOptions
    actor: str
    paths: bool = False

    @property
    def needs_compiled_code(self) -> bool:
        """Whether more than the network is asked for."""
        return isinstance(self.subject, Coverage) or self.demand.needs_compiled_code


@dataclass(frozen=True)
class TaskSource:
    """The bytes of a request, from which its task is parsed, and the task once it is.

    Attributes:
        kind: The kind of request.
        body: JSON.
        upload: The content of the file that came beside the body, if one did.
        task: The parsed task, so that a worker need not parse it again.
    """

    kind: TaskKind
    body: bytes
    upload: bytes | None = None
    task: Task | None = field(default=None, compare=False, repr=False)


def parse_task(source: TaskSource, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
    """Parse and check a request.

    Raises:
        Refusal: It is malformed, over a limit, or no actor serves it.
        InvalidInstance: It cannot be planned.
    """
    if source.kind == "coverage":
        covering = parse_coverage_request(source.body, limits, source.upload)
        return Task(
            subject=covering.coverage(),
            demand=covering.demand(),
            actor=choose_actor(actors, covering.kind, covering.named_actor),
            paths=covering.paths,
        )
    asked = parse_front_request(source.body, limits, source.upload)
    return Task(
        subject=asked.instance(),
        demand=asked.demand(),
        actor=choose_actor(actors, asked.kind, asked.named_actor),
    )


DEFAULT_ACTORS: Mapping[Kind, str] = {"coordinates": "pa-one", "matrices": "pa-one-matrix"}


def choose_actor(loaded: Mapping[str, ActorInfo], kind: Kind, name: str | None) -> str:
    """The name of the actor asked for; without one, of the default for instances of this kind.

    Where the default is not loaded, the first by name that serves the kind takes its place.

    Raises:
        Refusal: it is not loaded, or no actor that serves the kind is.
    """
    able = sorted(each for each, facts in loaded.items() if facts.serves(kind))
    if name is not None:
        _check_able(name, kind, able, loaded)
        return name
    if not able:
        raise Refusal("no-actor", kind=kind)
    return DEFAULT_ACTORS[kind] if DEFAULT_ACTORS[kind] in able else able[0]


def _check_able(name: str, kind: Kind, able: list[str], loaded: Mapping[str, ActorInfo]) -> None:
    if name in able:
        return
    among = f"one of {', '.join(able)}" if able else "one that is loaded, and there is none"
    if name not in loaded:
        raise Refusal("unknown-actor", among=among, came=repr(name[:80]), pointer="/actor")
    inputs = loaded[name].inputs
    raise Refusal("unfit-actor", kind=kind, among=among, name=name, inputs=inputs, pointer="/actor")
