"""The objective of changes in requests to replan a fleet: what differs from the plan driven so far.

So that vehicles of one type are told apart, each route whose vehicle has not left gets a type of
its own, of one vehicle.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import inf

from service.errors import invalid
from service.fleet.measures.table import Measure
from service.fleet.plans import Route
from service.fleet.promises import begin_of
from service.fleet.rounding import is_over
from service.fleet.rules import Over, Rules
from service.fleet.vehicles import VehicleType, Visit
from service.objectives import MOST_OBJECTIVES, Objective
from service.requests.replan.fleet_fields import ChangesItem
from service.requests.task import VehicleName

NamedType = tuple[VehicleName, VehicleType, int]  # a name, a type, and its number so far


def objectives_with(
    item: ChangesItem | None, objectives: Sequence[Objective], rules: Rules
) -> tuple[tuple[Objective, ...], tuple[Over | Measure, ...]]:
    """Return the objectives of the rest, with changes if they are asked for, and what they measure.

    Raises:
        Refusal: There cannot be one more, or another one has its name.
    """
    if item is None or "changes" in rules.over:
        return tuple(objectives), rules.over
    if len(objectives) == MOST_OBJECTIVES:
        raise invalid("changes", "most-objectives", limit=MOST_OBJECTIVES)
    if rules.over[0] == "max":
        raise invalid("changes", "needs-sum")
    if item.name in (each.name for each in objectives):
        raise invalid("changes/name", "given-twice", came=item.name)
    return (*objectives, Objective(item.name, None)), (*rules.over, "changes")


def tolerance_of(
    item: ChangesItem | None, over: Sequence[Over | Measure], rules: Rules
) -> float | None:
    """Return how much later than in the plan so far a visit may begin; None for any time.

    Raises:
        Refusal: The fleet has no clock.
    """
    if "changes" not in over:
        return None
    if item is None:
        return rules.tolerance
    if item.tolerance is not None and rules.clock is None:
        raise invalid("changes/tolerance", "fleet-has-no-clock")
    return item.tolerance


def by_route(types: Sequence[NamedType], routes: Mapping[int, Route]) -> Iterator[NamedType]:
    """Yield types of vehicles of which each route has one of its own, by its number in the plan.

    Types that were told apart by an earlier plan alone are one again.
    """
    alike: dict[tuple[VehicleName, VehicleType], list[tuple[int, int]]] = {}
    for name, vehicle, old in types:
        home = vehicle.start if name.route is None else vehicle.home
        key = replace(name, route=None), replace(vehicle, count=1, home=home)
        alike.setdefault(key, []).append((old, vehicle.count))
    for (name, vehicle), known in alike.items():
        left = sum(count for _, count in known)
        for number, route in routes.items():
            if any(route.vehicle == old for old, _ in known):
                left -= 1
                yield replace(name, route=number), vehicle, route.vehicle
        if left:
            yield name, replace(vehicle, count=left), known[0][0]


def promised_begin(rules: Rules, visit: Visit, arrival: float | None, tolerance: float) -> float:
    """Return when a visit of the plan so far begins, or as promised before if it keeps that."""
    begin = inf if arrival is None else begin_of(visit, arrival, rules.slack)
    kept = not is_over(begin, visit.promised_by + tolerance)
    return min(begin, visit.promised_by) if kept else begin
