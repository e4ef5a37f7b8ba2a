"""Edge assembly: what two tours differ by, and the tour that has what is better in both."""

from itertools import combinations

import numpy as np
import pytest

from service.search.candidates import Scalarization
from service.search.closing import closed_tours
from service.search.edge_assembly.alternating_cycles import alternating_cycles
from service.search.edge_assembly.assembly import assemble
from tests.helpers.instances import (
    ENDS,
    opened,
    random_matrices,
    random_routes,
    random_tours,
    scalarization_of,
    steps_of,
    uniform,
    weighted_cost,
    weighted_length,
)

LEAST = 1e-9  # of gains, above what rounding adds


def assembled(
    scalarization: Scalarization, tour: np.ndarray, other: np.ndarray, seed: int = 1
) -> tuple[np.ndarray, float]:
    """The tour with what is better in the other, and what it has gained."""
    new = tour.astype(np.int32)
    given = new, np.argsort(new).astype(np.int32), other.astype(np.int32)
    gained = assemble(given, scalarization, LEAST, np.array([seed], np.int64))
    assert np.array_equal(given[1], np.argsort(new))
    return new, gained


def short_tour(scalarization: Scalarization, tour: np.ndarray) -> np.ndarray:
    """A local optimum by reversals of any part of a tour."""
    n = len(tour)
    costs = [[weighted_cost(scalarization, i, j) for j in range(n)] for i in range(n)]
    best, improved = tour.tolist(), True
    while improved:
        improved = False
        for i, j in combinations(range(n), 2):
            before, first, last, after = best[i - 1], best[i], best[j], best[(j + 1) % n]
            gain = costs[before][first] + costs[last][after]
            if gain - costs[before][last] - costs[first][after] > LEAST and before != last:
                best[i : j + 1] = best[i : j + 1][::-1]
                improved = True
    return np.array(best)


def with_blocks_swapped(tour: np.ndarray, start: int) -> np.ndarray:
    """The tour with two short blocks from a position on swapped."""
    first, second = tour[start : start + 3], tour[start + 3 : start + 6]
    return np.concatenate([tour[:start], second, first, tour[start + 6 :]])


@pytest.mark.parametrize("n", [5, 8, 30])
def test_cycles_have_the_steps_that_two_tours_differ_by(n: int) -> None:
    for seed in range(40):
        tour, other = random_tours(n, 2, seed).astype(np.int32)
        position, random = np.argsort(tour).astype(np.int32), np.array([seed + 1], np.int64)
        cities, ends = alternating_cycles(tour, position, other, random)
        own, others = [], []
        for cycle in np.split(cities, ends[:-1]):
            assert len(cycle) % 2 == 0
            pairs = [frozenset(p) for p in zip(cycle, np.roll(cycle, -1), strict=True)]
            own += pairs[::2]
            others += pairs[1::2]
        assert len(own) == len(set(own)) == len(others) == len(set(others))
        assert set(own) == steps_of(tour) - steps_of(other)
        assert set(others) == steps_of(other) - steps_of(tour)


@pytest.mark.parametrize("n", [8, 20, 60])
def test_a_tour_gains_what_it_says_and_never_loses(n: int) -> None:
    gains = 0
    for seed in range(30):
        scalarization = scalarization_of(random_matrices(n, seed, symmetric=True))
        tour, other = random_tours(n, 2, seed)
        new, gained = assembled(scalarization, tour, other)
        assert sorted(new) == list(range(n))
        before = weighted_length(scalarization, tour)
        assert weighted_length(scalarization, new) == pytest.approx(before - gained)
        gains += gained > 0
    assert gains > 10


def test_what_was_spoilt_in_one_half_of_each_of_two_tours_is_mended() -> None:
    for seed in range(10):
        scalarization = scalarization_of(uniform(40, seed))
        tour = short_tour(scalarization, np.arange(40))
        one, other = with_blocks_swapped(tour, 5), with_blocks_swapped(tour, 25)
        least = min(weighted_length(scalarization, spoilt) for spoilt in (one, other))
        assert weighted_length(scalarization, tour) < least  # so both were spoilt
        assert steps_of(assembled(scalarization, one, other)[0]) == steps_of(tour)


def test_a_tour_that_falls_into_circuits_is_joined_where_enough_is_gained() -> None:
    """Also of local optima, whose cycles are mostly such."""
    joined = 0
    for seed in range(30):
        scalarization = scalarization_of(uniform(40, seed))
        one, other = (short_tour(scalarization, tour) for tour in random_tours(40, 2, seed))
        new, gained = assembled(scalarization, one, other)
        joined += bool(steps_of(new) - steps_of(one) - steps_of(other))
        assert weighted_length(scalarization, new) <= weighted_length(scalarization, one)
        assert (gained > 0) == (steps_of(new) != steps_of(one))
    assert joined > 3


@pytest.mark.parametrize("ends", ENDS)
def test_fixed_ends_of_a_route_stay(ends: str) -> None:
    changed = 0
    for seed in range(20):
        instance = opened(uniform(20, seed), ends, seed)
        tour, other = closed_tours(instance, random_routes(instance, 2, seed))
        new, gained = assembled(scalarization_of(instance), tour, other)
        changed += gained > 0
        kept = {frozenset((0, 1 + city)) for city in instance.fixed_ends}
        assert kept <= steps_of(new)
    assert changed > 5
