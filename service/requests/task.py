"""Parse a request body into a Task: the instance or map, the options and the chosen actor."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Literal

from service.actor_info import ActorInfo
from service.coverage.coverage import Coverage
from service.errors import CityNames, Refusal
from service.instance import Instance, Kind, least_lengths
from service.planner import PlanOptions
from service.replanning.earlier_tours import EarlierTours
from service.requests.coverage import CoverageRequest, parse_coverage_request
from service.requests.fleets.request import parse_fleet_request
from service.requests.fleets.subject import UnmeasuredFleet
from service.requests.front import FrontRequest
from service.requests.front_parser import parse_front_request
from service.requests.limits import (
    Limits,
    check_reference_point,
    check_router,
    check_structure,
    within_network,
)
from service.requests.maps.robots import SharedCoverage
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.rest_request import RestOfMapRequest, RestRequest
from service.requests.schemas import Geometry, PlanFields
from service.requests.stops import Labels, UnmeasuredStops
from service.search.forbidden_legs import check_legs

_BRIEF = 5000  # preferences times cities
TaskKind = Literal["front", "coverage", "fleet", "replan", "replan-coverage"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Task:
    """A front to plan, checked and ready for the planner.

    Args:
        subject: The cities; or what becomes cities in the job: a map and its places, for one
            robot or several, or stops or a fleet whose costs are to be measured.
        options: The options for the planner.
        actor: The name of the actor that builds the first tours; empty for a fleet, or several
            robots, where none is loaded that reads matrices.
        paths: Whether each tour comes with its path over the map.
        arrivals: Whether each tour comes with both lengths up to each stop.
        geometry: What the lines of the answer follow, where that is GeoJSON.
        labels: The caller's names of stops and objectives.
        timings: Milliseconds of what was done for it since it was parsed, by name.
        earlier: What is left of the tours of the front that is replanned, if one is.
    """

    subject: Instance | Coverage | SharedCoverage | UnmeasuredStops | UnmeasuredFleet
    options: PlanOptions
    actor: str
    paths: bool = False
    arrivals: bool = False
    geometry: Geometry = "straight"
    labels: Labels | None = None
    timings: Mapping[str, float] = field(default_factory=dict)
    earlier: EarlierTours | None = None

    @property
    def city_names(self) -> CityNames:
        """The names of its cities in refusals; the request to replan has none of the rest."""
        names = CityNames()
        if self.labels is not None:
            names = self.labels.city_names
        elif isinstance(self.subject, Coverage):
            given = self.subject.places is not None
            names = CityNames("place", part="places" if given else None)
        return names if self.earlier is None else replace(names, part=None)

    @property
    def needs_compiled_code(self) -> bool:
        """Whether planning needs more than the network."""
        compiled = isinstance(self.subject, Coverage | SharedCoverage | UnmeasuredFleet)
        return compiled or self.options.needs_compiled_code

    @property
    def is_brief(self) -> bool:
        """Whether planning is one short call of a network: by pa-one, of 50 ms or less."""
        if not isinstance(self.subject, Instance) or self.needs_compiled_code:
            return False
        return self.options.repairs == 0 and len(self.options.angles) * self.subject.n <= _BRIEF


@dataclass(frozen=True)
class TaskSource:
    """A front to plan, as it came: the form in which it is stored and sent to other machines.

    Args:
        kind: The kind of request, named after its path; of the rest of a map, replan-coverage.
        body: The request as JSON; of the kinds to replan, as the service writes it (see
            `RestRequest` and `RestOfMapRequest`).
        upload: The .npy file of matrices, or the PNG or PGM file of a map, where one came with it.
        task: The parsed task, where this process has it, so that no worker parses it again.
    """

    kind: TaskKind
    body: bytes
    upload: bytes | None = None
    task: Task | None = field(default=None, compare=False, repr=False)

    def without_task(self) -> "TaskSource":
        """Return the source as it came."""
        return TaskSource(self.kind, self.body, self.upload)


def parse_task(source: TaskSource, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
    """Return the task in a body.

    Raises:
        Refusal: The body is malformed or over a limit, or no actor serves it.
        InvalidInstance: The cities or the map cannot be planned.
    """
    check_structure(source.body, limits)
    if source.kind in ("coverage", "replan-coverage"):
        return _coverage_task(source, limits, actors)
    if source.kind == "fleet":
        return _fleet_task(source.body, limits, actors)
    model = RestRequest if source.kind == "replan" else FrontRequest
    request = parse_front_request(source.body, limits, source.upload, model)
    return front_task(
        request,
        request.subject(),
        limits,
        actors,
        labels=request.labels,
        earlier=request.earlier if isinstance(request, RestRequest) else None,
    )


def front_task(
    request: FrontRequest | ReplanRequest,
    subject: Instance | UnmeasuredStops,
    limits: Limits,
    actors: Mapping[str, ActorInfo],
    *,
    labels: Labels | None = None,
    earlier: EarlierTours | None = None,
) -> Task:
    """Return the task of a checked request; the arguments are those of Task.

    Raises:
        Refusal: No actor serves it, it asks for what the actor cannot do, or it is plain that no
            tour is without a forbidden leg.
    """
    name = choose_actor(actors, subject.kind, request.requested_actor)
    options = within_network(_options(request, actors[name]), subject.n, limits)
    task = Task(
        subject=subject,
        options=options,
        actor=name,
        labels=labels,
        arrivals=request.arrivals,
        geometry=request.geometry,
        earlier=earlier,
    )
    if isinstance(subject, Instance):
        check_instance(task, subject)
    return task


def check_instance(task: Task, instance: Instance) -> None:
    """Raise a refusal where it is plain that the instance of a task has no tour, or none to count.

    Raises:
        NoTour: Forbidden legs leave no tour.
        Refusal: No tour lies below the reference point.
    """
    check_legs(instance, task.city_names)
    check_reference_point(task.options, partial(least_lengths, instance))


def _coverage_task(source: TaskSource, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
    model = RestOfMapRequest if source.kind == "replan-coverage" else CoverageRequest
    request = parse_coverage_request(source.body, limits, source.upload, model)
    if request.robots:
        return _shared_task(request, actors)
    name = choose_actor(actors, request.kind, request.requested_actor)
    return Task(
        subject=request.coverage(),
        options=_options(request, actors[name]),
        actor=name,
        paths=request.paths,
        arrivals=request.arrivals,
        earlier=request.earlier if isinstance(request, RestOfMapRequest) else None,
    )


def _shared_task(request: CoverageRequest, actors: Mapping[str, ActorInfo]) -> Task:
    return Task(
        subject=request.shared(),
        options=request.options(),
        actor=_actor_for_plans(actors),
        paths=request.paths,
    )


def _options(request: PlanFields, actor: ActorInfo) -> PlanOptions:
    """Return the options of a request, without repairs by an actor that makes none."""
    options = request.options()
    if actor.repairs or options.repairs == 0:
        return options
    if "repairs" in request.model_fields_set:
        raise Refusal("no-repairs", name=actor.name, came=request.repairs, pointer="/repairs")
    return replace(options, repairs=0)


def _fleet_task(body: bytes, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
    request = parse_fleet_request(body, limits)
    fleet = request.subject()
    check_router(fleet.stops, limits)
    return Task(
        subject=fleet,
        options=request.options(),
        actor=_actor_for_plans(actors),
        labels=request.labels,
        geometry=request.geometry,
    )


def _actor_for_plans(actors: Mapping[str, ActorInfo]) -> str:
    """Return the name of the actor whose tours are cut into first plans; empty without one."""
    able = any(info.serves("matrices") for info in actors.values())
    return choose_actor(actors, "matrices", None) if able else ""


DEFAULT_ACTORS: Mapping[Kind, str] = {"coordinates": "pa-one", "matrices": "pa-one-matrix"}


def choose_actor(actors: Mapping[str, ActorInfo], kind: Kind, name: str | None) -> str:
    """Return the name of the actor for instances of a kind: the one requested, or the default.

    Where the default is not loaded, the first by name that serves the kind takes its place.

    Raises:
        Refusal: The requested actor is not loaded or does not serve the kind, or none does.
    """
    able = sorted(each for each, info in actors.items() if info.serves(kind))
    if name is not None:
        _check_able(name, kind, able, actors)
        return name
    if not able:
        raise Refusal("no-actor", kind=kind)
    return DEFAULT_ACTORS[kind] if DEFAULT_ACTORS[kind] in able else able[0]


def _check_able(name: str, kind: Kind, able: list[str], actors: Mapping[str, ActorInfo]) -> None:
    if name in able:
        return
    among = f"one of {', '.join(able)}" if able else "one that is loaded, and none is"
    if name not in actors:
        raise Refusal("unknown-actor", among=among, came=repr(name[:80]), pointer="/actor")
    inputs = actors[name].inputs
    raise Refusal("unfit-actor", kind=kind, among=among, name=name, inputs=inputs, pointer="/actor")
