"""Exchanges of three-opt: what one gains is what it changes, and undoing it leaves no trace."""

import itertools

import numpy as np
import pytest

from service.search.archive.insertion import accepts
from service.search.candidates import Scalarization
from service.search.costs import lengths
from service.search.three_opt.deepening import deepen
from service.search.three_opt.exchanges import NONE
from service.search.three_opt.exchanges import make_exchange as make_exchange_kernel
from service.search.three_opt.finding import find_exchanges as find_exchanges_kernel
from service.search.three_opt.finding import nothing_found as nothing_found_kernel
from service.search.three_opt.local_search import descend, iterated_local_search
from service.search.three_opt.undoable_tour import load, make_undoable_tour, undo
from service.search.three_opt.undoable_tour import (
    save as save_kernel,
)
from service.search.working_tour import UndoableTour, enqueue_cities
from service.search.working_tour import dequeue as dequeue_kernel
from service.search.working_tour import enqueue as enqueue_kernel
from tests.helpers.instances import (
    opened,
    random_matrices,
    scalarization_of,
    state_of,
    steps_of,
    weighted_length,
)
from tests.helpers.kernels import for_python
from tests.helpers.sampled import third

make_exchange = for_python(make_exchange_kernel)
find_exchanges = for_python(find_exchanges_kernel)
nothing_found = for_python(nothing_found_kernel)
save = for_python(save_kernel)
dequeue = for_python(dequeue_kernel)
enqueue = for_python(enqueue_kernel)

N = 9
LEAST = 1e-9  # of gains, above what rounding adds


def shuffled(scalarization: Scalarization, seed: int) -> UndoableTour:
    """A random tour, whose positions do not ascend from the invented city of a route."""
    n = len(scalarization.costs.cities)
    tour = np.random.default_rng(seed).permutation(n).astype(np.int32)
    working = make_undoable_tour(n)
    load(working, tour, *lengths(scalarization.costs, tour))
    return working


def descend_by_three_opt(working: UndoableTour, scalarization: Scalarization) -> bool:
    """Make the best exchange at one queued city, if any gains; whether the queue holds more."""
    city = dequeue(working)
    _, best, *_ = find_exchanges(working, scalarization, city, nothing_found(LEAST))
    if best[0] != NONE:
        make_exchange(working, scalarization, best)
        enqueue(working, city)
        save(working)
    return bool(working.ring[1] > 0)


def left_to_see(working: UndoableTour) -> list[np.ndarray]:
    """Copies of the tour, its inverse, its lengths, the size of its log, and of its queue."""
    seen = (working.tour, working.position, working.length, working.changed)
    return [array.copy() for array in (*seen, working.queued, working.ring)]


def best_of_all(scalarization: Scalarization, tour: list[int]) -> float:
    """The most that any exchange of up to three steps gains: every way to join three blocks."""
    cost = scalarization.costs.matrix.sum(axis=2) / 2

    def length(way: list[int]) -> float:
        return float(cost[way, [*way[1:], way[0]]].sum())

    least = length(tour)
    for turn, i, j in itertools.product(range(len(tour)), repeat=3):
        turned = tour[turn:] + tour[:turn]
        head, middle, tail = turned[:i], turned[i:j], turned[j:]
        if head and i <= j:
            for a, b in itertools.product((middle, middle[::-1]), (tail, tail[::-1])):
                least = min(least, length(head + a + b), length(head + b + a))
    return length(tour) - least


@pytest.mark.parametrize("seed", range(third(40)))
def test_an_exchange_gains_what_it_says_changes_three_steps_and_can_be_undone(seed: int) -> None:
    scalarization = scalarization_of(random_matrices(N, seed, symmetric=True))
    working = shuffled(scalarization, seed)
    before, at = working.tour.copy(), working.length.copy()
    for city in range(N):
        gain, exchange, *_ = find_exchanges(working, scalarization, city, nothing_found(LEAST))
        if exchange[0] == NONE:
            continue
        make_exchange(working, scalarization, exchange)
        gained = weighted_length(scalarization, before) - weighted_length(
            scalarization, working.tour
        )
        assert gained == pytest.approx(gain)
        assert working.length == pytest.approx(lengths(scalarization.costs, working.tour))
        assert sorted(working.tour) == list(range(N))
        assert working.position[working.tour].tolist() == list(range(N))
        changed = steps_of(before) - steps_of(working.tour)
        assert len(changed) in (2, 3)
        assert all(working.queued[list(step)].all() for step in changed)
        undo(working)
        assert working.tour.tolist() == before.tolist()
        assert working.length.tolist() == at.tolist()


def test_the_best_exchange_of_a_short_tour_is_the_best_of_all() -> None:
    """Most, not all: a step added may cost more than the one before it that is removed."""
    found = most = 0
    for seed in range(30):
        scalarization = scalarization_of(random_matrices(7, seed, symmetric=True))
        working = shuffled(scalarization, seed)
        none = nothing_found(LEAST)
        gain = max(find_exchanges(working, scalarization, city, none)[0] for city in range(7))
        expected = best_of_all(scalarization, working.tour.tolist())
        assert gain <= expected + 1e-9
        found, most = found + (gain > expected - 1e-9), most + 1
    assert found > 0.9 * most


def test_two_exchanges_in_sequence_gain_together_or_leave_no_trace() -> None:
    made = 0
    for seed in range(60):
        scalarization = scalarization_of(random_matrices(12, seed, symmetric=True))
        working = shuffled(scalarization, seed)
        enqueue_cities(working, working.tour.copy())
        while descend_by_three_opt(working, scalarization):
            pass
        before = left_to_see(working)
        for city in range(12):
            _, best, promised, promising = find_exchanges(
                working, scalarization, city, nothing_found(LEAST)
            )
            assert best[0] == NONE
            if promising[0] == NONE:
                continue
            value = weighted_length(scalarization, working.tour)
            if deepen(working, scalarization, promised, promising, LEAST):
                made += 1
                assert weighted_length(scalarization, working.tour) < value - LEAST / 2
                assert working.length == pytest.approx(lengths(scalarization.costs, working.tour))
                changed = steps_of(before[0]) - steps_of(working.tour)
                assert len(changed) <= 5
                assert all(working.queued[list(step)].all() for step in changed)
                break
            now = left_to_see(working)
            assert all(np.array_equal(one, other) for one, other in zip(now, before, strict=True))
    assert made > 5


@pytest.mark.parametrize("fixed", ["no", "start", "both"])
def test_a_search_of_a_route_keeps_its_ends_and_returns_to_the_best(fixed: str) -> None:
    for seed in range(5):
        instance = opened(random_matrices(12, seed, symmetric=True), fixed)
        scalarization = scalarization_of(instance)
        working = make_undoable_tour(13)
        load(working, working.tour.copy(), *lengths(scalarization.costs, working.tour))
        enqueue_cities(working, working.tour.copy())
        while descend(working, scalarization, 3, False) == 0:
            pass
        value = weighted_length(scalarization, working.tour)
        state = state_of(scalarization, seed + 1)
        iterated_local_search(state, working, scalarization, 30, 1 + 10 * seed)
        assert not accepts(state.archive, working.length)  # at least the last tour has been offered
        assert weighted_length(scalarization, working.tour) <= value + 1e-9
        assert sorted(working.tour) == list(range(13))
        assert working.position[working.tour].tolist() == list(range(13))
        assert working.length == pytest.approx(lengths(scalarization.costs, working.tour))
