"""Fronts of plans, for the vehicles of a fleet or for robots on a map, as immutable values."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import nan
from typing import Annotated, Any, TypeVar, Unpack

import numpy as np
from numpy.typing import NDArray
from paretour.choice import Choice, choose
from paretour.described import OF_MORE, OF_TWO, Array, Indexes, Lengths, Shape, answer, member
from paretour.display import counted, numbers
from paretour.expect import Members, Read, each, floats, indexes, members, rows, value_of
from paretour.fronts import FleetObjective, Objective, StoredFront
from paretour.ros.paths import PAIR, Pairs, Path
from paretour.values import PLACES, UNCOVERED, AnyFront, Uncovered, objective_count, read_front

OfStops = Annotated[Array, Shape("stops")]


@answer("RouteItem")
class FleetRoute:
    """The route of one vehicle."""

    vehicle: str = member("the id of its type")
    stops: tuple[str, ...] = member("ids in order, with the start and end that are stops")
    lengths: Lengths = member()
    load: tuple[int, ...] = member(
        "the most that it carries at a time, in each dimension", default=()
    )
    shift: int | None = member("the number of its shift, if its vehicle has several", default=None)
    route: int | None = member(
        "of a vehicle on its way: the number of its route in the plan that is driven", default=None
    )
    profile: str | None = member("the profile of its vehicle, if it has one", default=None)
    arrivals: OfStops | None = member(
        "if there is a clock: when it reaches each stop. At the first stop: when it leaves, as late"
        " as possible without finishing later"
    )
    ends: OfStops | None = member(
        "if there is a clock: when the visit at each stop ends", default=None
    )
    breaks: tuple[float, ...] = member("when each break on the way begins", default=())
    distance: tuple[float, ...] = member(
        "if its vehicle has a max_distance: how far it has driven at each stop", default=()
    )
    driving: tuple[float, ...] = member(
        "if its vehicle has a max_driving: how long it has driven at each stop", default=()
    )


@answer("RobotRouteItem")
class RobotRoute:
    """The route of one robot."""

    robot: str = member("its id")
    tour: Indexes = member("its places in order, from its start to its end")
    lengths: Lengths = member()
    path: Path | None = member("if `paths` is true")
    times: Annotated[Array, Shape("tour")] | None = member(
        "where costs change over the day: when it is at each of them, in seconds of the day",
        default=None,
    )


class _Plan:
    """A plan of a front: routes of the vehicles or robots used."""

    lengths: Array
    routes: tuple[Any, ...]

    def __repr__(self) -> str:
        routes = counted(len(self.routes), "route")
        return f"<{type(self).__name__} of {routes}: lengths {numbers(self.lengths)}>"


@answer("ReasonItem", eq=True)
class Reason:
    """A rule that keeps the vehicles of a type from a stop."""

    vehicle: str = member("the id of the type")
    rule: str
    detail: str = member("what a vehicle would do that the rule forbids")


@answer("LeftOutItem")
class LeftOut:
    """A stop that a plan leaves out: how it can be served, or why it cannot."""

    stop: str = member("its id")
    plan: int | None = member("the number of the plan of this front that serves it")
    price: Annotated[Array, Shape(None)] | None = member(
        "what each length grows by in that plan, or if the stop is inserted here"
    )
    reasons: tuple[Reason, ...] = member(
        "if no vehicle can serve it: for each type the rule that forbids", default=()
    )


@answer("PlanItem")
class FleetPlan(_Plan):
    """A plan of a fleet and where it stands."""

    balance: float = member(OF_TWO, default=nan)
    losses: Lengths | None = member(OF_MORE, default=None)
    lengths: Lengths = member()
    kept: float | None = member(
        "of a replanned fleet: the share of the stops left that the same vehicles visit after the"
        " same stops as in the plan that is driven",
        default=None,
    )
    measures: Mapping[str, float] = member(
        "what plans are compared by, as far as the request allows", default={}, always=True
    )
    routes: tuple[FleetRoute, ...] = member("one for each vehicle that leaves")
    unassigned: tuple[str, ...] = member("the ids of stops with a prize that are left out")
    left_out: tuple[LeftOut, ...] = member(
        "for each of these, once the search has ended", default=()
    )


@answer("RobotPlanItem")
class RobotPlan(_Plan):
    """A plan of several robots and where it stands."""

    balance: float = member(
        "0 at the front's least first length, 1 at its least second", default=nan, always=True
    )
    lengths: Lengths = member()
    routes: tuple[RobotRoute, ...] = member("one for each robot that leaves")


Plan = TypeVar("Plan", FleetPlan, RobotPlan)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class _FrontOfPlans(StoredFront[Plan]):
    """A front of plans."""

    items: tuple[Plan, ...] = member(named="front")

    @property
    def plans(self) -> tuple[Plan, ...]:
        """The plans."""
        return self.items

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

    def _counted(self) -> str:
        return counted(len(self), "plan")


@answer("FleetAnswer")
class FleetFront(_FrontOfPlans[FleetPlan]):
    """A front of plans for a fleet, by ascending first length."""

    items: tuple[FleetPlan, ...] = member(named="front")
    objectives: tuple[FleetObjective, ...] = member(default=(), always=True)
    request_stops: tuple[Mapping[str, Any], ...] = member(default=(), always=True, named="stops")
    clock: Objective | None = member("the name and unit of all times, if there is a clock")
    driven: Lengths | None = member(
        "of a replanned fleet: the lengths of the rest of the plan that is driven, without new"
        " stops, if it keeps every rule"
    )

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


@answer("RobotsAnswer")
class RobotFront(_FrontOfPlans[RobotPlan]):
    """A front of plans for several robots on a map, by ascending first length."""

    items: tuple[RobotPlan, ...] = member(named="front")
    objectives: tuple[FleetObjective, ...] = member(default=(), always=True)
    places: Pairs = member(PLACES)
    uncovered: Uncovered | None = member(UNCOVERED)

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
    return _read(FleetFront, members(document, "answer"))


def parse_robots(document: Mapping[str, Any]) -> RobotFront:
    """Return the front of plans for robots in a JSON answer."""
    answer = members(document, "answer")
    places = indexes(None, PAIR)(answer.document.get("places") or [], "answer/places")
    route = value_of(RobotRoute, tour=indexes(None, below=len(places)))
    plans = each(value_of(RobotPlan, routes=each(route)))
    return _read(RobotFront, answer, places=lambda *_: places, items=plans)


def _read(cls: type[AnyFront], answer: Members, **own: Read[Any]) -> AnyFront:
    items = answer.read("front", each(members))
    lengths = rows(items, "lengths", floats, objective_count(answer, items))
    return read_front(cls, answer, {"lengths": lengths}, **own)
