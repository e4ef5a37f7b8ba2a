"""A front of plans as JSON: a FrontDocument that holds plans with routes in place of tours."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from pydantic_core import to_json

from service.fleet.evaluation import route_lengths, schedule, unassigned
from service.fleet.fleet import Fleet
from service.fleet.plans import FleetFront, Plan, Route, path_of
from service.kinds.front_document import FrontDocument, Timings
from service.kinds.json_parts import joined
from service.pareto import balances
from service.preferences import angles
from service.requests.fleets.subject import UnmeasuredFleet
from service.requests.stops import Labels
from service.requests.task import KindName


def encode_fleet(
    front: FleetFront, actor: dict[str, str] | None, subject: UnmeasuredFleet, labels: Labels
) -> FrontDocument:
    """Return a front of plans as JSON.

    Args:
        front: The front.
        actor: The name and digest of the network whose tours were cut into the first plans, if any.
        subject: The fleet, with the names of its types of vehicles.
        labels: The names of stops and objectives.
    """
    ids = [stop.id for stop in labels.stops]
    return document_of_plans(
        front,
        lambda plan, members: _encode_plan(front.fleet, plan, members, subject.vehicles, ids),
        kind="fleet",
        cities=front.fleet.rules.n,
        actor=actor,
        members=subject.members(labels),
    )


def document_of_plans(
    front: FleetFront,
    encode: Callable[[Plan, dict[str, Any]], bytes],
    *,
    kind: KindName,
    cities: int,
    actor: Mapping[str, str] | None,
    members: Mapping[str, Any],
) -> FrontDocument:
    """Return a front of plans as JSON, whose plans are encoded one after another.

    Args:
        front: The front.
        encode: Returns a plan as JSON, which begins with the members that it is given.
        kind: The kind of the front.
        cities: The number of stops or places.
        actor: The name and digest of the network whose tours were cut into the first plans, if any.
        members: Other members of the document.
    """
    columns = zip(front.plans, balances(front.points).tolist(), front.points.tolist(), strict=True)
    plans, ends = joined(
        encode(plan, {"balance": balance, "lengths": lengths}) for plan, balance, lengths in columns
    )
    return FrontDocument(
        kind=kind,
        cities=cities,
        points=front.found,
        hypervolume=front.hypervolume,
        hypervolume_bound=None,
        reference_point=front.reference_point.tolist(),
        scale=front.scale.tolist(),
        timings_ms=Timings(front.timings),
        terminated=front.terminated,
        actor=actor,
        **members,
        tours=plans,
        ends=ends,
        angles=angles(front.points, front.scale).tobytes(),
    )


def _encode_plan(
    fleet: Fleet,
    plan: Plan,
    members: dict[str, Any],
    vehicles: Sequence[str],
    ids: Sequence[str],
) -> bytes:
    routes = [_route(fleet, route, vehicles, ids) for route in plan.routes]
    left_out = [ids[stop] for stop in unassigned(fleet.rules, plan)]
    return to_json({**members, "routes": routes, "unassigned": left_out})


def _route(
    fleet: Fleet, route: Route, vehicles: Sequence[str], ids: Sequence[str]
) -> dict[str, Any]:
    members = {
        "vehicle": vehicles[route.vehicle],
        "stops": [ids[stop] for stop in path_of(fleet.rules, route)],
        "lengths": list(route_lengths(fleet, route)),
    }
    if fleet.rules.clock is not None:
        members["arrivals"] = list(schedule(fleet, route).arrivals)
    return members
