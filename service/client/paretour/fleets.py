"""Fronts of plans for a fleet, as immutable values."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from paretour.values import Array, Objective, Status, objectives_of, read_only_floats


@dataclass(frozen=True, kw_only=True, eq=False)
class FleetRoute:
    """The route of one vehicle.

    Attributes:
        vehicle: The id of its type.
        stops: The ids of its stops in order, with its start and end where these are stops.
        lengths: Its lengths, shape (2,).
        arrivals: When it reaches each of these stops, at the first when it leaves, shape
            (len(stops),); None where no objective is time.
    """

    vehicle: str
    stops: tuple[str, ...]
    lengths: Array
    arrivals: Array | None


@dataclass(frozen=True, kw_only=True, eq=False)
class FleetPlan:
    """A plan of a front.

    Attributes:
        balance: 0 at the least first length of the front, 1 at the least second.
        lengths: Its lengths, shape (2,).
        routes: Of the vehicles that leave.
        unassigned: The ids of the stops that it leaves out.
    """

    balance: float
    lengths: Array
    routes: tuple[FleetRoute, ...]
    unassigned: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class FleetFront:
    """The plans of a front, in order of their first length.

    Attributes:
        id: The id under which the service stores the front.
        status: The status of its job.
        plans: The m plans.
        lengths: Their lengths, shape (m, 2).
        points: The number of nondominated plans found, of which these are returned.
        hypervolume: The share of the box at the reference point that the plans dominate.
        reference_point: The reference point of the hypervolume, shape (2,).
        objectives: Both objectives, as the request named them.
        terminated: Why the search ended; None while it runs.
        document: The answer as it came, with every member.
    """

    id: str
    status: Status
    plans: tuple[FleetPlan, ...]
    lengths: Array
    points: int
    hypervolume: float
    reference_point: Array
    objectives: tuple[Objective, ...]
    terminated: Literal["converged", "time_limit", "cancelled"] | None
    document: Mapping[str, Any]


def parse_fleet(document: Mapping[str, Any]) -> FleetFront:
    """Return the front of plans in a JSON answer."""
    items = document["front"]
    return FleetFront(
        id=document["id"],
        status=document["status"],
        plans=tuple(_parse_plan(item) for item in items),
        lengths=read_only_floats([item["lengths"] for item in items]).reshape(-1, 2),
        points=document["points"],
        hypervolume=document["hypervolume"],
        reference_point=read_only_floats(document["reference_point"]),
        objectives=objectives_of(document) or (),
        terminated=document["terminated"],
        document=document,
    )


def _parse_plan(item: Mapping[str, Any]) -> FleetPlan:
    return FleetPlan(
        balance=item["balance"],
        lengths=read_only_floats(item["lengths"]),
        routes=tuple(_parse_route(route) for route in item["routes"]),
        unassigned=tuple(item["unassigned"]),
    )


def _parse_route(route: Mapping[str, Any]) -> FleetRoute:
    return FleetRoute(
        vehicle=route["vehicle"],
        stops=tuple(route["stops"]),
        lengths=read_only_floats(route["lengths"]),
        arrivals=read_only_floats(route["arrivals"]) if "arrivals" in route else None,
    )
