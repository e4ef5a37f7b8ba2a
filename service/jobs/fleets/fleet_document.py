"""A front of plans as JSON: a FrontDocument that holds plans with routes in place of tours."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from service.fleet.evaluation import route_lengths, schedule, unassigned
from service.fleet.fleet import Fleet, Over
from service.fleet.plans import FleetFront, Plan, Route, path_of
from service.jobs.front_document import FrontDocument, Timings
from service.jobs.json_parts import joined
from service.pareto import balances
from service.preferences import angles
from service.requests.fleets.subject import UnmeasuredFleet
from service.requests.stops import Labels
from service.requests.task import Task


def encode_fleet(
    front: FleetFront, actor: dict[str, str] | None, vehicles: Sequence[str], labels: Labels
) -> FrontDocument:
    """Write a front of plans as JSON.

    Args:
        front: The front.
        actor: The name and digest of the network whose tours were cut into the first plans, if any.
        vehicles: The names of the types of vehicles.
        labels: The names of stops and objectives.
    """
    ids = [stop.id for stop in labels.stops]
    members = zip(balances(front.points).tolist(), front.points.tolist(), front.plans, strict=True)
    plans, ends = joined(
        _encode_plan(front.fleet, plan, {"balance": balance, "lengths": lengths}, vehicles, ids)
        for balance, lengths, plan in members
    )
    return FrontDocument(
        cities=front.fleet.rules.n,
        points=front.found,
        hypervolume=front.hypervolume,
        hypervolume_bound=None,
        reference_point=front.reference_point.tolist(),
        scale=front.scale.tolist(),
        timings_ms=Timings(front.timings),
        terminated=front.terminated,
        actor=actor,
        **_named(labels, front.fleet.rules.over),
        tours=plans,
        ends=ends,
        angles=directions(front).tobytes(),
    )


def empty_fleet(task: Task) -> FrontDocument:
    """Return the document of a fleet's task before anything is found."""
    assert isinstance(task.subject, UnmeasuredFleet)
    assert task.labels is not None
    reference_point = task.options.reference_point
    return FrontDocument(
        cities=task.subject.n,
        points=0,
        hypervolume=0.0,
        hypervolume_bound=None,
        reference_point=None if reference_point is None else reference_point.tolist(),
        scale=None,
        timings_ms=Timings({}),
        terminated=None,
        actor=None,
        **_named(task.labels, task.subject.rules.over),
    )


def holds_plans(front: FrontDocument) -> bool:
    """Return whether a front has plans of a fleet instead of tours."""
    return bool(front.objectives) and all("over" in each for each in front.objectives or ())


def directions(front: FleetFront) -> NDArray[np.float64]:
    """Return the direction of each plan in scaled objectives, in degrees, shape (m,)."""
    return angles(front.points, front.scale)


def _named(labels: Labels, over: tuple[Over, Over]) -> dict[str, Any]:
    named = asdict(labels)
    objectives = zip(named["objectives"], over, strict=True)
    return {**named, "objectives": [{**each, "over": over} for each, over in objectives]}


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
