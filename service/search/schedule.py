"""The course of a search: one weight after another, then wherever the front gains most."""

from collections.abc import Iterator
from itertools import cycle

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.search.archive import accepts, area, best, insert, make_archive
from service.search.candidates import (
    NEAREST,
    POOL_WEIGHTS,
    Scalarization,
    empty_pool,
    fill_pool,
    nearest,
)
from service.search.costs import lengths, make_costs, units
from service.search.local_search import (
    LEAST_GAIN,
    descend,
    iterated_local_search,
    nearest_neighbour,
    submit,
)
from service.search.pareto_local_search import STEPS, SearchState, WeightedCandidates, fill
from service.search.working_tour import make_route, push_all, take

Array = NDArray[np.float64]

WEIGHTS = 50  # at 500 cities and 0.3 s better than 100, which get too little time each, and than 35
BUILT = 17  # weights that are offered a tour built from nothing
STEEPEST = 1e-3  # at the ends of the fan the other length still counts, to break ties
FIRST_SHARE = 4  # the first time round, weights get a quarter of the iterations they get later
BLOCK = 300  # iterations between two looks at the clock, about a millisecond
ROWS = 200_000  # costs computed between two looks at the clock
POPS = 2_000
PROBE = 10  # every so many turns, what has lately won less is tried
PATIENCE = 1_000  # iterations per city without a new tour, after which the search has converged


def bisecting(count: int) -> list[int]:
    """0 to count - 1, both ends first, then the middles of ever shorter intervals.

    Each weight then has neighbours on either side whose tours are good starts for it.
    """
    order = [0, count - 1]
    intervals = [(0, count - 1)]
    for low, high in intervals:
        if high - low > 1:
            middle = (low + high) // 2
            order.append(middle)
            intervals += [(low, middle), (middle, high)]
    return order


