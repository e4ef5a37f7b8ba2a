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
from service.fleet.fleet import Array, Fleet, VehicleType
from service.fleet.plans import Plan, Route
from service.fleet.scales import (
    UNBOUNDED,
    Horizon,
    most_legs,
    round_down,
    round_up,
    scales_of,
)
from service.fleet.squeezing import Squeezed

_MOST_EXTRA = 2**50  # a prize or a fixed cost: 500 of them together do not overflow
Weights = tuple[int, int]


@dataclass(frozen=True, kw_only=True)
class Goal:
    """The goal of a search: minimise weighted distance and duration, with a limit on each route."""

    weights: Weights
    limit: int = UNBOUNDED


FREE = Goal(weights=(1, 1))  # the goal of solutions that were not found by a search


@dataclass(frozen=True)
class _Roles:
    """The objectives that are PyVRP's distance and its duration, and the limited objective."""

    distance: int
    duration: int | None
    limited: int | None

    @classmethod
    def of(cls, fleet: Fleet) -> "_Roles":
        rules = fleet.rules
        if rules.clock is not None:
            return cls(1 - rules.clock, rules.clock, rules.maximum)
        if rules.maximum is None:
            return cls(0, 1, None)
        summed = 1 - rules.maximum
        if np.array_equal(fleet.costs[0], fleet.costs[1]):
            return cls(summed, None, rules.maximum)
        return cls(summed, rules.maximum, rules.maximum)


