"""A fleet: its rules, the costs between its stops, and the units of its objectives."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import inf

import numpy as np
from numpy.typing import NDArray

from service.day.costs import CostsOfDay
from service.fleet.costs import Day, allowed, checked, on_days
from service.fleet.measures.table import MEASURES, OF_TIME, Measure
from service.fleet.paths import least_paths
from service.fleet.rules import Over, Rules
from service.fleet.straight import Line
from service.instance import SAMPLED, largest_costs, ordinary_cost

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
LAYERS = 2  # costs of a leg
_BLOCK = 2**15  # costs that are worked out at once


@dataclass(frozen=True, eq=False, kw_only=True)
class Fleet:
    """Rules, and two costs of the legs between n stops: as matrices, or as lines.

    `rules.layers` has the number of each objective's costs, 0 or 1. If only one objective has
    costs, the second costs are those of the clock, or a copy of the first. Matrices get a diagonal
    of 0, and are read-only. A leg with an infinite cost is forbidden: both its costs become
    infinite.

    Args:
        rules: The rules.
        costs: The matrices, shape (2, n, n); without stops, shape (2, 0, 0), if there are lines.
        lines: The two lines instead of them; none if there are matrices.
        profiles: The matrices of each profile, if types of vehicles drive by different ones.
            `costs` are then the least of them.
        days: Both costs over the day by each profile, if some change; none if not. All profiles
            have the same slices, and the matrices are then the means.
        sampled: The clock's times of the legs on each of several days, shape (d, n, n), by all
            profiles; None if they are not given. The matrices have their means.
    """

    rules: Rules
    costs: Array
    lines: tuple[Line, ...] = ()
    profiles: tuple[Array, ...] = ()
    days: tuple[Day, ...] = ()
    sampled: Array | None = None

    @classmethod
    def of_profiles(
        cls,
        rules: Rules,
        profiles: Sequence[Array],
        days: Sequence[Day] = (),
        sampled: Array | None = None,
    ) -> "Fleet":
        """Return a fleet whose types of vehicles drive by profiles, whose costs these are."""
        several = tuple(profiles) if len(profiles) > 1 else ()
        return cls(
            rules=rules, costs=profiles[0], profiles=several, days=tuple(days), sampled=sampled
        )

    @classmethod
    def of_lines(cls, rules: Rules, lines: Sequence[Line]) -> "Fleet":
        """Return a fleet whose legs are lines, which are worked out where they are read."""
        return cls(rules=rules, costs=np.empty((LAYERS, 0, 0)), lines=tuple(lines))

    @classmethod
    def over_the_day(cls, rules: Rules, *costs: CostsOfDay) -> "Fleet":
        """Return a fleet whose costs change over the day, with the means of its shifts.

        `costs` are both costs by one profile after another.
        """
        ends = [end for vehicle in rules.vehicles for end in vehicle.way if end < inf]
        begin = rules.begin
        end = max([begin, *ends, *(each.begins[-1] for each in costs)])
        days = list(zip(costs[::LAYERS], costs[1::LAYERS], strict=True))
        means = [np.stack([each.mean(begin, end) for each in day]) for day in days]
        return cls.of_profiles(rules, means, days)

    def __post_init__(self) -> None:
        n = 0 if self.lines else self.rules.n
        if self.costs.shape != (LAYERS, n, n):
            raise ValueError(f"costs must have shape {(LAYERS, n, n)}, got {self.costs.shape}")
        profiles = tuple(map(checked, self._by_profile))
        costs = np.minimum.reduce(profiles) if self.profiles else profiles[0]
        costs.flags.writeable = False
        object.__setattr__(self, "costs", costs)
        object.__setattr__(self, "profiles", profiles if self.profiles else ())
        if self.days:
            pairs = zip(self.days, profiles, strict=True)
            days = tuple(allowed(day, np.isinf(means[0])) for day, means in pairs)
            object.__setattr__(self, "days", days)
        if self.sampled is not None:
            object.__setattr__(self, "sampled", on_days(self.sampled, self.rules.n))

    def under(self, rules: Rules) -> "Fleet":
        """Return the fleet under other rules."""
        return replace(self, rules=rules)

    def chosen(self, rules: Rules, stops: Indices) -> "Fleet":
        """Return a fleet of some of the stops, which may repeat."""
        if self.lines:
            return Fleet.of_lines(rules, [line.chosen(stops) for line in self.lines])
        rows = stops[:, np.newaxis]
        costs = [each[:, rows, stops] for each in self._by_profile]
        days = [(first.among(stops), second.among(stops)) for first, second in self.days]
        sampled = None if self.sampled is None else self.sampled[:, rows, stops]
        return Fleet.of_profiles(rules, costs, days, sampled)

    def scaled(self, rules: Rules, shifts: Indices) -> "Fleet":
        """Return a fleet whose costs are multiplied by powers of two, shape (2,)."""
        if self.lines:
            pairs = zip(self.lines, shifts.tolist(), strict=True)
            return Fleet.of_lines(rules, [line.scaled(shift) for line, shift in pairs])
        powers = shifts[:, np.newaxis, np.newaxis]
        costs = [np.ldexp(each, powers) for each in self._by_profile]
        by, times = shifts.tolist(), int(shifts[rules.clock or 0])
        days = [
            (first.scaled(by[0], times), second.scaled(by[1], times)) for first, second in self.days
        ]
        sampled = None if self.sampled is None else np.ldexp(self.sampled, times)
        return Fleet.of_profiles(rules, costs, days, sampled)

    @property
    def _by_profile(self) -> tuple[Array, ...]:
        """The matrices of each profile."""
        return self.profiles or (self.costs,)

    @property
    def day(self) -> Day | None:
        """Both costs over the day by the first profile, if some change."""
        return self.days[0] if self.days else None

    def day_by(self, vehicle: int) -> Day:
        """Return both costs over the day to a type of vehicles."""
        return self.days[self.rules.vehicles[vehicle].profile]

    def costs_by(self, profile: int) -> Array:
        """Return both costs of the legs by a profile; of lines and over the day, `costs`."""
        return self.profiles[profile] if self.profiles else self.costs

    @cached_property
    def _each_profile(self) -> tuple["Fleet", ...]:
        """A fleet of each profile alone, if there are some."""
        return tuple(Fleet(rules=self.rules, costs=costs) for costs in self.profiles)

    def leg(self, layer: int, a: int, b: int, vehicle: int) -> float:
        """Return a cost of a leg to a type of vehicles; over the day the least one."""
        if self.lines:
            return float(self.lines[layer].legs(a, b))
        profile = self.rules.vehicles[vehicle].profile
        return float((self._least if self.day else self.costs_by(profile))[layer, a, b])

    @cached_property
    def _least(self) -> Array:
        """The least costs of the day, shape (2, n, n)."""
        if not self.days:
            return self.costs
        pairs = ([each.least() for each in day] for day in self.days)
        return np.minimum.reduce([np.stack(pair) for pair in pairs])

    def legs_along(self, layer: int, path: Sequence[int], vehicle: int) -> list[float]:
        """Return a cost of each leg of a path to a type of vehicles, at the usual speed."""
        stops = np.array(path, np.int64)
        a, b = stops[:-1], stops[1:]
        costs = self.costs_by(self.rules.vehicles[vehicle].profile)
        along: Array = self.lines[layer].legs(a, b) if self.lines else costs[layer, a, b]
        return along.tolist()

    def legs_from(self, layer: int, stop: int) -> Array:
        """Return a cost of the legs from a stop to all stops, shape (n,)."""
        return self.lines[layer].legs_from(stop) if self.lines else self.costs[layer, stop]

    def legs_to(self, layer: int, stop: int) -> Array:
        """Return a cost of the legs from all stops to one, shape (n,)."""
        return self.lines[layer].legs_from(stop) if self.lines else self.costs[layer, :, stop]

    def among(self, stops: Indices) -> Array:
        """Return both costs between some stops, shape (2, k, k)."""
        if self.lines:
            return np.array([line.legs(stops[:, np.newaxis], stops) for line in self.lines])
        return self.costs[:, stops[:, np.newaxis], stops]

    def matrices(self) -> Array:
        """Return all costs, shape (2, n, n)."""
        return self.among(np.arange(self.rules.n)) if self.lines else self.costs

    def least_paths(self, layer: int, starts: Sequence[int], *, back: bool = False) -> Array:
        """Return the least cost of a path from any of the starts to each stop, shape (n,). O(n^2).

        Over the day it is a bound below that cost.

        Args:
            starts: The stops where paths may start.
            back: Whether paths lead from the stops to the starts instead.
        """
        legs = self.legs_to if back else self.legs_from
        if self.lines:  # no detour is shorter
            return np.min([legs(layer, start) for start in starts], axis=0, initial=inf)
        rows = self._least[layer].T if back else self._least[layer]
        return least_paths(rows.__getitem__, self.rules.n, starts)

    def nearest(self, layer: int) -> tuple[Array, Array]:
        """Return the least cost of a leg to and from each stop, shape (n,) both. O(n^2)."""
        to, away = np.full((2, self.rules.n), inf)
        begin = 0
        for block in self._blocks(layer) if self.day is None else [self._least[layer]]:
            rows = np.arange(begin, begin + len(block))
            others = np.where(rows[:, np.newaxis] == np.arange(self.rules.n), inf, block)
            to = np.minimum(to, others.min(axis=0))
            away[rows] = others.min(axis=1)
            begin += len(block)
        return to, away

    def _blocks(self, layer: int) -> Iterator[Array]:
        """Yield a cost of all legs, some stops after the other, shape (k, n)."""
        if not self.lines:
            yield self.costs[layer]
            return
        stops = np.arange(self.rules.n)
        for some in np.array_split(stops, -(-(len(stops) ** 2) // _BLOCK)):
            yield self.lines[layer].legs(some[:, np.newaxis], stops)

    @cached_property
    def forbids(self) -> bool:
        """Whether some leg is forbidden to some vehicles."""
        return any(bool(np.isinf(each[0]).any()) for each in self._by_profile)

    def away(self, stop: int) -> Array:
        """Return how far all stops are away, in largest legs of both costs, shape (n,)."""
        units = np.where(self.largest_legs > 0, self.largest_legs, 1.0).tolist()
        if self._are_alike:
            return LAYERS / units[0] * self.lines[0].legs_from(stop)
        return np.sum(
            [
                np.minimum(self.legs_from(layer, stop), self.legs_to(layer, stop)) / unit
                for layer, unit in enumerate(units)
            ],
            axis=0,
        )

    @cached_property
    def has_one_cost(self) -> bool:
        """Whether both costs are the same."""
        if self.lines:
            return self._are_alike and self.lines[0].factor == self.lines[1].factor
        return self.day is None and all(np.array_equal(*each) for each in self._by_profile)

    @cached_property
    def _are_alike(self) -> bool:
        """Whether costs are lines between the same places, so that one is in proportion to both."""
        if not self.lines:
            return False
        first, second = self.lines
        alike = first.curved == second.curved
        return alike and np.array_equal(first.places, second.places)

    @cached_property
    def greatest_legs(self) -> Array:
        """The greatest finite cost of a leg, of each of both costs, shape (2,)."""
        if self.profiles:
            return np.max([each.greatest_legs for each in self._each_profile], axis=0)
        return np.array([self._greatest_leg(layer) for layer in range(LAYERS)])

    def _greatest_leg(self, layer: int) -> float:
        if self.lines:
            return self.lines[layer].greatest()
        return float(largest_costs(self.costs[[layer]])[0])

    @cached_property
    def largest_legs(self) -> Array:
        """The largest of each cost of a leg in ordinary plans, shape (2,).

        Outliers count only if a stop cannot be reached or left without them.
        """
        if self.profiles:
            return np.max([each.largest_legs for each in self._each_profile], axis=0)
        return np.array([self._largest_leg(layer) for layer in range(LAYERS)])

    def _largest_leg(self, layer: int) -> float:
        largest = float(self.greatest_legs[layer])
        sampled = np.arange(0, self.rules.n, -(-self.rules.n // SAMPLED))
        ordinary = ordinary_cost(self._blocks(layer), self.among(sampled)[layer], largest)
        if ordinary == largest:
            return largest
        needed = self._needed_leg(layer)
        return min(needed + ordinary if needed > ordinary else ordinary, largest)

    def _needed_leg(self, layer: int) -> float:
        """Return the least cost such that legs up to it lead to all stops and back.

        Unreachable stops do not count.
        """
        starts = _places([vehicle.start for vehicle in self.rules.vehicles], self.rules)
        ends = _places([vehicle.end for vehicle in self.rules.vehicles], self.rules)
        return max(
            self._least_bound(layer, starts, back=False), self._least_bound(layer, ends, back=True)
        )

    def _least_bound(self, layer: int, places: Sequence[int], *, back: bool) -> float:
        """Return the least cost such that legs up to it lead from places to all stops, or back.

        Without places, one such leg must lead to each stop. O(n^2).
        """
        if places:
            legs = partial(self.legs_to if back else self.legs_from, layer)
            bounds = least_paths(legs, self.rules.n, places, np.maximum)
        else:
            bounds = self.nearest(layer)[back]
        return float(bounds.max(where=np.isfinite(bounds), initial=0.0))

    @cached_property
    def scale(self) -> Array:
        """The unit of each of m objectives, shape (m,), 1 if that would be 0.

        It is the largest leg, of times by the clock and of imbalance in the costs by which routes
        are compared; of what is counted it is 1. Otherwise it is the overlap of a mean stop, the
        largest prize, the most overtime of a vehicle, the largest leg with the largest capacity, or
        with the sum of all urgencies.
        Times are those of the slowest vehicle, and the first unit is at the highest prices.
        """
        rules = self.rules
        pairs = zip(rules.over, rules.layers, strict=True)
        units = np.array([self._unit(over, layer) for over, layer in pairs])
        if rules.priced:
            units[0] *= max(vehicle.per_distance for vehicle in rules.vehicles)
        if rules.clock is not None:
            highest = max(vehicle.per_time for vehicle in rules.vehicles)
            units[0] += highest * self._slowest_legs[rules.clock]
        return np.where(units > 0, units, 1.0)

    @cached_property
    def _slowest_legs(self) -> Array:
        """The largest of each cost of a leg, as the slowest vehicle drives it, shape (2,)."""
        kinds = range(len(self.rules.vehicles))
        slowest = [min(self.rules.speed(kind, layer) for kind in kinds) for layer in range(LAYERS)]
        return self.largest_legs / slowest

    def _unit(self, over: Over | Measure, layer: int) -> float:
        legs, rules = self._slowest_legs, self.rules
        match over:
            case "sum" | "max":
                return float(legs[layer])
            case "overlap":
                return 1.0 / max(1, len(rules.clients))
            case "unassigned":
                return max(visit.prize or 0.0 for visit in rules.visits)
            case "overtime":
                return max(vehicle.max_overtime for vehicle in rules.vehicles)
            case "weighted_arrival":
                return float(legs[rules.limited or 0]) * urgency_of(rules)
            case "load_distance":
                return float(legs[0]) * max(each.capacity[0] for each in rules.vehicles)
        return float(legs[rules.limited or 0]) if MEASURES[over].unit in OF_TIME else 1.0


def _places(ends: Sequence[int | None], rules: Rules) -> list[int]:
    """Return the stops at which routes start or end; one stop if a single route may start anywhere.

    Several vehicles with open routes may begin at every stop, so no stop is needed as a start.
    """
    if None not in ends:
        return sorted({end for end in ends if end is not None})
    if sum(vehicle.count for vehicle in rules.vehicles) > 1:
        return []
    return [0]


def prices_of(rules: Rules) -> Array:
    """Return what a unit of both costs adds to a first length that is a sum, shape (v, 2)."""
    prices = np.zeros((len(rules.vehicles), LAYERS))
    if rules.over[0] == "sum":
        prices[:, 0] = [vehicle.per_distance for vehicle in rules.vehicles]
        if rules.clock is not None:
            prices[:, rules.clock] += [vehicle.per_time for vehicle in rules.vehicles]
    return prices


def urgency_of(rules: Rules) -> float:
    """Return the sum of the urgencies of the stops to visit."""
    return sum(rules.visits[stop].urgency for stop in rules.clients)
