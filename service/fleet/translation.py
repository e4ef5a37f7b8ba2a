"""A fleet in PyVRP's terms: whole numbers, one matrix of distances and one of durations.

One objective becomes PyVRP's duration and the other its distance. Two objectives and a clock never
need a third matrix: the duration is the objective that is time, and a maximum is bounded by a limit
on each route. Costs are scaled by powers of ten, so that decimals of a few digits stay exact. Other
numbers are rounded against the plan, so that a plan of PyVRP breaks no rule.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pyvrp
from numpy.typing import NDArray

from service.fleet.evaluation import unassigned
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route
from service.fleet.rules import VehicleType
from service.fleet.scales import UNBOUNDED, Horizon, Squeezed, round_down, round_up, scales_of
from service.objectives import OBJECTIVES

_MOST_EXTRA = 2**50  # a prize or a fixed cost: 500 of them together do not overflow
Weights = tuple[int, int]


@dataclass(frozen=True, kw_only=True)
class Goal:
    """The goal of a search: minimise weighted distance and duration, with a limit on each route."""

    weights: Weights
    limit: int = UNBOUNDED


FREE = Goal(weights=(1, 1))  # the goal of solutions that were not found by a search


class Translation:
    """Translates a fleet to PyVRP's data, and PyVRP's solutions back to plans.

    Args:
        fleet: The fleet.
        loose: Whether times and lengths may exceed their bounds by as much as rounding adds. Then
            solutions may break rules.

    Attributes:
        distance: The objective that is PyVRP's distance.
        duration: The objective that is its duration; None if a maximum and a sum have equal costs,
            since the distance then serves both.
        scales: The factor of lengths in each objective.
        penalties: The greatest penalties.
    """

    def __init__(self, fleet: Fleet, loose: bool = False) -> None:
        rules = fleet.rules
        self.fleet = fleet
        # Each leg and each service may be rounded up by one.
        self._slack = 2 * (rules.n + 1) if loose else 0
        duration = 1 if rules.limited is None else rules.limited
        untimed_maximum = rules.clock is None and rules.maximum is not None
        same = untimed_maximum and np.array_equal(fleet.costs[0], fleet.costs[1])
        self.distance = 1 - duration
        self.duration = None if same else duration
        # A location for each stop, and one more for "anywhere": open routes start or end there.
        self._depots = [*sorted(rules.depots), rules.n]
        self._singles = [stop for stop in rules.clients if stop not in rules.shipped]
        self.squeezed = Squeezed.of(fleet)
        self._horizon = Horizon.of(rules, float(self.squeezed.largest[rules.clock or 0]))
        scales, self.penalties = scales_of(fleet, self.squeezed, self._horizon)
        self.scales = [scales[self.distance]] * OBJECTIVES if same else scales
        self._unlimited: tuple[Weights, pyvrp.ProblemData] | None = None  # the latest

    @property
    def sum_weights(self) -> Weights:
        """The weights of distance and duration with which the sum is minimised."""
        return (0, 1) if self.fleet.rules.maximum == self.distance else (1, 0)

    @cached_property
    def is_rounded(self) -> bool:
        """Whether a solution that keeps PyVRP's rules may break a rule of the fleet."""
        rules = self.fleet.rules
        pairs = ((rules.visits[s.pickup], rules.visits[s.delivery]) for s in rules.shipments)
        too_late = any(later.window[1] < earlier.window[0] for earlier, later in pairs)
        changed = self.fleet.forbids or self.squeezed.changed
        return self._slack > 0 or changed or too_late

    def plan(self, solution: pyvrp.Solution) -> Plan:
        """Return the plan of a solution."""
        stops = self._stops
        routes = (
            Route(route.vehicle_type(), tuple(stops[each] for each in _visits(route)))
            for route in solution.routes()
        )
        return Plan(tuple(route for route in routes if route.stops))

    def moved(self, solution: pyvrp.Solution, data: pyvrp.ProblemData) -> pyvrp.Solution:
        """Return a solution of other data of this fleet as a solution of these data."""
        routes = [pyvrp.Route(data, _visits(r), r.vehicle_type()) for r in solution.routes()]
        return pyvrp.Solution(data, routes)

    def solution(self, data: pyvrp.ProblemData, plan: Plan) -> pyvrp.Solution:
        """Return a plan as a solution of data that `data` returned."""
        activities = {stop: activity for activity, stop in self._stops.items()}
        routes = [
            pyvrp.Route(data, [activities[stop] for stop in route.stops], route.vehicle)
            for route in plan.routes
        ]
        return pyvrp.Solution(data, routes)

    def extras(self, plan: Plan) -> float:
        """Return the prizes that a plan loses and its fixed costs, all squeezed."""
        lost = self.squeezed.prizes[unassigned(self.fleet.rules, plan)]
        used = self.squeezed.fixed[[route.vehicle for route in plan.routes]]
        return float(lost.sum() + used.sum())

    def data(self, goal: Goal) -> pyvrp.ProblemData:
        """Return PyVRP's data for a goal."""
        if self._unlimited is None or self._unlimited[0] != goal.weights:
            self._unlimited = goal.weights, self._unlimited_data(Goal(weights=goal.weights))
        return self._unlimited[1].replace(vehicle_types=self._vehicles(goal))

    def _unlimited_data(self, goal: Goal) -> pyvrp.ProblemData:
        distances, durations = self._matrices
        return pyvrp.ProblemData(
            [pyvrp.Location(0, 0)] * len(distances),
            [self._client(stop, goal) for stop in self._singles],
            [pyvrp.Depot(location) for location in self._depots],
            self._vehicles(goal),
            [distances],  # type: ignore[list-item]  # PyVRP's stub means arrays of integers
            [durations],  # type: ignore[list-item]
            [],
            self._shipments(goal),
        )

    @cached_property
    def _matrices(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The distances and the durations, with a row and a column of zeros for "anywhere"."""
        scales = np.reshape(self.scales, (OBJECTIVES, 1, 1))
        padded = np.pad(round_up(self.squeezed.legs * scales), ((0, 0), (0, 1), (0, 1)))
        whole = padded.astype(np.int64)
        durations = np.zeros_like(whole[0]) if self.duration is None else whole[self.duration]
        return whole[self.distance], durations

    @cached_property
    def _stops(self) -> dict[pyvrp.Activity, int]:
        kinds = pyvrp.ActivityType
        found = {pyvrp.Activity(kinds.CLIENT, i): stop for i, stop in enumerate(self._singles)}
        for index, each in enumerate(self.fleet.rules.shipments):
            found[pyvrp.Activity(kinds.PICKUP, index)] = each.pickup
            found[pyvrp.Activity(kinds.DELIVERY, index)] = each.delivery
        return found

    def _client(self, stop: int, goal: Goal) -> pyvrp.Client:
        visit = self.fleet.rules.visits[stop]
        early, late, service = self._times(stop)
        return pyvrp.Client(
            stop,
            delivery=self._load(visit.demand),
            service_duration=service,
            tw_early=early,
            tw_late=late,
            prize=self._extra(self.squeezed.prizes[stop], goal),
            required=visit.prize is None,
        )

    def _shipments(self, goal: Goal) -> list[pyvrp.Shipment]:
        visits = self.fleet.rules.visits
        return [
            pyvrp.Shipment(
                each.pickup,
                each.delivery,
                *self._times(each.pickup),
                # In PyVRP a delivery may not end before its pick-up opens.
                *self._times(each.delivery, least_late=self._times(each.pickup)[0]),
                self._load(visits[each.pickup].demand),
                self._extra(self.squeezed.prizes[each.pickup], goal),
                visits[each.pickup].prize is None,
            )
            for each in self.fleet.rules.shipments
        ]

    def _vehicles(self, goal: Goal) -> list[pyvrp.VehicleType]:
        vehicles = zip(self.fleet.rules.vehicles, self.squeezed.fixed, strict=True)
        return [self._vehicle(vehicle, fixed, goal) for vehicle, fixed in vehicles]

    def _vehicle(self, vehicle: VehicleType, fixed: float, goal: Goal) -> pyvrp.VehicleType:
        distance, duration = goal.weights
        longest_distance, longest_duration = self._longest(vehicle, goal.limit)
        early = self._early(vehicle.shift[0])
        return pyvrp.VehicleType(
            min(vehicle.count, max(1, len(self.fleet.rules.clients))),
            list(vehicle.capacity),
            self._depot(vehicle.start),
            self._depot(vehicle.end),
            fixed_cost=self._extra(fixed, goal),
            tw_early=early,
            tw_late=max(early, self._late(vehicle.shift[1])),
            shift_duration=longest_duration,
            max_distance=longest_distance,
            unit_distance_cost=distance,
            unit_duration_cost=duration,
        )

    def _longest(self, vehicle: VehicleType, limit: int) -> tuple[int, int]:
        """Return the longest distance and the longest duration of a route."""
        rules = self.fleet.rules
        scale = self.scales[rules.limited or 0]
        longest = UNBOUNDED
        if vehicle.longest < UNBOUNDED / scale:
            longest = int(round_down(vehicle.longest * scale)) + self._slack
        limits_duration = self.duration is not None and rules.maximum == self.duration
        if rules.clock is not None and not limits_duration:
            return limit, longest
        limit = min(limit, longest)
        return (UNBOUNDED, limit) if limits_duration else (limit, UNBOUNDED)

    def _extra(self, cost: float, goal: Goal) -> int:
        """Return a cost that is added to the first objective, under the weights of a goal."""
        scaled = round(min(cost * self.scales[0], _MOST_EXTRA))
        return min(scaled * goal.weights[self.distance], _MOST_EXTRA)

    def _load(self, demand: Sequence[int]) -> list[int]:
        return list(demand or (0,) * self.fleet.rules.dimensions)

    def _depot(self, stop: int | None) -> int:
        return self._depots.index(self.fleet.rules.n if stop is None else stop)

    def _times(self, stop: int, least_late: int = 0) -> tuple[int, int, int]:
        """Return the earliest and latest begin of a visit, and how long it takes."""
        visit = self.fleet.rules.visits[stop]
        early, late = self._early(visit.window[0]), self._late(visit.window[1])
        service = int(round_up(visit.service * self._time_scale))
        return early, max(early, late, least_late), service

    def _early(self, time: float) -> int:
        return int(round_up(self._scaled_time(time)))

    def _late(self, time: float) -> int:
        if time >= self._horizon.end:
            return UNBOUNDED
        return int(round_down(self._scaled_time(time))) + self._slack

    def _scaled_time(self, time: float) -> float:
        return max(0.0, time - self._horizon.begin) * self._time_scale

    @property
    def _time_scale(self) -> float:
        return self.scales[self.fleet.rules.clock or 0]


def _visits(route: pyvrp.Route) -> list[pyvrp.Activity]:
    return [each for each in route.schedule() if not each.is_depot()]
