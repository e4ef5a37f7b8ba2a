"""Fronts of plans, for the vehicles of a fleet or for robots on a map, as immutable values."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import nan
from typing import Any, TypeVar, Unpack

import numpy as np
from numpy.typing import NDArray
from paretour.choice import Choice, choose
from paretour.display import counted, numbers
from paretour.expect import each, floats, indexes, members, value_of
from paretour.fronts import Array, Objective, StoredFront
from paretour.ros.paths import Path
from paretour.values import PAIR, Uncovered, objectives_of, stored_members


@dataclass(frozen=True, kw_only=True, eq=False)
class FleetRoute:
    """The route of one vehicle.

    Attributes:
        vehicle: The id of its type.
        stops: The ids of its stops in order, with its start and end if these are stops.
        lengths: Its lengths, shape (m,).
        arrivals: When it reaches each of these stops; at the first, when it leaves. Shape
            (len(stops),). None without a clock.
        ends: When the visit at each of these stops ends, shape (len(stops),). None without a clock.
        breaks: When each break on the way begins.
        shift: The number of its shift, if its vehicle has several.
        route: The number of its route in the plan that is driven, if it is on its way.
        load: The most that it carries at a time, in each dimension.
        profile: The profile of its vehicle, if it has one.
        distance: How far it has driven at each of these stops, if its vehicle has a max_distance.
        driving: How long it has driven at each of them, if its vehicle has a max_driving.
    """

    vehicle: str
    stops: tuple[str, ...]
    lengths: Array
    arrivals: Array | None = field(metadata={"read": lambda route: floats(len(route["stops"]))})
    ends: Array | None = field(
        default=None, metadata={"read": lambda route: floats(len(route["stops"]))}
    )
    breaks: tuple[float, ...] = ()
    shift: int | None = None
    route: int | None = None
    load: tuple[int, ...] = ()
    profile: str | None = None
    distance: tuple[float, ...] = ()
    driving: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class RobotRoute:
    """The route of one robot.

    Attributes:
        robot: Its id.
        tour: Its places in order, from its start to its end, shape (k,).
        lengths: Its lengths, shape (2,).
        path: Its path over the map, if the request asked for paths.
    """

    robot: str
    tour: NDArray[np.int64]
    lengths: Array
    path: Path | None


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class _Plan:
    """A plan of a front: routes of the vehicles or robots used.

    Attributes:
        balance: 0 at the least first length of the front, 1 at the least second; NaN under three
            objectives.
        lengths: Its lengths, shape (m,).
        routes: The routes of those that leave.
    """

    balance: float = nan
    lengths: Array
    routes: tuple[Any, ...]

    def __repr__(self) -> str:
        routes = counted(len(self.routes), "route")
        return f"<{type(self).__name__} of {routes}: lengths {numbers(self.lengths)}>"


@dataclass(frozen=True, kw_only=True)
class Reason:
    """The rule that keeps the vehicles of a type from a stop, and what one would do."""

    vehicle: str
    rule: str
    detail: str


@dataclass(frozen=True, kw_only=True, eq=False)
class LeftOut:
    """A stop that a plan leaves out.

    Attributes:
        stop: Its id.
        plan: The number of the plan of the front that serves it at the least price, if one does.
        price: What each length grows by there, or if the stop is inserted here, shape (m,). None
            if no vehicle can serve it.
        reasons: If none can, a reason for each type of vehicles.
    """

    stop: str
    plan: int | None
    price: Array | None
    reasons: tuple[Reason, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class FleetPlan(_Plan):
    """A plan for the vehicles of a fleet.

    Attributes:
        unassigned: The ids of the stops that it leaves out.
        measures: What plans are compared by, by name, as far as the request allows: `vehicles`,
            `driving` and others, which the reference at `/docs` lists.
        left_out: For each stop that it leaves out, what it would cost to serve it, or why none can.
        kept: If it was replanned, the share of the stops left that the same vehicles visit after
            the same stops.
    """

    routes: tuple[FleetRoute, ...]
    unassigned: tuple[str, ...]
    measures: Mapping[str, float] = field(default_factory=dict)
    left_out: tuple[LeftOut, ...] = ()
    kept: float | None = None


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class RobotPlan(_Plan):
    """A plan for several robots on a map."""

    routes: tuple[RobotRoute, ...]


Plan = TypeVar("Plan", FleetPlan, RobotPlan)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class _FrontOfPlans(StoredFront[Plan]):
    """A front of plans.

    Attributes:
        plans: The plans.
    """

    plans: tuple[Plan, ...]

    def choose(self, **choice: Unpack[Choice]) -> Plan:
        """Return one plan: at a balance, by weights, within budgets, or the knee.

        Raises:
            ValueError: Not exactly one way to choose is given, no plan is within the budgets, or
                the front is still empty.
        """
        angles = np.empty(0)  # no choice by angle can be asked for
        return self[choose(self.lengths, angles, self.names, choice)]

    @property
    def X(self) -> NDArray[np.object_]:  # noqa: N802
        """The plans, shape (k,), by the name that pymoo has for solutions."""
        return np.array(self.plans, dtype=object)

    def _item(self, number: int) -> Plan:
        return self.plans[number]

    def _counted(self) -> str:
        return counted(len(self), "plan")


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class FleetFront(_FrontOfPlans[FleetPlan]):
    """A front of plans for a fleet, with the objectives as the request named them.

    Attributes:
        clock: The name and unit of all times, if the fleet has a clock.
        driven: If it was replanned, the lengths of the rest of the plan that is driven, without new
            stops, if that keeps every rule.
    """

    clock: Objective | None = None
    driven: Array | None = None

    def _columns(self) -> dict[str, Sequence[Any]]:
        found: dict[str, Sequence[Any]] = {}
        if self.lengths.shape[1] == PAIR:
            found["balance"] = [plan.balance for plan in self.plans]
        if self.plans:
            names = self.plans[0].measures
            found |= {name: [plan.measures[name] for plan in self.plans] for name in names}
        if any(plan.kept is not None for plan in self.plans):
            found["kept"] = [plan.kept for plan in self.plans]
        return {
            **found,
            # Pairs, since several vehicles share the id of their type.
            "routes": [[(each.vehicle, each.stops) for each in plan.routes] for plan in self.plans],
            "left_out": [plan.unassigned for plan in self.plans],
        }


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class RobotFront(_FrontOfPlans[RobotPlan]):
    """A front of plans for several robots on a map.

    Attributes:
        places: The row and column of each place, shape (n, 2).
        uncovered: The free cells of the map that no path leads to.
    """

    places: NDArray[np.int64]
    uncovered: Uncovered | None = None

    def _columns(self) -> dict[str, Sequence[Any]]:
        return {
            "balance": [plan.balance for plan in self.plans],
            "routes": [
                [(each.robot, tuple(each.tour.tolist())) for each in plan.routes]
                for plan in self.plans
            ],
        }


def parse_fleet(document: Mapping[str, Any]) -> FleetFront:
    """Return the front of plans for a fleet in a JSON answer.

    Raises:
        UnexpectedAnswer: A member is missing or wrong; so does `parse_robots`.
    """
    answer = members(document, "answer")
    return FleetFront(
        **stored_members(answer, answer.read("front", each(members))),
        plans=answer.read("front", each(value_of(FleetPlan))),
        objectives=objectives_of(answer) or (),
        clock=answer.maybe("clock", value_of(Objective)),
        driven=answer.maybe("driven", floats(None)),
    )


def parse_robots(document: Mapping[str, Any]) -> RobotFront:
    """Return the front of plans for robots in a JSON answer."""
    answer = members(document, "answer")
    places = indexes(None, PAIR)(answer.document.get("places") or [], "answer/places")
    route = value_of(RobotRoute, tour=indexes(None, below=len(places)))
    return RobotFront(
        **stored_members(answer, answer.read("front", each(members))),
        plans=answer.read("front", each(value_of(RobotPlan, routes=each(route)))),
        objectives=objectives_of(answer) or (),
        places=places,
        uncovered=answer.maybe("uncovered", value_of(Uncovered)),
    )