class Translation:
    """Translates a fleet to PyVRP's data, and PyVRP's solutions back to plans.

    Args:
        fleet: The fleet.
        loose: Whether times and lengths may exceed their bounds by as much as rounding adds. Then
            solutions may break rules.
    """

    def __init__(self, fleet: Fleet, loose: bool = False) -> None:
        self.fleet = fleet
        # Each leg and each service may be rounded up by one.
        self._slack = 2 * (fleet.rules.n + 1) if loose else 0
        self.roles = _Roles.of(fleet)
        rules = fleet.rules
        # A location for each stop, and one more for "anywhere": open routes start or end there.
        self.anywhere = rules.n
        self._depots = [*sorted(rules.depots), self.anywhere]
        self._singles = [stop for stop in rules.clients if stop not in rules.shipped]
        self.squeezed = Squeezed.of(fleet, most_legs(rules))
        clock = 0 if rules.clock is None else rules.clock
        self._horizon = Horizon.of(rules, float(self.squeezed.largest[clock]))
        scales, self.penalties = scales_of(fleet, self.squeezed, self._horizon)
        duration = self.roles.duration
        self.distance_scale = scales[self.roles.distance]
        self.duration_scale = 1.0 if duration is None else scales[duration]
        self._unlimited: tuple[Weights, pyvrp.ProblemData] | None = None  # the latest

    @cached_property
    def _matrices(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        distance, duration = self.roles.distance, self.roles.duration
        distances = self._matrix(self.squeezed.legs[distance], self.distance_scale)
        if duration is None:
            return distances, np.zeros_like(distances)
        return distances, self._matrix(self.squeezed.legs[duration], self.duration_scale)

    def _matrix(self, costs: Array, scale: float) -> NDArray[np.int64]:
        padded = np.zeros((len(costs) + 1, len(costs) + 1), np.int64)
        padded[:-1, :-1] = round_up(costs * scale)
        return padded

    @cached_property
    def _locations(self) -> list[pyvrp.Location]:
        return [pyvrp.Location(0, 0) for _ in range(self.anywhere + 1)]

    def scale(self, objective: int) -> float:
        """Return the factor of lengths in this objective."""
        return self.duration_scale if objective == self.roles.duration else self.distance_scale

    @property
    def limit_scale(self) -> float:
        """The factor of lengths in the limited objective."""
        return self.duration_scale if self._limits_duration else self.distance_scale

    @property
    def _limits_duration(self) -> bool:
        return self.roles.duration is not None and self.roles.limited == self.roles.duration

    @property
    def sum_weights(self) -> Weights:
        """The weights of distance and duration with which the sum is minimised."""
        return (0, 1) if self.roles.limited == self.roles.distance and self._two else (1, 0)

    @property
    def _two(self) -> bool:
        return self.roles.duration is not None

    def data(self, goal: Goal) -> pyvrp.ProblemData:
        """Return PyVRP's data for a goal."""
        if self._unlimited is None or self._unlimited[0] != goal.weights:
            self._unlimited = goal.weights, self._unlimited_data(Goal(weights=goal.weights))
        return self._unlimited[1].replace(vehicle_types=self._vehicles(goal))

    def _unlimited_data(self, goal: Goal) -> pyvrp.ProblemData:
        distances, durations = self._matrices
        return pyvrp.ProblemData(
            self._locations,
            [self._client(stop, goal) for stop in self._singles],
            [pyvrp.Depot(location) for location in self._depots],
            self._vehicles(goal),
            [distances],  # type: ignore[list-item]  # PyVRP's stub means arrays of integers
            [durations],  # type: ignore[list-item]
            [],
            self._shipments(goal),
        )

    def plan(self, solution: pyvrp.Solution) -> Plan:
        """Return the plan of a solution."""
        return Plan(
            tuple(
                Route(route.vehicle_type(), tuple(self._stop(each) for each in visits))
                for route in solution.routes()
                if (visits := [each for each in route.schedule() if not each.is_depot()])
            )
        )

    def extras(self, plan: Plan) -> float:
        """Return the prizes that a plan loses and its fixed costs, all squeezed."""
        lost = self.squeezed.prizes[unassigned(self.fleet.rules, plan)]
        used = self.squeezed.fixed[[route.vehicle for route in plan.routes]]
        return float(lost.sum() + used.sum())

    def solution(self, data: pyvrp.ProblemData, plan: Plan) -> pyvrp.Solution:
        """Return a plan as a solution of data that `data` returned."""
        routes = [
            pyvrp.Route(data, [self._activities[stop] for stop in route.stops], route.vehicle)
            for route in plan.routes
        ]
        return pyvrp.Solution(data, routes)

    @cached_property
    def _activities(self) -> dict[int, pyvrp.Activity]:
        kinds = pyvrp.ActivityType
        found = {s: pyvrp.Activity(kinds.CLIENT, i) for i, s in enumerate(self._singles)}
        for index, each in enumerate(self.fleet.rules.shipments):
            found[each.pickup] = pyvrp.Activity(kinds.PICKUP, index)
            found[each.delivery] = pyvrp.Activity(kinds.DELIVERY, index)
        return found

    @cached_property
    def is_rounded(self) -> bool:
        """Whether a solution that keeps PyVRP's rules may break a rule of the fleet."""
        rules = self.fleet.rules
        pairs = ((rules.visits[s.pickup], rules.visits[s.delivery]) for s in rules.shipments)
        too_late = any(later.window[1] < earlier.window[0] for earlier, later in pairs)
        changed = self.fleet.forbids or self.squeezed.changed
        return self._slack > 0 or changed or too_late

    def _stop(self, activity: pyvrp.Activity) -> int:
        if activity.is_client():
            return self._singles[activity.idx]
        shipment = self.fleet.rules.shipments[activity.idx]
        is_pickup = activity.type == pyvrp.ActivityType.PICKUP
        return shipment.pickup if is_pickup else shipment.delivery

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
        return [
            pyvrp.Shipment(
                each.pickup,
                each.delivery,
                *self._times(each.pickup),
                *self._times_after(each.delivery, each.pickup),
                self._load(self.fleet.rules.visits[each.pickup].demand),
                self._extra(self.squeezed.prizes[each.pickup], goal),
                self.fleet.rules.visits[each.pickup].prize is None,
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
        timed = self.fleet.rules.clock is not None
        scale = self.duration_scale if timed else self.limit_scale
        longest = UNBOUNDED
        if vehicle.longest < UNBOUNDED / scale:
            longest = int(round_down(vehicle.longest * scale)) + self._slack
        if timed and not self._limits_duration:
            return limit, longest
        limit = min(limit, longest)
        return (UNBOUNDED, limit) if self._limits_duration else (limit, UNBOUNDED)

    def _extra(self, cost: float, goal: Goal) -> int:
        """Return a cost that is added to the first objective, under the weights of a goal."""
        is_distance = self.roles.distance == 0
        weight = goal.weights[0 if is_distance else 1]
        scale = self.distance_scale if is_distance else self.duration_scale
        return min(round(min(cost * scale, _MOST_EXTRA)) * weight, _MOST_EXTRA)

    def _load(self, demand: Sequence[int]) -> list[int]:
        return list(demand or (0,) * self.fleet.rules.dimensions)

    def _depot(self, stop: int | None) -> int:
        return self._depots.index(self.anywhere if stop is None else stop)

    def _times(self, stop: int) -> tuple[int, int, int]:
        """Return the earliest and latest begin of a visit, and how long it takes."""
        visit = self.fleet.rules.visits[stop]
        service = int(round_up(visit.service * self.duration_scale))
        early = self._early(visit.window[0])
        return early, max(early, self._late(visit.window[1])), service

    def _times_after(self, stop: int, earlier: int) -> tuple[int, int, int]:
        """Return the same for a delivery; in PyVRP it may not end before its pick-up opens."""
        early, late, service = self._times(stop)
        return early, max(late, self._times(earlier)[0]), service

    def _early(self, time: float) -> int:
        return int(round_up(self._since_begin(time) * self.duration_scale))

    def _late(self, time: float) -> int:
        if time >= self._horizon.end:
            return UNBOUNDED
        return int(round_down(self._since_begin(time) * self.duration_scale)) + self._slack

    def _since_begin(self, time: float) -> float:
        return max(0.0, time - self._horizon.begin)
