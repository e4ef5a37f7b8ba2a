"""A fleet: its rules, the costs between its stops, and the units of its objectives."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf

import numpy as np
from numpy.typing import NDArray

from service.fleet.rules import Measure, Over, Rules
from service.instance import largest_costs, ordinary_costs

Array = NDArray[np.float64]
LAYERS = 2  # costs of a leg


@dataclass(frozen=True, eq=False, kw_only=True)
class Fleet:
    """Rules, and two costs of the legs between the stops, shape (2, n, n).

    `rules.layers` has the number of each objective's costs, 0 or 1. If only one objective has
    costs, the second costs are those of the clock, or a copy of the first. Costs get a diagonal of
    0, and are read-only. A leg with an infinite cost is forbidden: both its costs become infinite.
    """

    rules: Rules
    costs: Array

    def __post_init__(self) -> None:
        shape = (LAYERS, self.rules.n, self.rules.n)
        if self.costs.shape != shape:
            raise ValueError(f"costs must have shape {shape}, got {self.costs.shape}")
        costs = np.where(np.eye(self.rules.n, dtype=np.bool_), 0.0, self.costs)
        if not (costs >= 0).all():
            raise ValueError("costs must be numbers and not negative")
        costs[:, np.isinf(costs).any(axis=0)] = inf
        costs.flags.writeable = False
        object.__setattr__(self, "costs", costs)

    @cached_property
    def forbids(self) -> bool:
        """Whether some leg is forbidden."""
        return bool(np.isinf(self.costs[0]).any())

    @cached_property
    def needed_legs(self) -> Array:
        """The least cost, shape (2,), such that legs up to it lead to all stops and back.

        Unreachable stops do not count.
        """
        starts = _places([vehicle.start for vehicle in self.rules.vehicles], self.rules)
        ends = _places([vehicle.end for vehicle in self.rules.vehicles], self.rules)
        return np.array([max(_least_bound(c, starts), _least_bound(c.T, ends)) for c in self.costs])

    @cached_property
    def largest_legs(self) -> Array:
        """The largest of each cost of a leg in ordinary plans, shape (2,).

        Outliers count only if a stop cannot be reached or left without them.
        """
        largest, needed = largest_costs(self.costs), self.needed_legs
        ordinary = ordinary_costs(self.costs, largest)
        legs: Array = np.where(needed > ordinary, needed + ordinary, ordinary)
        return np.minimum(legs, largest)

    @cached_property
    def scale(self) -> Array:
        """The unit of each of m objectives, shape (m,), 1 if that would be 0.

        It is the largest leg, of lateness by the clock and of imbalance in the costs by which
        routes are compared; otherwise one vehicle, the largest prize, the most overtime of a
        vehicle, or the largest leg with the largest capacity.
        """
        pairs = zip(self.rules.over, self.rules.layers, strict=True)
        units = np.array([self._unit(over, layer) for over, layer in pairs])
        return np.where(units > 0, units, 1.0)

    def _unit(self, over: Over | Measure, layer: int) -> float:
        legs, rules = self.largest_legs, self.rules
        match over:
            case "vehicles":
                return 1.0
            case "unassigned":
                return max(visit.prize or 0.0 for visit in rules.visits)
            case "overtime":
                return max(vehicle.max_overtime for vehicle in rules.vehicles)
            case "lateness" | "imbalance":
                return float(legs[rules.limited or 0])
            case "load_distance":
                return float(legs[0]) * max(each.capacity[0] for each in rules.vehicles)
        return float(legs[layer])


def least_paths(costs: Array, starts: Sequence[int], combine: np.ufunc = np.add) -> Array:
    """Return the least cost of a path from any of the starts to each stop, shape (n,). O(n^2).

    This is Dijkstra's algorithm over arrays.

    Args:
        costs: The costs of legs, shape (n, n); infinite for forbidden legs.
        starts: The stops where paths may start.
        combine: How the costs of legs make the cost of a path: np.add, or np.maximum.
    """
    least = np.full(len(costs), inf)
    least[list(starts)] = 0.0
    left = np.ones(len(costs), np.bool_)
    for _ in range(len(costs)):
        nearest = int(np.where(left, least, inf).argmin())
        if not left[nearest] or least[nearest] == inf:
            break
        left[nearest] = False
        least = np.minimum(least, combine(least[nearest], costs[nearest]))
    return least


def _places(ends: Sequence[int | None], rules: Rules) -> list[int]:
    """Return the stops at which routes start or end; one stop if a single route may start anywhere.

    Several vehicles with open routes may begin at every stop, so no stop is needed as a start.
    """
    if None not in ends:
        return sorted({end for end in ends if end is not None})
    if sum(vehicle.count for vehicle in rules.vehicles) > 1:
        return []
    return [0]


def _least_bound(costs: Array, starts: Sequence[int]) -> float:
    """Return the least cost such that legs up to it lead from the starts to all stops. O(n^2).

    Without starts, one such leg must lead to each stop.
    """
    if not starts:
        steps = np.where(np.eye(len(costs), dtype=np.bool_), inf, costs).min(axis=0)
        return float(steps.max(where=np.isfinite(steps), initial=0.0))
    bounds = least_paths(costs, starts, np.maximum)
    return float(bounds.max(where=np.isfinite(bounds), initial=0.0))


def default_reference_point(fleet: Fleet) -> Array:
    """Return lengths above those of sensible plans under m objectives, shape (m,).

    They are the number of stops times the scale, plus what else can add to a length. In the first
    objective these are all prizes and fixed costs. In objectives of the clock, in lateness and in
    imbalance by the clock they are all services, and the time from the first shift or window to the
    end of the last, in which a vehicle may wait: once, or for each vehicle if times are summed.
    """
    rules = fleet.rules
    point = rules.n * fleet.scale
    prizes = sum(visit.prize or 0.0 for visit in rules.visits)
    point[0] += 0.0 if "unassigned" in rules.over else prizes
    point[0] += sum(vehicle.fixed * min(vehicle.count, rules.n) for vehicle in rules.vehicles)
    vehicles = min(sum(vehicle.count for vehicle in rules.vehicles), rules.n)
    for objective, (over, layer) in enumerate(zip(rules.over, rules.layers, strict=True)):
        timed = {"lateness": True, "imbalance": rules.clock is not None}
        costs = over in ("sum", "max") and layer == rules.clock
        if costs or timed.get(over, False):
            point[objective] += sum(visit.service for visit in rules.visits)
            once = over in ("max", "imbalance")
            point[objective] += _waiting(rules) * (1 if once else vehicles)
    return point


def _waiting(rules: Rules) -> float:
    """Return the longest time that a vehicle may wait between two bounds of times."""
    bounds = [time for span in rules.spans for time in span if time < inf]
    return max(bounds, default=0.0) - min(bounds, default=0.0)