class Search:
    """A search of one instance of at least eight cities.

    What it does next depends on the seed and on what it has found, never on the clock, so that
    a search stopped after the same number of iterations has found the same.
    """

    def __init__(self, instance: Instance, seed: int, reference_point: Array) -> None:
        self.units = units(instance)
        self.corner = reference_point * self.units
        self.n = instance.n
        share = np.linspace(0.0, 1.0, WEIGHTS).clip(STEEPEST, 1 - STEEPEST)
        weights = np.stack([share, 1 - share], axis=1) / (instance.scale * self.units)
        weights /= weights.sum(axis=1, keepdims=True)
        self.weights = weights
        near = np.zeros((WEIGHTS, self.n, min(NEAREST, self.n - 1)), np.int32)
        self.state = SearchState(
            make_costs(instance),
            WeightedCandidates(weights, near, np.zeros(near.shape)),
            make_archive(self.n),
            make_route(self.n),
            np.random.default_rng(seed).integers(1, 2**63 - 1, 1),
        )

    @property
    def share(self) -> float:
        """The hypervolume of what was found, as a share of the box to the reference point."""
        return self._area / float(self.corner.prod())

    @property
    def found(self) -> int:
        """How many points the front has."""
        return int(self.state.archive.counts[0])

    def tours(self, kept: NDArray[np.intp] | None = None) -> NDArray[np.int32]:
        """The tours of the front, or those at the indices kept, by ascending first length."""
        archive = self.state.archive
        slots = archive.slots[: self.found]
        return archive.tours[slots if kept is None else slots[kept]]

    def points(self) -> Array:
        """The points of the front, in the instance's units."""
        return self.state.archive.points[: self.found] / self.units

    def missing(self, tours: NDArray[np.integer]) -> NDArray[np.integer]:
        """Those tours that the front neither dominates nor equals, as room had to be made."""
        costs, archive = self.state.costs, self.state.archive
        points = [lengths(costs, tour) for tour in np.ascontiguousarray(tours, np.int32)]
        return tours[[k for k in range(len(tours)) if accepts(archive, *points[k])]]

    def add(self, tours: NDArray[np.integer]) -> None:
        """Admits tours that came from elsewhere."""
        for tour in np.ascontiguousarray(tours, np.int32):
            insert(self.state.archive, lengths(self.state.costs, tour), tour)

    def run(self) -> Iterator[int]:
        """Works, handing back control every millisecond or so with the iterations done since."""
        yield from self._pool_neighbours()
        for rank, k in enumerate(bisecting(WEIGHTS)):
            yield from self._descend(k, build=rank < BUILT)
        for share in (FIRST_SHARE, 1):
            for k in bisecting(WEIGHTS):
                yield from self._iterate(k, self.n // share)
        yield from self._compete()

    @property
    def _area(self) -> float:
        return area(self.state.archive, self.corner[0], self.corner[1])

    def _pool_neighbours(self) -> Iterator[int]:
        self.pool = empty_pool(self.n)
        marks = np.linspace(0, WEIGHTS - 1, POOL_WEIGHTS).astype(int)
        rows = max(1, ROWS // self.n)
        for begin in range(0, self.n, rows):
            end = min(begin + rows, self.n)
            fill_pool(self.pool, self.state.costs, self.weights[marks], begin, end)
            yield 0

    def _scalar(self, k: int) -> Scalarization:
        w0, w1 = self.weights[k]
        fan = self.state.fan
        return Scalarization(self.state.costs, fan.near[k], fan.near_costs[k], float(w0), float(w1))

    def _set_out(self, scalar: Scalarization, build: bool) -> None:
        """Takes the best tour known for a weight, or one newly built if that is better."""
        archive, route = self.state.archive, self.state.route
        known = self.found > 0
        least = np.inf
        if known:
            k = best(archive, scalar.w0, scalar.w1)
            first, second = archive.points[k].tolist()
            least = scalar.w0 * first + scalar.w1 * second
            take(route, archive.tours[archive.slots[k]], first, second)
        if build or not known:
            tour = np.empty(self.n, np.int32)
            nearest_neighbour(scalar, 0, tour)
            first, second = lengths(scalar.costs, tour)
            if scalar.w0 * first + scalar.w1 * second < least:
                take(route, tour, first, second)

    def _descend(self, k: int, build: bool) -> Iterator[int]:
        state = self.state
        scalar = self._scalar(k)
        nearest(self.pool, scalar.near, scalar.near_costs, scalar.w0, scalar.w1)
        self._set_out(scalar, build)
        push_all(state.route)
        value = float(self.weights[k] @ state.route.length)
        while descend(state.route, scalar, LEAST_GAIN * value, POPS) == 0:
            yield 0
        submit(state.route, scalar, state.archive)
        yield 1

    def _iterate(self, k: int, iterations: int) -> Iterator[int]:
        state = self.state
        scalar = self._scalar(k)
        self._set_out(scalar, build=False)
        left = iterations
        while left > 0:
            steps = min(left, BLOCK)
            iterated_local_search(state.route, scalar, state.archive, state.random, steps, False)
            yield steps
            left -= steps

    def _fill(self) -> Iterator[int]:
        for _ in range(max(1, self.n // BLOCK)):
            fill(self.state, BLOCK // STEPS)
            yield BLOCK

    def _compete(self) -> Iterator[int]:
        """Presses weights or fills gaps, whichever has lately won more hypervolume, until dry."""
        turns = cycle(bisecting(WEIGHTS))
        rates = [np.inf, np.inf]
        quiet, turn = 0, 0
        while quiet < PATIENCE * self.n:
            turn += 1
            behind = int(rates[0] > rates[1])
            kind = behind if turn % PROBE == 0 else 1 - behind
            before, admitted = self._area, self.state.archive.counts[2]
            spent = 0
            for done in self._fill() if kind else self._iterate(next(turns), self.n):
                spent += done
                yield done
            rate = (self._area - before) / spent
            rates[kind] = rate if rates[kind] == np.inf else rates[kind] * 0.9 + rate * 0.1
            quiet = quiet + spent if self.state.archive.counts[2] == admitted else 0
