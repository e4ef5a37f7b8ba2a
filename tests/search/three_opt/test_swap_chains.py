"""Swaps of blocks and chains of them: they gain what they say, and keep the ends of a route."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from service.instance import Instance
from service.search.archive.insertion import accepts
from service.search.candidates import Scalarization
from service.search.closing import closed_tours
from service.search.costs import lengths
from service.search.moves import block_swap as block_swap_kernel
from service.search.three_opt.exchanges import swap_adjacent as swap_adjacent_kernel
from service.search.three_opt.local_search import descend, iterated_local_search
from service.search.three_opt.local_search import perturb as perturb_kernel
from service.search.three_opt.swap_chains import MOST_SWAPS
from service.search.three_opt.swap_chains import improve_by_swaps as improve_by_swaps_kernel
from service.search.three_opt.undoable_tour import load, make_undoable_tour, undo
from service.search.three_opt.undoable_tour import (
    save as save_kernel,
)
from service.search.working_tour import UndoableTour, enqueue_cities
from service.search.working_tour import dequeue as dequeue_kernel
from tests.helpers.instances import (
    ENDS,
    opened,
    random_matrices,
    random_routes,
    scalarization_of,
    state_of,
    weighted_length,
)
from tests.helpers.kernels import for_python
from tests.search.three_opt.test_exchanges import LEAST, left_to_see, shuffled

block_swap = for_python(block_swap_kernel)
swap_adjacent = for_python(swap_adjacent_kernel)
perturb = for_python(perturb_kernel)
improve_by_swaps = for_python(improve_by_swaps_kernel)
save = for_python(save_kernel)
dequeue = for_python(dequeue_kernel)

Steps = set[tuple[int, int]]


def check_consistent(working: UndoableTour, scalarization: Scalarization) -> None:
    """The tour is a permutation, and its inverse and its lengths are those of it."""
    n = len(working.tour)
    assert sorted(working.tour) == list(range(n))
    assert working.position[working.tour].tolist() == list(range(n))
    assert working.length == pytest.approx(lengths(scalarization.costs, working.tour))


def directed_steps(tour: NDArray[np.integer]) -> Steps:
    """The steps of a closed tour, each from a city to the next."""
    return set(zip(tour.tolist(), np.roll(tour, -1).tolist(), strict=True))


def descended(instance: Instance, seed: int) -> tuple[UndoableTour, Scalarization]:
    """A tour that no swap and no chain improves, and under which weights."""
    scalarization = scalarization_of(instance)
    tour = closed_tours(instance, random_routes(instance, 1, seed))[0]
    working = make_undoable_tour(len(tour))
    load(working, tour, *lengths(scalarization.costs, tour))
    enqueue_cities(working, tour)
    assert descend(working, scalarization, 100_000, False) > 0
    return working, scalarization


def check_ends(instance: Instance, working: UndoableTour) -> None:
    """The ends of a route that are fixed are beside the invented city."""
    place, n = working.position[0], len(working.tour)
    before, after = working.tour[place - 1], working.tour[(place + 1) % n]
    assert instance.start is None or after == 1 + instance.start
    assert instance.end is None or before == 1 + instance.end


def best_of_all_swaps(scalarization: Scalarization, tour: list[int]) -> float:
    """The most that any swap of two adjacent blocks gains."""
    n = len(tour)
    length = weighted_length(scalarization, np.array(tour, np.int32))
    least = length
    for i, j, k in itertools.combinations(range(1, n + 1), 3):
        swapped = tour[:i] + tour[j:k] + tour[i:j] + tour[k:]
        least = min(least, weighted_length(scalarization, np.array(swapped, np.int32)))
    return length - least


@pytest.mark.parametrize("seed", range(20))
def test_a_swap_gains_what_it_says_changes_three_steps_and_can_be_undone(seed: int) -> None:
    scalarization = scalarization_of(random_matrices(9, seed, symmetric=False))
    working = shuffled(scalarization, seed)
    before, at = working.tour.copy(), working.length.copy()
    value = weighted_length(scalarization, before)
    for city in range(9):
        best, promising = block_swap(working, scalarization, city, LEAST)
        for gain, start, a, b, _ in (best, promising):
            if a == 0:
                continue
            first, tip = before[start], before[(start + a + b - 1) % 9]
            swap_adjacent(working, scalarization, start, a, b)
            closing = scalarization.costs.matrix[tip, first].mean()
            says = gain if gain == best[0] else gain - closing
            assert value - weighted_length(scalarization, working.tour) == pytest.approx(says)
            check_consistent(working, scalarization)
            changed = directed_steps(before) - directed_steps(working.tour)
            assert len(changed) == 3
            assert all(working.queued[list(step)].all() for step in changed)
            undo(working)
            assert working.tour.tolist() == before.tolist()
            assert working.length.tolist() == at.tolist()


def test_the_best_swap_of_a_short_tour_is_mostly_the_best_of_all() -> None:
    """It is missed where a part of it gains less than another whole swap at the city."""
    found = 0
    for seed in range(30):
        scalarization = scalarization_of(random_matrices(8, seed, symmetric=False))
        working = shuffled(scalarization, seed)
        gain = max(block_swap(working, scalarization, city, LEAST)[0][0] for city in range(8))
        expected = max(LEAST, best_of_all_swaps(scalarization, working.tour.tolist()))
        assert gain <= expected + 1e-9
        found += gain > expected - 1e-9
    assert found > 15


def test_a_chain_gains_in_all_or_leaves_no_trace() -> None:
    made = 0
    for seed in range(60):
        scalarization = scalarization_of(random_matrices(12, seed, symmetric=False))
        working = shuffled(scalarization, seed)
        enqueue_cities(working, working.tour.copy())
        while working.ring[1] > 0:
            city = dequeue(working)
            before = left_to_see(working)
            value = weighted_length(scalarization, working.tour)
            best, _ = block_swap(working, scalarization, city, LEAST)
            if improve_by_swaps(working, scalarization, city, LEAST):
                made += best[2] == 0
                assert weighted_length(scalarization, working.tour) < value - LEAST / 2
                check_consistent(working, scalarization)
                changed = directed_steps(before[0]) - directed_steps(working.tour)
                assert len(changed) <= 2 * MOST_SWAPS + 1
                assert all(working.queued[list(step)].all() for step in changed)
            else:
                assert all(map(np.array_equal, left_to_see(working), before))
    assert made > 20


@settings(max_examples=30)
@given(seed=st.integers(0, 10**6), n=st.integers(10, 40), ends=st.sampled_from(["", *ENDS]))
def test_a_search_keeps_the_ends_of_a_route_and_returns_to_the_best(
    seed: int, n: int, ends: str
) -> None:
    instance = random_matrices(n, seed, symmetric=False)
    if ends:
        instance = opened(instance, ends, seed)
    working, scalarization = descended(instance, seed)
    value = weighted_length(scalarization, working.tour)
    state = state_of(scalarization, seed + 1)
    iterated_local_search(state, working, scalarization, 30, 1)
    check_consistent(working, scalarization)
    assert not accepts(state.archive, working.length)
    assert weighted_length(scalarization, working.tour) <= value + LEAST
    if ends:
        check_ends(instance, working)


@pytest.mark.parametrize("ends", ENDS)
def test_a_kick_removes_no_step_that_has_to_stay_and_can_be_undone(ends: str) -> None:
    instance = opened(random_matrices(12, 0, symmetric=False), ends)
    working, scalarization = descended(instance, 0)
    before, random = working.tour.copy(), np.array([1])
    save(working)
    exchanged = set()
    for _ in range(200):
        perturb(working, scalarization, random)
        check_consistent(working, scalarization)
        check_ends(instance, working)
        exchanged.add(len(directed_steps(before) - directed_steps(working.tour)))
        undo(working)
        assert working.tour.tolist() == before.tolist()
    assert exchanged == {3, 4}  # swaps of two blocks, and double bridges


def test_the_same_seed_gives_the_same_tour() -> None:
    def found() -> list[int]:
        working, scalarization = descended(random_matrices(30, 0, symmetric=False), 0)
        iterated_local_search(state_of(scalarization, 7), working, scalarization, 100, 1)
        return working.tour.tolist()

    assert found() == found()
