"""A fleet in PyVRP's terms: whole numbers, one matrix of distances and one of durations.

One of the two costs becomes PyVRP's duration and the other its distance: the duration is the clock,
and a maximum is bounded by a limit on each route. Costs are scaled by powers of ten, so that
decimals of a few digits stay exact. Other numbers are rounded against the plan, so that a plan of
PyVRP breaks no rule.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from math import inf

import numpy as np
import pyvrp
from numpy.typing import NDArray

from service.fleet.evaluation import unassigned
from service.fleet.fleet import LAYERS, Fleet
from service.fleet.goal import FREE, Goal, Weights
from service.fleet.loads import loads_of
from service.fleet.plans import Plan, Route
from service.fleet.scales import UNBOUNDED, Horizon, Squeezed, round_down, round_up, scales_of
from service.fleet.schedule import schedule
from service.fleet.vehicles import VehicleType

_MOST_EXTRA = 2**50  # a prize or a fixed cost: 500 of them together do not overflow
_PRIZE_DIGITS = 6  # the digits of the largest prize where prizes are an objective
_MANY = 2**30  # reloads of a vehicle without a limit


class Translation:
    """Translates a fleet to PyVRP's data, and PyVRP's solutions back to plans.

    Args:
        fleet: The fleet.
        loose: Whether times and lengths may exceed their bounds by as much as rounding adds. Then
            solutions may break rules.

    Attributes:
        distance: The number of the costs that are PyVRP's distance.
        duration: The number of those that are its duration; None if a maximum and a sum have equal
            costs, since the distance then serves both.
        scales: The factor of both costs.
        prize_scale: The factor of prizes.
        penalties: The greatest penalties.
    """

    def __init__(self, fleet: Fleet, loose: bool = False) -> None:
        rules = fleet.rules
        self.fleet = fleet
        # Each leg and each service may be rounded up by one.
        self._slack = 2 * (rules.n + 1) if loose else 0
        duration = 1 if rules.limited is None else rules.limited
        untimed_maximum = rules.clock is None and rules.swept is not None
        same = untimed_maximum and np.array_equal(fleet.costs[0], fleet.costs[1])
        self.distance = rules.sums[0] if same else 1 - duration
        self.duration = None if same else duration
        # A location for each stop, and one more for "anywhere": open routes start or end there.
        self._depots = [*sorted(rules.depots), rules.n]
        self._loads = loads_of(rules)
        # A client for each window of a stop.
        self._clients = [
            (stop, number)
            for stop in rules.clients
            if stop not in rules.shipped
            for number in range(len(rules.visits[stop].windows))
        ]
        self._has_choice = any(number for _, number in self._clients)  # of a window
        self.squeezed = Squeezed.of(fleet)
        self._horizon = Horizon.of(rules, float(self.squeezed.largest[rules.clock or 0]))
        scales, self.penalties = scales_of(fleet, self.squeezed, self._horizon)
        self.scales = [scales[self.distance]] * LAYERS if same else scales
        self.prize_scale = self.scales[0]
        if "unassigned" in rules.over:
            largest = float(self.squeezed.prizes.max())
            self.prize_scale = float(f"1e{math.floor(_PRIZE_DIGITS - math.log10(largest or 1.0))}")
        self._unlimited: tuple[Goal, pyvrp.ProblemData] | None = None  # the latest

    @property
    def sum_weights(self) -> Weights:
        """The weights of distance and duration with which the first sum is minimised."""
        return (1, 0) if self.fleet.rules.sums[0] == self.distance else (0, 1)

    @cached_property
    def is_rounded(self) -> bool:
        """Whether a solution that keeps PyVRP's rules may break a rule of the fleet."""
        rules = self.fleet.rules
        pairs = ((rules.visits[s.pickup], rules.visits[s.delivery]) for s in rules.shipments)
        too_late = any(later.windows[0][1] < earlier.windows[0][0] for earlier, later in pairs)
        # PyVRP refuses a window that closes before its load is released.
        too_late |= any(visit.release > visit.windows[0][1] for visit in rules.visits)
        changed = self.fleet.forbids or self.squeezed.changed
        trips = rules.reloads or any(vehicle.breaks for vehicle in rules.vehicles)
        loose = self._slack > 0 or rules.limits_times
        return loose or changed or too_late or trips or self._has_choice

    def plan(self, solution: pyvrp.Solution) -> Plan:
        """Return the plan of a solution."""
        stops_of = self._with_trips if self.fleet.rules.reloads else self._visited
        routes = (
            Route(route.vehicle_type(), stops_of(route.vehicle_type(), _visits(route)))
            for route in solution.routes()
        )
        return Plan(tuple(route for route in routes if route.stops))

    def _visited(self, _: int, activities: Sequence[pyvrp.Activity]) -> tuple[int, ...]:
        return tuple(self._stops[each] for each in activities)

    def _with_trips(self, vehicle: int, activities: Sequence[pyvrp.Activity]) -> tuple[int, ...]:
        """Return the stops of a route, without loading again before nothing is brought.

        A vehicle that carries nothing may load first, but not at its start.
        """
        kind = self.fleet.rules.vehicles[vehicle]
        stops: list[int] = []
        at = None if any(kind.initial_load) else kind.start  # where it has just loaded
        for activity in activities:
            stop = self._depots[activity.idx] if activity.is_depot() else self._stops[activity]
            if activity.is_depot() and stops and stops[-1] in kind.reload:
                stops.pop()
            if not activity.is_depot() or stops or stop != at:
                stops.append(stop)
        if stops and stops[-1] in kind.reload:
            stops.pop()
        return tuple(stops)

    def moved(self, solution: pyvrp.Solution, goal: Goal) -> pyvrp.Solution:
        """Return a solution that was found under another goal as one of the data for this goal.

        If it uses too many vehicles, it loses the routes with the fewest visits.
        """
        data, routes = self.data(goal), solution.routes()
        if goal.vehicles is not None:
            routes = [
                route
                for vehicle, most in enumerate(goal.vehicles)
                for route in _longest([r for r in routes if r.vehicle_type() == vehicle], most)
            ]
        moved = [pyvrp.Route(data, _visits(route), route.vehicle_type()) for route in routes]
        return pyvrp.Solution(data, moved)

    def solution(self, plan: Plan) -> pyvrp.Solution:
        """Return a plan as a solution of the data for the goal FREE."""
        data = self.data(FREE)
        routes = [
            pyvrp.Route(data, list(self._activities_of(route)), route.vehicle)
            for route in plan.routes
        ]
        return pyvrp.Solution(data, routes)

    def _activities_of(self, route: Route) -> Iterator[pyvrp.Activity]:
        """Yield the activity of each stop of a route, in the window that its vehicle uses."""
        rules = self.fleet.rules
        windows = [0] * len(route.stops)
        if any(len(rules.visits[stop].windows) > 1 for stop in route.stops):
            first = 0 if rules.vehicles[route.vehicle].start is None else 1
            windows = list(schedule(self.fleet, route).windows[first:])
        for stop, window in zip(route.stops, windows, strict=False):
            yield self._activities[stop, window]

    def extras(self, plan: Plan) -> float:
        """Return what a plan adds to its first length, squeezed: fixed costs, and lost prizes."""
        used = self.squeezed.fixed[[route.vehicle for route in plan.routes]]
        if "unassigned" in self.fleet.rules.over:
            return float(used.sum())
        return float(used.sum() + self.lost(plan))

    def lost(self, plan: Plan) -> float:
        """Return the prizes of the stops that a plan leaves out, squeezed."""
        return float(self.squeezed.prizes[unassigned(self.fleet.rules, plan)].sum())

    def uncollected(self, solution: pyvrp.Solution, goal: Goal) -> int:
        """Return the prizes that a solution leaves out, multiplied by their weight.

        For a stop with several windows PyVRP also counts those that were not chosen.
        """
        uncollected = solution.uncollected_prizes()
        if not self._has_choice:
            return uncollected
        return uncollected - sum(
            self._prize(stop, goal) for stop, number in self._clients if number
        )

    def data(self, goal: Goal) -> pyvrp.ProblemData:
        """Return PyVRP's data for a goal."""
        limit = UNBOUNDED if goal.limit == UNBOUNDED else 0
        unlimited = replace(goal, limit=limit, vehicles=None, overtime=inf)
        if self._unlimited is None or self._unlimited[0] != unlimited:
            self._unlimited = unlimited, self._unlimited_data(unlimited)
        return self._unlimited[1].replace(vehicle_types=self._vehicles(goal))

    def _unlimited_data(self, goal: Goal) -> pyvrp.ProblemData:
        distances, durations = self._matrices
        groups: dict[int, list[int]] = {}
        for client, (stop, _) in enumerate(self._clients):
            groups.setdefault(stop, []).append(client)
        several = [stop for stop, clients in groups.items() if len(clients) > 1]
        return pyvrp.ProblemData(
            [pyvrp.Location(0, 0)] * len(distances),
            [
                self._client(stop, number, goal, several.index(stop) if stop in several else None)
                for stop, number in self._clients
            ],
            [pyvrp.Depot(location) for location in self._depots],
            self._vehicles(goal),
            [distances],  # type: ignore[list-item]  # PyVRP's stub means arrays of integers
            [durations],  # type: ignore[list-item]
            [
                pyvrp.ClientGroup(groups[stop], self.fleet.rules.visits[stop].prize is None)
                for stop in several
            ],
            self._shipments(goal),
        )

    @cached_property
    def _matrices(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The distances and the durations, with a row and a column of zeros for "anywhere"."""
        scales = np.reshape(self.scales, (LAYERS, 1, 1))
        padded = np.pad(round_up(self.squeezed.legs * scales), ((0, 0), (0, 1), (0, 1)))
        whole = padded.astype(np.int64)
        durations = np.zeros_like(whole[0]) if self.duration is None else whole[self.duration]
        return whole[self.distance], durations

    @cached_property
    def _stops(self) -> dict[pyvrp.Activity, int]:
        kinds = pyvrp.ActivityType
        found = {pyvrp.Activity(kinds.CLIENT, i): stop for i, (stop, _) in enumerate(self._clients)}
        for index, each in enumerate(self.fleet.rules.shipments):
            found[pyvrp.Activity(kinds.PICKUP, index)] = each.pickup
            found[pyvrp.Activity(kinds.DELIVERY, index)] = each.delivery
        return found

    @cached_property
    def _activities(self) -> dict[tuple[int, int], pyvrp.Activity]:
        """The activity of each stop in each of its windows."""
        kinds = pyvrp.ActivityType
        depots = {
            (stop, 0): pyvrp.Activity(kinds.DEPOT, index) for index, stop in enumerate(self._depots)
        }
        clients = {each: pyvrp.Activity(kinds.CLIENT, i) for i, each in enumerate(self._clients)}
        others = {(stop, 0): activity for activity, stop in self._stops.items()}
        return {**others, **depots, **clients}

    def _client(self, stop: int, number: int, goal: Goal, group: int | None) -> pyvrp.Client:
        visit = self.fleet.rules.visits[stop]
        early, late, service = self._times(stop, number, goal)
        return pyvrp.Client(
            stop,
            delivery=self._loads.demand[stop].tolist(),
            service_duration=service,
            tw_early=early,
            tw_late=late,
            release_time=0 if self._opens_later(goal) else self._early(visit.release),
            prize=self._prize(stop, goal),
            required=visit.prize is None and group is None,
            group=group,
        )

    def _shipments(self, goal: Goal) -> list[pyvrp.Shipment]:
        visits = self.fleet.rules.visits
        return [
            pyvrp.Shipment(
                each.pickup,
                each.delivery,
                *self._times(each.pickup, 0, goal),
                # In PyVRP a delivery may not end before its pick-up opens.
                *self._times(each.delivery, 0, goal, self._times(each.pickup, 0, goal)[0]),
                self._loads.demand[each.pickup].tolist(),
                self._prize(each.pickup, goal),
                visits[each.pickup].prize is None,
            )
            for each in self.fleet.rules.shipments
        ]

    def _vehicles(self, goal: Goal) -> list[pyvrp.VehicleType]:
        return [self._vehicle(index, goal) for index in range(len(self.fleet.rules.vehicles))]

    def _vehicle(self, index: int, goal: Goal) -> pyvrp.VehicleType:
        vehicle = self.fleet.rules.vehicles[index]
        count = min(vehicle.count, max(1, len(self.fleet.rules.clients)))
        if goal.vehicles is not None:
            count = min(count, goal.vehicles[index])
        fixed = self._extra(float(self.squeezed.fixed[index]), goal)
        distance, duration = goal.weights
        longest_distance, longest_duration = self._longest(vehicle, goal.limit)
        early = self._early(vehicle.shift[0])
        return pyvrp.VehicleType(
            # PyVRP needs a vehicle of each type: one that must not leave costs very much.
            max(1, count),
            self._loads.capacity[index].tolist(),
            self._depot(vehicle.start),
            self._depot(vehicle.end),
            fixed_cost=fixed if count else _MOST_EXTRA,
            tw_early=early,
            # PyVRP knows no breaks: its routes end earlier, so that there is time for them.
            tw_late=max(
                early,
                self._late(
                    vehicle.shift[1] + min(vehicle.max_overtime, goal.overtime) - vehicle.rest
                ),
            ),
            shift_duration=longest_duration,
            max_distance=longest_distance,
            unit_distance_cost=distance,
            unit_duration_cost=duration,
            start_late=self._latest_departure(vehicle),
            initial_load=self._loads.initial[index].tolist(),
            reload_depots=[self._depot(stop) for stop in vehicle.reload],
            max_reloads=_MANY if vehicle.max_trips is None else vehicle.max_trips - 1,
        )

    def _latest_departure(self, vehicle: VehicleType) -> int | None:
        if vehicle.leaves_by == inf:
            return None
        return max(self._early(vehicle.shift[0]), self._late(vehicle.leaves_by))

    def _longest(self, vehicle: VehicleType, limit: int) -> tuple[int, int]:
        """Return the longest distance and the longest duration of a route."""
        rules = self.fleet.rules
        scale = self.scales[rules.limited or 0]
        longest = UNBOUNDED
        if vehicle.longest < UNBOUNDED / scale:
            longest = int(round_down(vehicle.longest * scale)) + self._slack
        limits_duration = self.duration is not None and rules.swept == self.duration
        if rules.clock is not None and not limits_duration:
            return limit, longest
        limit = min(limit, longest)
        return (UNBOUNDED, limit) if limits_duration else (limit, UNBOUNDED)

    def _extra(self, cost: float, goal: Goal) -> int:
        """Return a cost that is added to the first objective, under the weights of a goal."""
        scaled = round(min(cost * self.scales[0], _MOST_EXTRA))
        return min(scaled * goal.weights[self.distance], _MOST_EXTRA)

    def _prize(self, stop: int, goal: Goal) -> int:
        """Return the cost of leaving a stop out under a goal."""
        prize = float(self.squeezed.prizes[stop])
        if "unassigned" not in self.fleet.rules.over:
            return self._extra(prize, goal)
        return min(round(min(prize * self.prize_scale, _MOST_EXTRA)) * goal.prizes, _MOST_EXTRA)

    def _depot(self, stop: int | None) -> int:
        return self._depots.index(self.fleet.rules.n if stop is None else stop)

    def _times(
        self, stop: int, number: int, goal: Goal, least_late: int = 0
    ) -> tuple[int, int, int]:
        """Return the earliest and latest begin of a visit in a window, and how long it takes."""
        visit = self.fleet.rules.visits[stop]
        opens, closes = visit.windows[number]
        if visit.release and self._opens_later(goal):
            opens = max(opens, visit.release + self.fleet.nearest_loading[stop])
        early, late = self._early(opens), self._late(min(closes, visit.due + goal.lateness))
        least_late = max(least_late, self._early(visit.release))
        service = int(round_up(visit.service * self._time_scale))
        return early, max(early, late, least_late), service

    def _opens_later(self, goal: Goal) -> bool:
        """Return whether windows open later in place of releases, which are checked afterwards.

        The local search of PyVRP 0.14 may never end if routes have a limit on their time and load
        again what is released later.
        """
        rules = self.fleet.rules
        limited = goal.limit < UNBOUNDED and rules.swept == rules.clock
        return rules.reloads and (limited or rules.has_longest)

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
    """Return the visits of a route, and where it loads again, but not its start and its end."""
    return list(route.schedule()[1:-1])


def _longest(routes: list[pyvrp.Route], most: int) -> list[pyvrp.Route]:
    """Return the routes with the most visits."""
    return sorted(routes, key=len, reverse=True)[:most]
