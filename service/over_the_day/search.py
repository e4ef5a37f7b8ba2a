"""The search over the day: all tours of a few stops; else weighted sums, one after another."""

from collections.abc import Iterator
from itertools import cycle, permutations
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.instance import tour_lengths
from service.jit import compiled
from service.over_the_day.breeding import CHANGES, breed
from service.over_the_day.day import Day
from service.over_the_day.descent import (
    WeightedSearch,
    descend,
    insert_driven,
    iterate,
    make_weighted_search,
    save,
    take,
)
from service.over_the_day.travel import (
    EQUAL,
    Traffic,
    best_departure,
    best_departure_near,
    good_departure,
    traffic_of,
    write_reached,
)
from service.preferences import spread, weights
from service.search.archive.layout import Archive, best_row, make_archive, rows_of
from service.search.nondominated import nondominated
from service.watch import Watch

Array = NDArray[np.float64]
Tours = NDArray[np.integer]

MOST_TRIED = 8  # stops: of up to as many, all tours are tried
WEIGHTS = {2: 24, 3: 45, 4: 60}  # weighted sums, by the number of objectives
PATIENCE = 1_000  # iterations per stop without a new tour, after which the search has converged
_ENDS_EVERY = 4  # visits of weights: one of them is of an objective that changes over the day
_MOST_BRED = 60  # stops: of up to as many, tours are crossed under one objective alone
_TRIED_AT_ONCE = 100  # tours
_CITIES_AT_ONCE = 20  # of a descent
_VISITS_AT_ONCE = 10_000  # of iterations: some milliseconds


class DrivenTours(NamedTuple):
    """Tours, shape (k, n), with their departures, shape (k,).

    And all lengths up to each place and the end, shape (k, n + 1, m).
    """

    tours: Tours
    departures: Array
    reached: Array

    @property
    def points(self) -> Array:
        """The lengths, shape (k, m)."""
        return self.reached[:, -1]

    def best(self) -> "DrivenTours":
        """Return the nondominated tours, of those that differ by rounding alone the first."""
        rows = nondominated(self.points)
        points = self.points[rows]
        no_worse = (points[:, np.newaxis] <= (1 + EQUAL) * points).all(axis=2)
        better = no_worse & (~no_worse.T | np.tri(len(points), k=-1, dtype=np.bool_).T)
        return self.at(rows[~better.any(axis=0)])

    def at(self, rows: NDArray[np.intp]) -> "DrivenTours":
        """Return the tours of these rows."""
        return DrivenTours(self.tours[rows], self.departures[rows], self.reached[rows])


