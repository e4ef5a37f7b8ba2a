"""Fronts of plans for a fleet, as immutable values."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from paretour.expect import count, each, floats, members, number, text
from paretour.values import PAIR, Array, Objective, lengths_of, objectives_of


@dataclass(frozen=True, kw_only=True, eq=False)
class FleetRoute:
    """The route of one vehicle.

    Attributes:
        vehicle: The id of its type.
        stops: The ids of its stops in order, with its start and end if these are stops.
        lengths: Its lengths, shape (2,).
        arrivals: When it reaches each of these stops; at the first, when it leaves. Shape
            (len(stops),). None if no objective is time.
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
        routes: The routes of the vehicles used.
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
        points: The number of nondominated plans found; the front is a subset of these.
        hypervolume: The share of the box at the reference point that the plans dominate.
        reference_point: The reference point of the hypervolume, shape (2,); None while it is not
            known.
        objectives: Both objectives, as the request named them.
        terminated: Why the search ended; None while it runs.
        document: The whole answer, with every member.
    """

    id: str
    status: str
    plans: tuple[FleetPlan, ...]
    lengths: Array
    points: int
    hypervolume: float
    reference_point: Array | None
    objectives: tuple[Objective, ...]
    terminated: str | None
    document: Mapping[str, Any]


def parse_fleet(document: Mapping[str, Any]) -> FleetFront:
    """Return the front of plans in a JSON answer.

    Raises:
        UnexpectedAnswer: A member is missing or wrong.
    """
    answer = members(document, "answer")
    return FleetFront(
        id=answer.read("id", text),
        status=answer.read("status", text),
        plans=answer.read("front", each(_parse_plan)),
        lengths=lengths_of(answer.read("front", each(members))),
        points=answer.read("points", count),
        hypervolume=answer.read("hypervolume", number),
        reference_point=answer.maybe("reference_point", floats(PAIR)),
        objectives=objectives_of(answer) or (),
        terminated=answer.maybe("terminated", text),
        document=document,
    )


def _parse_plan(value: Any, where: str) -> FleetPlan:
    plan = members(value, where)
    return FleetPlan(
        balance=plan.read("balance", number),
        lengths=plan.read("lengths", floats(PAIR)),
        routes=plan.read("routes", each(_parse_route)),
        unassigned=plan.read("unassigned", each(text)),
    )


def _parse_route(value: Any, where: str) -> FleetRoute:
    route = members(value, where)
    stops = route.read("stops", each(text))
    return FleetRoute(
        vehicle=route.read("vehicle", text),
        stops=stops,
        lengths=route.read("lengths", floats(PAIR)),
        arrivals=route.maybe("arrivals", floats(len(stops))),
    )
