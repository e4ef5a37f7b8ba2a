"""Plan fronts of plans for several vehicles, and write them as JSON."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import accumulate
from math import inf
from typing import Any, NamedTuple

from paretour.choice import balances, losses
from pydantic_core import to_json

from service.errors import Fault, NoTour, Refusal
from service.fleet.evaluation import (
    measures,
    plan_lengths,
    route_lengths,
    routes_broken,
    unassigned,
)
from service.fleet.fleet import Fleet
from service.fleet.left_out import Serving, explain
from service.fleet.measures.carried import most_carried
from service.fleet.necessary import least_lengths
from service.fleet.plans import FleetFront, Plan, Route, kept_share, path_of
from service.fleet.schedule import legs, schedule, with_waits
from service.kinds.front_document import FrontDocument, joined
from service.kinds.kind import NamedActor, Tools
from service.objectives import OBJECTIVES
from service.remedies.asked import AskedFleet
from service.remedies.look import remedies_of
from service.remedies.rest import AskedRest
from service.requests.limits import check_reference_point
from service.requests.stops import Labels
from service.requests.task import Task, UnmeasuredFleet, VehicleName
from service.watch import Watch

_LEAST_EXPLAINING = 0.01  # seconds to say how stops can be served that are left out
_UNLIMITED_EXPLAINING = 0.5  # seconds without a time limit


class Names(NamedTuple):
    """The names of types of vehicles, the ids of stops, and the names of profiles."""

    vehicles: Sequence[VehicleName]
    stops: Sequence[str]
    profiles: Sequence[str | None]


def run_fleet(
    subject: UnmeasuredFleet, task: Task, tools: Tools, watch: Watch[FrontDocument]
) -> FrontDocument:
    """Return the front of plans of a task; see `Run`."""
    actor = tools.actors.get(task.actor)
    assert task.labels is not None
    known = subject.members(task.labels)
    stops = [stop.id for stop in task.labels.stops]
    names = Names(subject.vehicles, stops, subject.profiles)
    driven = Plan(subject.driven) if subject.driven else None

    def encoded(front: FleetFront) -> FrontDocument:
        # While the search runs, plans come without reasons for what they leave out.
        ended = front.terminated is not None
        seconds = max(watch.seconds, watch.spent + _LEAST_EXPLAINING)
        explained = partial(explain, ended=watch.until(seconds).ended)
        servings = iter(explained(front.fleet, front.plans, front.points) if ended else ())
        return document_of_plans(
            front,
            lambda plan, members: _encode_plan(
                front.fleet, plan, _with_kept(members, driven, plan), names, next(servings, [])
            ),
            actor,
            kind="fleet",
            cities=subject.n,
            **known,
        )

    watch = watch.lasting(task.options.time_limit or _UNLIMITED_EXPLAINING)
    fleet = subject.fleet()
    known["driven"] = None if driven is None else _lengths_of(fleet, driven)
    timings = {**task.timings, "costs": 1000 * watch.spent}
    try:
        _check_reach(subject, task.labels)
        front = plan_front(task, fleet, actor, watch.converting(encoded), driven)
    except Refusal as refusal:
        named = refusal.named(task.city_names) if isinstance(refusal, NoTour) else refusal
        raise _with_remedies(named, fleet, subject, task, tools, watch) from None
    return encoded(replace(front, timings={**timings, **front.timings}))


def _check_reach(subject: UnmeasuredFleet, labels: Labels) -> None:
    """Raise a refusal if no vehicle that is left may visit some stops."""
    pairs = ((stop, labels.stops[stop].id) for stop in subject.out_of_reach)
    pointer = labels.city_names.pointer
    faults = [
        Fault("no-vehicle-for-stop", pointer=pointer(stop), values={"stop": name})
        for stop, name in pairs
    ]
    if faults:
        raise Refusal("no-plan", errors=faults)


def _with_remedies(
    refusal: Refusal,
    fleet: Fleet,
    subject: UnmeasuredFleet,
    task: Task,
    tools: Tools,
    watch: Watch[FrontDocument],
) -> Refusal:
    """Return the refusal with changes that help, if a fleet has no plan and some are found."""
    if refusal.code != "no-plan":
        return refusal
    obstacles = refusal.obstacles if isinstance(refusal, NoTour) else ()
    at_fault = [*subject.out_of_reach, *(stop for each in obstacles for stop in each.cities)]
    assert task.labels is not None
    asked = _asked(fleet, subject, task.labels, at_fault)
    actor = tools.actors.get(task.actor)

    def plan(fleet: Fleet, seconds: float, watch: Watch[FleetFront]) -> FleetFront:
        options = replace(task.options, time_limit=seconds)
        return plan_front(replace(task, options=options), fleet, actor, watch)

    limit, most = task.options.time_limit, tools.limits.seconds
    return refusal.with_remedies(remedies_of(asked, limit, most, plan, watch))


def _asked(
    fleet: Fleet, subject: UnmeasuredFleet, labels: Labels, at_fault: Sequence[int]
) -> AskedFleet:
    """Return a fleet without a plan as its request names it; `at_fault` are stops at fault."""
    known: dict[str, Any] = {
        "fleet": fleet,
        "stops": [each.id for each in labels.stops],
        "vehicles": [name.id for name in subject.vehicles],
        "unit": None if subject.clock is None else subject.clock.unit,
        "at_fault": at_fault,
    }
    if subject.changes is None:
        return AskedFleet(**known)
    names = [*enumerate((*subject.vehicles, *subject.names_of_spares))]
    more: dict[str, int] = {}
    for number, name in (*names[len(subject.vehicles) :], *names[: len(subject.vehicles)]):
        if name.route is None:
            more.setdefault(name.id, number)
    return AskedRest(
        **known,
        parts=labels.parts or [""] * subject.n,
        changed_stops=subject.changes["stops"],
        changed_vehicles=subject.changes["vehicles"],
        spares=subject.spares,
        more=more,
    )


def plan_front(
    task: Task,
    fleet: Fleet,
    actor: NamedActor | None,
    watch: Watch[FleetFront],
    driven: Plan | None = None,
) -> FleetFront:
    """Return the front of plans of a fleet, with the options of a task.

    `driven` is a plan to start from.
    """
    # Imported here so that a process that does not plan fleets starts without what compiles.
    from service.fleet.fronts import FleetOptions
    from service.fleet.planner import plan_fleet

    check_reference_point(task.options, partial(least_lengths, fleet), "plan")
    options = FleetOptions(
        time_limit=task.options.time_limit,
        size=task.options.size,
        seed=task.options.seed,
        reference_point=task.options.reference_point,
        driven=driven,
    )
    return plan_fleet(fleet, options, actor, watch)


def warm_up() -> None:
    """Compile what plans fleets."""
    from service.fleet import first_plans
    from service.fleet.search import search

    first_plans.warm_up()
    search.warm_up()


def warm_up_over_the_day() -> None:
    """Compile what plans fleets whose costs change over the day."""
    from service.fleet.search import search

    search.warm_up_over_the_day()


def document_of_plans(
    front: FleetFront,
    encode: Callable[[Plan, dict[str, Any]], bytes],
    actor: NamedActor | None,
    **members: Any,
) -> FrontDocument:
    """Return a front of plans as JSON, whose plans are encoded one after another.

    Args:
        encode: Returns a plan as JSON, which begins with the members that it is given.
        actor: The network; it is named where its tours were cut into plans.
        members: Other members of the document.
    """
    network = actor.info.identity if actor is not None and front.constructed else None
    flat = front.points.shape[1] == OBJECTIVES
    name, places = ("balance", balances) if flat else ("losses", losses)
    columns = zip(front.plans, places(front.points).tolist(), front.points.tolist(), strict=True)
    plans, ends = joined(
        encode(plan, {name: place, "lengths": lengths}) for plan, place, lengths in columns
    )
    return FrontDocument.of(
        front, hypervolume_bound=None, actor=network, tours=plans, ends=ends, **members
    )


def _lengths_of(fleet: Fleet, driven: Plan) -> list[float] | None:
    """Return the lengths of the rest of a plan that is driven; None if it cannot go on so."""
    if any(True for _ in routes_broken(fleet, driven)):
        return None
    return list(plan_lengths(fleet, driven))


def _with_kept(members: dict[str, Any], driven: Plan | None, plan: Plan) -> dict[str, Any]:
    return members if driven is None else {**members, "kept": kept_share(driven, plan)}


def _encode_plan(
    fleet: Fleet,
    plan: Plan,
    members: dict[str, Any],
    names: Names,
    servings: Sequence[Serving],
) -> bytes:
    plan = with_waits(fleet, plan)
    content = {
        **members,
        "measures": measures(fleet, plan),
        "routes": [_route(fleet, route, names) for route in plan.routes],
        "unassigned": [names.stops[stop] for stop in unassigned(fleet.rules, plan)],
    }
    if servings:
        content["left_out"] = [_serving(each, names) for each in servings]
    return to_json(content)


def _serving(serving: Serving, names: Names) -> dict[str, Any]:
    """Return how a stop can be served that is left out, or why not."""
    members: dict[str, Any] = {"stop": names.stops[serving.stop]}
    if serving.plan is not None:
        members["plan"] = serving.plan
    if serving.price is not None:
        return {**members, "price": list(serving.price)}
    reasons = [
        {"vehicle": names.vehicles[vehicle].id, "rule": broken.rule, "detail": broken.detail}
        for vehicle, broken in serving.reasons
    ]
    return {**members, "reasons": reasons}


def _route(fleet: Fleet, route: Route, names: Names) -> dict[str, Any]:
    name = names.vehicles[route.vehicle]
    members: dict[str, Any] = {
        "vehicle": name.id,
        "stops": [names.stops[stop] for stop in path_of(fleet.rules, route)],
        "lengths": list(route_lengths(fleet, route)),
        "load": most_carried(fleet.rules, route),
    }
    profile = names.profiles[fleet.rules.vehicles[route.vehicle].profile]
    some = {"shift": name.shift, "route": name.route, "profile": profile}
    members |= {member: value for member, value in some.items() if value is not None}
    if fleet.rules.clock is not None:
        times = schedule(fleet, route)
        members["arrivals"] = list(times.arrivals)
        members["ends"] = [
            begin + fleet.rules.service(route.vehicle, stop)
            for begin, stop in zip(times.begins, path_of(fleet.rules, route), strict=True)
        ]
        if times.breaks:
            members["breaks"] = list(times.breaks)
    return {**members, **_limited(fleet, route)}


def _limited(fleet: Fleet, route: Route) -> dict[str, list[float]]:
    """Return what is driven until each stop of a route, where its vehicle has a limit on it."""
    limits = enumerate(fleet.rules.most_legs(route.vehicle))
    layers = [layer for layer, most in limits if most < inf]
    return {
        "driving" if layer == fleet.rules.clock else "distance": list(
            accumulate(legs(fleet, route, layer), initial=0.0)
        )
        for layer in layers
    }
