"""Choose what the search of a fleet minimises next, and from which plan it starts.

Where vehicles are counted beside one other objective, first the fewest, then the least length with
each number of them. Else first each objective alone, then trade-offs. Under two objectives these
are taken between two neighbours of the front, most often where the rectangle between them is large:
a limit on the longest route, or the weights with which both neighbours are as good (Aneja and Nair,
1979). Under more, weights and limits are random. Each starts from the best plan found so far under
it, and is annealed.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from service.fleet.fleet import Array, Fleet
from service.fleet.measures.punctuality import deviations_of
from service.fleet.necessary import fewest_vehicles, least_longest
from service.fleet.search.problem import WEIGHTED, Direction
from service.objectives import OBJECTIVES

_FIRST_SHARE = 0.25  # of all rounds, for each objective alone
_DEEP_SHARE = 0.45  # of all rounds, for evenly spread directions
_DEEP = 12  # directions
_SHALLOW = 30, 400  # a further direction takes one round in at least and at most so many left
_LEAST_ROUNDS = 2
_LESSER = 1e-6  # weight of the other objectives beside one alone
_BESIDE = 0.3  # the same beside one of which many plans have none at all
_STRICT = 100.0  # what a unit over a limit costs, in units of the first objective
_DEAR = 10.0  # what a stop outside that must be visited costs at first, in the same
_CHEAP, _ROOM = 2.0, 1.05  # the same, where vehicles are counted that could bring so many times all
_HOTTEST, _COLDEST = 0.1, 0.001  # temperatures, in the largest leg of each direction
_HEAT, _POWER = 0.0008, 0.65  # the first temperature after one ruin per stop, and how it grows
_HOT_STOPS = 250  # stops; with more, searches are as hot as with so many
_UNLIMITED = 0.25  # share of the directions under three objectives that leave out a limit
_BOUNDED = 0.5  # share of the further directions with bounds on sums
_UNLIMITED_AGAIN = 0.1  # share of the further directions under two objectives without a limit
_ANY_START = 0.25  # share of those under three objectives that start from a random plan
_BELOW = 0.95  # how far below the least longest route limits go
_BRIEF, _LOWERED = 6.0, 0.5  # with so few ruins per stop, so much of a gap below a plan is taken

# Under vehicles and one more objective, where all stops must be visited: shares of the rounds left
# to shorten the first plan (at most a round a stop), to find one vehicle less, for the fewest, and
# for any number; and the chance of the fewest after that. Where few vehicles are full, only a
# hotter search gets from one plan to the next, and one that may leave a stop out for a while.
_SHORTEN, _DESCENT, _AT_FEWEST, _AT_ANY = 0.05, 0.07, 0.5, 0.6
_ATTEMPTS = 6  # at one vehicle less
# With few stops there is time for more attempts, as long as they lack few stops at the least; and
# for a search for the fewest before that one, in which stops outside are so many times as dear.
_SMALL, _MORE_ATTEMPTS, _NEARLY = 150, 8, 2
_FIRST_AT_FEWEST, _DEARER = 0.25, 5.0
_AGAIN, _OFTEN_FEWEST = 0.25, 0.6
_HOTTER = 10.0  # times both temperatures, which are then those of SISR
_COOLER_STOPS = 100  # with more stops, vehicles with room are searched colder, by the square root

_OFTEN_NONE = "lateness", "overtime", "earliness"  # which many plans have none of
_LIMITED = ("max", "imbalance", "vehicles")  # objectives that limits lead to, not weights


@dataclass(frozen=True)
class Step:
    """A search under one direction.

    Args:
        direction: What it minimises.
        start: The place of the plan to start from, by ascending first length; None for none.
        rounds: How long it lasts.
        heat: Its first temperature.
        cooled: Its last temperature.
        ends_whole: Whether it ends with the first plan that visits all required stops.
    """

    direction: Direction
    start: int | None
    rounds: int
    heat: float
    cooled: float
    ends_whole: bool = False


class Directions:
    """Chooses the directions of a search, one after another.

    Args:
        fleet: The fleet.
        random: Chooses weights and limits.
        points: Returns the points of all plans so far, shape (k, m), by ascending first length.
        left: Estimates the number of rounds for which there is time.
        lacked: Returns how many stops that must be visited the last search lacked, at the least.
        ruins: The number of ruins of a round.
    """

    def __init__(
        self,
        fleet: Fleet,
        random: np.random.Generator,
        points: Callable[[], Array],
        left: Callable[[], float],
        lacked: Callable[[], int],
        ruins: int,
    ) -> None:
        self._fleet = fleet
        self._rules = fleet.rules
        self._over = fleet.rules.over
        self._scale = fleet.scale
        self._random = random
        self._points = points
        self._left = left
        self._lacked = lacked
        self._per_stop = ruins / max(1, min(len(fleet.rules.clients), _HOT_STOPS))
        self._most_fixed = max(vehicle.fixed for vehicle in fleet.rules.vehicles)
        self._bound = least_longest(fleet)
        optional = any(fleet.rules.visits[stop].prize is not None for stop in fleet.rules.clients)
        self._by_limit = [over in _LIMITED for over in self._over]
        two = len(self._over) == OBJECTIVES and sum(self._by_limit) == 1
        self._fewest = fewest_vehicles(fleet.rules)
        self._roomy = fewest_vehicles(fleet.rules, _ROOM)
        self._counts_vehicles = two and "vehicles" in self._over and not optional

    def first(self) -> Step:
        """Return a short search for the least first length."""
        weights = np.full(len(self._over), _LESSER)
        weights[0] = 1.0
        return self._step(weights / self._scale, {}, _LEAST_ROUNDS)

    def loose(self, step: Step) -> Step:
        """Return a step in which routes may be too long or end too late, at a price."""
        largest = float(self._fleet.largest_legs[self._rules.limited or 0])
        beyond = _STRICT * step.cooled / _COLDEST / (largest or 1.0)
        return replace(step, direction=step.direction._replace(beyond=beyond))

    def steps(self) -> Iterator[Step]:
        """Yield the directions; each must be searched before the next is requested."""
        if self._counts_vehicles:
            while not len(self._points()):
                yield self._at_most(inf, self._share(_FIRST_SHARE))
            yield from self._by_vehicles()
        alone = [index for index, over in enumerate(self._over) if not self._by_limit[index]]
        rounds = self._share(_FIRST_SHARE / max(1, len(alone)))
        for objective in alone or [0]:
            lesser = _BESIDE if self._over[objective] in _OFTEN_NONE else 0.0
            weights = np.where(self._by_limit, 0.0, lesser)
            weights[objective] = 1.0
            yield self._step(weights / self._scale, {}, rounds)
            while not len(self._points()):
                yield self._step(weights / self._scale, {}, 2 * rounds)
        rounds = self._share(_DEEP_SHARE / (1 - _FIRST_SHARE) / _DEEP)
        for number in range(_DEEP):
            yield self._between(number / (_DEEP - 1), rounds)
        while True:
            part = np.exp(self._random.uniform(*np.log(_SHALLOW)))
            yield self._between(None, self._share(1 / part))

    def _by_vehicles(self) -> Iterator[Step]:
        """Yield directions to the fewest vehicles, and to the least length with each number."""
        yield self._at_most(inf, min(self._share(_SHORTEN), len(self._rules.clients)))
        now, failed = self._ends()[0], 0
        small = len(self._rules.clients) <= _SMALL
        attempts, nearly = (_MORE_ATTEMPTS, _NEARLY) if small else (_ATTEMPTS, inf)
        while self._fewest < now and failed < attempts:
            yield replace(self._at_most(now - 1, self._share(_DESCENT)), ends_whole=True)
            found = self._ends()[0]
            if found == now and self._lacked() > nearly:
                break
            now, failed = found, failed + 1 if found == now else 0
        if small:
            yield _dearer(self._at_most(now, self._share(_FIRST_AT_FEWEST)))
        yield self._at_most(now, self._share(_AT_FEWEST))
        yield self._at_most(inf, self._share(_AT_ANY))
        fewest, greatest = self._ends()
        for limit in range(greatest - 1, fewest, -1):
            yield self._at_most(limit, self._share(_AT_ANY / (limit - fewest)))
        while True:
            fewest, greatest = self._ends()
            limit = int(self._random.integers(max(self._fewest, fewest - 1), greatest + 1))
            often = self._random.random() < _OFTEN_FEWEST
            yield self._at_most(fewest if often else limit, self._share(_AGAIN))

    def _ends(self) -> tuple[int, int]:
        """Return the least and the greatest number of vehicles of the front."""
        numbers = self._points()[:, self._by_limit.index(True)]
        return int(numbers.min()), int(numbers.max())

    def _at_most(self, vehicles: float, rounds: int) -> Step:
        """Return the least length with so many vehicles at most."""
        weights = np.where(self._by_limit, _LESSER, 1.0) / self._scale
        limits = {} if vehicles == inf else {self._by_limit.index(True): vehicles}
        return self._step(weights, limits, rounds)

    def _share(self, share: float) -> int:
        """Return the rounds in a share of the time that is left."""
        return max(_LEAST_ROUNDS, int(min(1e6, share * self._left())))

    def _between(self, place: float | None, rounds: int) -> Step:
        """Return a direction towards a place of the front, from 0 to 1, or a random one."""
        points = self._points()
        if len(self._over) > OBJECTIVES:
            return self._random_step(points, rounds)
        return self._of_two(points, place, rounds)

    def _of_two(self, points: Array, place: float | None, rounds: int) -> Step:
        """Return a direction between two neighbours of a front of two objectives."""
        if any(self._by_limit):
            return self._under_limit(points, place, rounds)
        if len(points) == 1:
            weights = self._random.uniform(0.0, 1.0, OBJECTIVES) / self._scale
            return self._step(weights, {}, rounds)
        widths = np.ptp(points, axis=0)
        sides = np.abs(np.diff(points, axis=0)) / widths
        if place is None:
            areas = np.sqrt(sides.prod(axis=1)) + _LESSER
            at = int(self._random.choice(len(areas), p=areas / areas.sum()))
            if self._random.random() < _BOUNDED:
                return self._bounded(points, at, rounds)
            slope = sides[at]
        else:
            angle = (0.02 + 0.96 * place) * np.pi / 2
            slope = np.array([np.sin(angle), np.cos(angle)])
        # Sides are shares of the front's widths, so that no number is too small or too large.
        weights = (slope[::-1] + _LESSER) / (widths / self._scale)
        return self._step(weights / weights.max() / self._scale, {}, rounds)

    def _bounded(self, points: Array, at: int, rounds: int) -> Step:
        """Return the least length in one of two objectives between two neighbours of the front."""
        objective = int(self._random.integers(OBJECTIVES))
        weights = (points[at] - points[at + 1])[::-1] * (-1.0, 1.0)
        weights[1 - objective] *= self._random.random()
        bounds = np.full(OBJECTIVES, inf)
        ends = np.sort(points[[at, at + 1], 1 - objective])
        bounds[1 - objective] = self._random.uniform(*ends)
        weights = np.abs(weights) / np.abs(weights).max()
        return self._step(weights / self._scale, {}, rounds, bounds=bounds)

    def _under_limit(self, points: Array, place: float | None, rounds: int) -> Step:
        """Return the least first length under a limit on the other of two objectives."""
        limited = self._by_limit.index(True)
        lengths = np.sort(points[:, limited])[::-1]
        greatest, least = lengths[0], lengths[-1]
        weights = np.where(self._by_limit, _LESSER, 1.0) / self._scale
        if self._over[limited] == "vehicles":
            limit = float(self._random.integers(int(least) - 1, int(greatest) + 1))
        elif place is not None:
            limit = greatest - place * (greatest - min(least, self._bound))
        elif self._random.random() < _UNLIMITED_AGAIN:
            limit = inf
        else:
            lower = np.append(lengths[1:], self._lower(least))
            at = int(self._random.choice(len(lengths), p=self._chances(points, lengths - lower)))
            limit = self._random.uniform(lower[at], lengths[at])
            if rounds * self._per_stop <= _BRIEF:  # too few to get away from the plan below
                limit = lengths[at] - _LOWERED * (lengths[at] - limit)
                return self._step(weights, {limited: limit}, rounds, at)
        return self._step(weights, {limited: limit}, rounds)

    def _lower(self, least: float) -> float:
        """Return a limit somewhat below the least length found, but not below what can be."""
        return min(least, max(_BELOW * least, self._bound))

    def _chances(self, points: Array, gaps: Array) -> Array:
        """Return with which chance each gap below a limit is taken, in the order of the limits."""
        limited = self._by_limit.index(True)
        other = np.sort(points[:, 1 - limited])
        sides = np.append(np.diff(other), np.ptp(other) / max(1, len(other) - 1))
        chances: Array = np.sqrt(np.maximum(0.0, gaps * sides)) + 1e-300
        return chances / chances.sum()

    def _random_step(self, points: Array, rounds: int) -> Step:
        """Return a random direction."""
        widths = np.ptp(points, axis=0)
        widths = np.where(widths > 0, widths, self._scale)
        weights = self._random.exponential(size=len(self._over)) / widths
        if self._random.random() < _BOUNDED:
            return self._below_a_point(points, weights, rounds)
        limits = {}
        for index, by_limit in enumerate(self._by_limit):
            if by_limit and self._random.random() >= _UNLIMITED:
                some = points[self._random.integers(len(points)), index]
                down = self._over[index] == "vehicles"
                least = self._lower(points[:, index].min())
                less = some - self._random.integers(2) if down else least
                limits[index] = float(less if down else self._random.uniform(less, some))
        anywhere = self._random.random() < _ANY_START
        start = int(self._random.integers(len(points))) if anywhere else None
        return self._step(weights, limits, rounds, start)

    def _below_a_point(self, points: Array, weights: Array, rounds: int) -> Step:
        """Return a random weighted sum, where some lengths are bounded by those of a plan."""
        point = points[self._random.integers(len(points))]
        bounds = np.where(self._random.random(len(point)) < _BOUNDED, point, inf)
        lower = self._random.integers(len(point))
        less = points[points[:, lower] < point[lower], lower]
        bounds[lower] = less.max() if len(less) else point[lower]
        weights = np.where(np.isfinite(bounds), _LESSER * weights, weights)
        if not np.isinf(bounds).any():
            weights[lower] /= _LESSER
        limits = {
            index: float(bound)
            for index, bound in enumerate(bounds)
            if self._by_limit[index] and np.isfinite(bound)
        }
        return self._step(weights, limits, rounds, bounds=bounds)

    def _step(
        self,
        weights: Array,
        limits: dict[int, float],
        rounds: int,
        start: int | None = None,
        bounds: Array | None = None,
    ) -> Step:
        """Return a search with weights, shape (m,), and limits and bounds on some objectives.

        Limits are on each route, and bounds, shape (m,), on all routes together. It starts from the
        plan that is best by them, if no other is given.
        """
        bounds = np.full(len(self._over), inf) if bounds is None else bounds
        if "imbalance" in self._over:
            index = self._over.index("imbalance")
            bounds[index] = min(bounds[index], limits.get(index, inf))
        unit = float((weights * self._scale).max())
        points = self._points()
        if start is None and len(points):
            beyond = np.zeros(len(points))
            for index, limit in limits.items():
                beyond += np.maximum(0.0, points[:, index] - limit) / self._scale[index]
            beyond += (np.maximum(0.0, points - bounds) / self._scale).sum(axis=1)
            values = points @ weights + _STRICT * unit * beyond
            start = int(values.argmin())
        ruins = max(1.0, rounds * self._per_stop)
        hotter = self._hotter(limits)
        heat, cooled = min(_HOTTEST, _HEAT * ruins**_POWER), hotter * unit * _COLDEST
        heat = max(hotter * unit * heat, 2 * cooled)
        direction = self._direction(weights, limits, bounds, unit)
        return Step(direction, start, rounds, heat, cooled)

    def _hotter(self, limits: dict[int, float]) -> float:
        """Return how many times as hot a search is where vehicles are counted."""
        if not self._counts_vehicles:
            return 1.0
        if limits.get(self._by_limit.index(True), inf) < self._roomy:
            return _HOTTER
        colder = min(1.0, _COOLER_STOPS / len(self._rules.clients))
        return max(1.0, _HOTTER * colder**0.5)

    def _direction(
        self, weights: Array, limits: dict[int, float], bounds: Array, unit: float
    ) -> Direction:
        """Return a direction with weights, shape (m,), and limits and bounds."""
        costs = np.zeros(OBJECTIVES)
        by_measure = dict.fromkeys(WEIGHTED, 0.0)
        longest, most, routes = inf, inf, 2**31
        penalty = most_penalty = mean = deviation = 0.0
        for index, (over, layer) in enumerate(zip(self._over, self._rules.layers, strict=True)):
            percent = self._rules.percent(index)
            if over == "sum" and percent is not None:
                mean += float(weights[index])
                deviation += float(weights[index]) * deviations_of(percent)
            elif over == "sum" and not (index == 0 and self._rules.priced):
                costs[layer] += weights[index]
            elif over == "max":
                # Where only the longest route counts, a plan of short routes is a good start.
                costs[layer] += _LESSER * weights[index]
                limited = limits.get(index, inf), _STRICT * unit / self._scale[index]
                if percent is None:
                    longest, penalty = limited
                else:
                    most, most_penalty = limited
            elif over == "vehicles":
                routes = max(0, int(limits.get(index, routes)))
            by_measure[over] = float(weights[index])
        steady = self._counts_vehicles and routes >= self._roomy
        paid = self._over.index("unassigned") if "unassigned" in self._over else 0
        return Direction(
            costs=(float(costs[0]), float(costs[1])),
            vehicle=by_measure.get("vehicles", 0.0),
            fixed=float(weights[0]),
            prize=float(weights[paid]),
            mean=mean,
            deviation=deviation,
            variance=0.0,
            longest=longest,
            penalty=penalty,
            most=most,
            most_penalty=most_penalty,
            beyond=0.0,
            required=(_CHEAP if self._counts_vehicles else _DEAR) * unit
            + float(weights[0]) * self._most_fixed,
            steady=steady,
            routes=routes,
            bounds=bounds,
            strict=_STRICT * unit / self._scale,
            **{name: by_measure[name] for name in WEIGHTED},
        )


def _dearer(step: Step) -> Step:
    """Return a step in which the plan, once it has all stops, seldom lacks one."""
    required = _DEARER * step.direction.required
    return replace(step, direction=step.direction._replace(required=required))