class DaySearch:
    """A search for the front of an instance over a day.

    Args:
        day: The day.
        seed: The seed of all random choices.
        start: The stop at which closed tours begin.
    """

    def __init__(self, day: Day, seed: int, start: int = 0) -> None:
        self._start = start if day.ends.closed else day.ends.start
        self._traffic, self._instance = traffic_of(day), day.instance
        self._departures = day.earliest, day.latest
        instance = self._instance
        self._archive = make_archive(instance.n, instance.objectives)
        shares = weights(spread(WEIGHTS[instance.objectives], instance.objectives))
        ends = [each == day.clock or costs.changes for each, costs in enumerate(day.costs)]
        self._ends = sum(ends)
        alone = np.eye(instance.objectives)[ends]
        self._weights = np.concatenate((alone, shares)) / instance.scale
        self._seeds = np.random.default_rng(seed).integers(1, 2**63 - 1, len(self._weights))
        self._searches: dict[int, WeightedSearch] = {}

    @property
    def size(self) -> int:
        """The number of tours found."""
        return int(self._archive.counts[0])

    def add(self, tours: Tours) -> None:
        """Offer tours, shape (k, n), at good departures."""
        cities = np.ascontiguousarray(tours, np.int32)
        offer_all(self._archive, self._traffic, cities, *self._departures, False)

    def run(self) -> Iterator[int]:
        """Search in short steps; each yields the number of local optima that were visited."""
        return self._try_all() if self._instance.n <= MOST_TRIED else self._search_weights()

    def found(self) -> tuple[Array, Tours]:
        """Return the lengths, shape (k, m), and the tours found that have no forbidden leg."""
        rows = rows_of(self._archive)
        tours = self._archive.tours[rows]
        allowed = np.isfinite(tour_lengths(self._instance, tours)).all(axis=1)
        return self._archive.points[rows[allowed]], tours[allowed]

    def driven(self, tours: Tours, watch: Watch[Any]) -> DrivenTours:
        """Drive tours through the day, with the best departures near the good ones.

        Once no time is left, good departures are enough.
        """
        cities = np.ascontiguousarray(tours, np.int32)
        departures = np.array([self._departure(tour, watch) for tour in cities])
        n, m = self._instance.n, self._instance.objectives
        reached = np.empty((len(cities), n + 1, m))
        write_reached(self._traffic, cities, departures, reached)
        return DrivenTours(tours, departures, reached)

    def _departure(self, tour: NDArray[np.int32], watch: Watch[Any]) -> float:
        if len(tour) <= MOST_TRIED:
            return best_departure(self._traffic, tour, *self._departures)
        good = good_departure(self._traffic, tour, *self._departures)
        if watch.over():
            return good
        return best_departure_near(self._traffic, tour, good, *self._departures)

    def _places(self) -> tuple[int, int]:
        """The first place of a tour that may change, and the one after the last."""
        instance = self._instance
        return int(self._start is not None), instance.n - (instance.end is not None)

    def _try_all(self) -> Iterator[int]:
        start, end = ([] if city is None else [city] for city in (self._start, self._instance.end))
        middle = [city for city in range(self._instance.n) if city not in (*start, *end)]
        tours = np.array([(*start, *each, *end) for each in permutations(middle)], np.int32)
        for begin in range(0, len(tours), _TRIED_AT_ONCE):
            part = tours[begin : begin + _TRIED_AT_ONCE]
            offer_all(self._archive, self._traffic, part, *self._departures, True)
            yield 0

    def _search_weights(self) -> Iterator[int]:
        last, unchanged = -1, 0
        for index in self._order():
            for done in self._improve(index):
                yield done
                unchanged = 0 if self._archive.counts[2] != last else unchanged + done
                last = self._archive.counts[2]
            if unchanged > PATIENCE * self._instance.n:
                return

    def _order(self) -> Iterator[int]:
        """Yield the weights again and again, those of one objective alone more often."""
        ends = cycle(range(self._ends))
        for visit, index in enumerate(cycle(range(self._ends, len(self._weights)))):
            if visit % (_ENDS_EVERY - 1) == 0:
                yield next(ends)
            yield index

    def _improve(self, index: int) -> Iterator[int]:
        """Descend from the best tour under a weight, then iterate from there."""
        first_time = index not in self._searches
        if first_time:
            self._searches[index] = self._weighted_search(index)
        search = self._searches[index]
        row = best_row(self._archive, search.weights)
        value = self._archive.points[row] @ search.weights
        if first_time or value < search.saved_value[0]:
            tour = self._archive.tours[row]
            departure = good_departure(self._traffic, tour, *self._departures)
            take(search, tour, departure)
            while not descend(search, _CITIES_AT_ONCE):
                yield 0
            save(search)
        if not first_time:
            iterations = max(1, _VISITS_AT_ONCE // self._instance.n)
            if index < self._ends and self._instance.n <= _MOST_BRED:
                breed(search, max(1, iterations // CHANGES))
            else:
                iterate(search, iterations)
            yield iterations
        self._leave_better(search)

    def _leave_better(self, search: WeightedSearch) -> None:
        """Let the best tour under a weight leave when it is better, if there is such a time."""
        tour = search.saved.copy()
        departure = good_departure(self._traffic, tour, *self._departures)
        if departure != search.saved_value[1]:
            take(search, tour, departure)
            insert_driven(self._archive, self._traffic, tour, departure)

    def _weighted_search(self, index: int) -> WeightedSearch:
        return make_weighted_search(
            self._traffic,
            self._instance.penalised_matrices,
            self._weights[index],
            self._archive,
            self._places(),
            int(self._seeds[index]),
        )


@compiled
def offer_all(
    archive: Archive,
    traffic: Traffic,
    tours: NDArray[np.int32],
    earliest: float,
    latest: float,
    exactly: bool,
) -> None:
    """Offer tours, shape (k, n), to the archive: at their best departures, or at good ones."""
    for k in range(len(tours)):
        if exactly:
            departure = best_departure(traffic, tours[k], earliest, latest)
        else:
            departure = good_departure(traffic, tours[k], earliest, latest)
        insert_driven(archive, traffic, tours[k], departure)
