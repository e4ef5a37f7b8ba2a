"""Parse the body of a request of each path into a Task. Replanning shares parts of this."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

from service.actor_info import ActorInfo
from service.coverage.coverage import Coverage
from service.errors import Refusal, invalid
from service.front import PlanOptions
from service.instance import Instance, Kind, least_lengths
from service.objectives import OBJECTIVES
from service.reliability.spread import percentiles
from service.replanning.earlier_tours import EarlierTours
from service.requests.coverage import CoverageRequest, parse_coverage_request
from service.requests.fields import PlanFields
from service.requests.fleet import parse_fleet_request
from service.requests.front import FrontRequest, parse_front_request
from service.requests.limits import (
    Limits,
    check_breakpoints,
    check_fleet,
    check_reference_point,
    check_router,
    within_network,
)
from service.requests.replan.fields import ReplanRequest
from service.requests.stops import Labels, Stops
from service.requests.task import Task, TaskSource
from service.search.forbidden_legs import check_legs

DEFAULT_ACTORS: Mapping[Kind, str] = {"coordinates": "pa-one", "matrices": "pa-one-matrix"}


def read_front(source: TaskSource, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
    """Return the task of a request to `POST /front`; errors are those of `front_task`."""
    request = parse_front_request(source.body, limits, source.upload)
    return front_task(request, request.subject, limits, actors, labels=request.labels)


def front_task(
    request: FrontRequest | ReplanRequest,
    stops: Stops,
    limits: Limits,
    actors: Mapping[str, ActorInfo],
    *,
    labels: Labels | None = None,
    earlier: EarlierTours | None = None,
) -> Task:
    """Return the task of a checked request about stops; keyword arguments are those of Task.

    Raises:
        Refusal: No actor serves it, the actor cannot do what it asks for, or it is clear that
            every tour has a forbidden leg.
        InvalidInstance: The costs cannot be planned.
    """
    searched = len(stops.sources) + percentiles(stops.spreads)
    name = choose_actor(actors, stops.kind, request.requested_actor, searched)
    task = Task(
        subject=stops,
        options=within_network(
            options_of(request, actors[name], len(stops.sources)), stops.n, limits
        ),
        actor=name,
        labels=labels,
        arrivals=request.arrivals,
        geometry=request.geometry,
        earlier=earlier,
    )
    if stops.known_scale is not None:
        check_instance(task, stops.instance)
    return task


def check_instance(task: Task, instance: Instance) -> None:
    """Raise a refusal if the instance of a task clearly has no tour that could be reported.

    Raises:
        NoTour: Forbidden legs leave no tour.
        Refusal: No tour lies below the reference point.
    """
    if instance.matrices is not None:  # else no leg is forbidden
        check_legs(instance, task.city_names)
    if task.is_over_the_day:
        return  # a tour may be shorter than under mean costs
    check_reference_point(task.options, partial(least_lengths, instance))


def options_of(request: PlanFields, actor: ActorInfo, objectives: int = OBJECTIVES) -> PlanOptions:
    """Return the options of a request, with 0 repairs if the actor cannot repair.

    Raises:
        Refusal: The request asks for repairs, which the actor cannot make.
    """
    options = request.options(objectives)
    if actor.repairs or options.repairs == 0:
        return options
    if "repairs" in request.model_fields_set:
        raise Refusal("no-repairs", name=actor.name, came=request.repairs, pointer="/repairs")
    return replace(options, repairs=0)


def read_coverage(source: TaskSource, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
    """Return the task of a request to `POST /coverage`, for one robot or for several.

    Errors are those of `coverage_task`.
    """
    request = parse_coverage_request(source.body, limits, source.upload)
    if request.robots:
        return Task(
            subject=request.shared(),
            options=request.options(),
            actor=actor_for_plans(actors),
            paths=request.paths,
        )
    return coverage_task(request, request.coverage(), actors)


def coverage_task(
    request: CoverageRequest | ReplanRequest,
    coverage: Coverage,
    actors: Mapping[str, ActorInfo],
    earlier: EarlierTours | None = None,
) -> Task:
    """Return the task of a checked request about one robot on a map.

    Raises:
        Refusal: No actor serves it, the actor cannot do what it asks for, or it asks for a bound
            of tours with detours or over the day.
    """
    m = coverage.objectives
    if request.bound and (coverage.detours or coverage.hours is not None):
        raise invalid("bound", "bound-of-detours" if coverage.detours else "bound-of-the-day")
    name = choose_actor(actors, "matrices", request.requested_actor, m)
    return Task(
        subject=coverage,
        options=replace(options_of(request, actors[name], m), start=coverage.start),
        actor=name,
        paths=request.paths,
        arrivals=request.arrivals,
        earlier=earlier,
    )


def read_fleet(source: TaskSource, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
    """Return the task of a request to `POST /fleet`.

    Raises:
        Refusal: The body is malformed or over a limit.
    """
    request = parse_fleet_request(source.body, limits)
    fleet = request.subject()
    check_fleet("stops", fleet.stops, limits, request.time_limit)
    check_breakpoints(fleet.stops.sources, limits, request.part_of_source)
    check_router(fleet.stops.sources, limits, request.part_of_source)
    request.check_road_profiles(limits.profiles)
    return Task(
        subject=fleet,
        options=request.options(len(fleet.rules.over)),
        actor=actor_for_plans(actors),
        labels=request.labels,
        geometry=request.geometry,
    )


def choose_actor(
    actors: Mapping[str, ActorInfo], kind: Kind, name: str | None, objectives: int = OBJECTIVES
) -> str:
    """Return the name of the actor for instances of a kind: the one requested, or the default.

    If the default is not loaded, the first by name that serves the kind is taken.

    Raises:
        Refusal: The requested actor is not loaded, or does not serve the kind or as many
            objectives, or none does.
    """
    first = DEFAULT_ACTORS[kind] if name is None else name
    if first in actors and actors[first].serves(kind, objectives):
        return first
    able = sorted(each for each, info in actors.items() if info.serves(kind, objectives))
    if name is None:
        if not able:
            raise Refusal("no-actor", kind=_under(kind, objectives))
        return able[0]
    among = f"one of {', '.join(able)}" if able else "one that is loaded, and none is"
    if name not in actors:
        raise Refusal("unknown-actor", among=among, came=repr(name[:80]), pointer="/actor")
    most = actors[name].most_objectives if objectives > OBJECTIVES else OBJECTIVES
    asked, inputs = _under(kind, objectives), _under(actors[name].inputs, most)
    raise Refusal(
        "unfit-actor", kind=asked, among=among, name=name, inputs=inputs, pointer="/actor"
    )


def _under(kind: str, objectives: int) -> str:
    """Return a kind of instance, with the number of objectives where that is not two."""
    return kind if objectives == OBJECTIVES else f"{kind} under {objectives} objectives"


def actor_for_plans(actors: Mapping[str, ActorInfo]) -> str:
    """Return the name of the actor whose tours are cut into first plans; "" if none is loaded."""
    able = any(info.serves("matrices") for info in actors.values())
    return choose_actor(actors, "matrices", None) if able else ""
