"""Moves and archive of the search, each against the plainest reckoning."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from service.instance import Instance
from service.pareto import hypervolume, nondominated
from service.search.archive import best_point, dominated_area, insert, make_archive, thin
from service.search.candidates import Scalarization
from service.search.costs import lengths, make_costs
from service.search.local_search import improve_at, nearest_neighbour
from service.search.moves import apply_move, length_change
from service.search.working_tour import (
    dequeue,
    enqueue,
    enqueue_all,
    load,
    make_working_tour,
    reverse_block,
    swap_blocks,
)


def instance_of(n: int, seed: int, symmetric: bool) -> Instance:
    matrices = np.random.default_rng(seed).random((2, n, n))
    if symmetric:
        matrices += matrices.transpose(0, 2, 1)
    return Instance(matrices=matrices)


def scalar_of(instance: Instance) -> Scalarization:
    costs = make_costs(instance)
    sums = costs.matrix.sum(axis=2) + np.diag(np.full(instance.n, np.inf))
    candidates = np.argsort(sums, axis=1)[:, : min(8, instance.n - 1)]
    candidate_costs = np.take_along_axis(sums, candidates, axis=1) / 2
    return Scalarization(
        costs, np.ascontiguousarray(candidates, np.int32), candidate_costs, 0.5, 0.5
    )


def cycle(tour: NDArray[np.int32]) -> list[int]:
    """The tour read from city 0 on."""
    return np.roll(tour, -int(np.argmin(tour))).tolist()


@given(n=st.integers(8, 20), start=st.integers(0, 19), a=st.integers(1, 19), b=st.integers(1, 19))
def test_swapping_blocks_equals_cutting_and_joining_lists(
    n: int, start: int, a: int, b: int
) -> None:
    start, a = start % n, 1 + a % (n - 2)
    b = 1 + b % (n - a - 1)
    working = make_working_tour(n)
    swap_blocks(working, start, a, b)
    turned = np.roll(np.arange(n), -start)
    expected = np.concatenate((turned[a : a + b], turned[:a], turned[a + b :]))
    assert cycle(working.tour) == cycle(expected)
    assert np.array_equal(working.tour[working.position], np.arange(n))


@given(n=st.integers(8, 20), start=st.integers(0, 19), size=st.integers(1, 19))
def test_reversing_equals_reversing_a_list_up_to_direction(n: int, start: int, size: int) -> None:
    start, size = start % n, 1 + size % (n - 1)
    working = make_working_tour(n)
    reverse_block(working, start, size)
    turned = np.roll(np.arange(n), -start)
    turned[:size] = turned[:size][::-1].copy()
    assert cycle(working.tour) in (cycle(turned), cycle(turned[::-1]))
    assert np.array_equal(working.tour[working.position], np.arange(n))


@given(seed=st.integers(0, 10**6), flip=st.booleans(), data=st.data())
def test_a_move_changes_lengths_as_foretold(seed: int, flip: bool, data: st.DataObject) -> None:
    n = 12
    instance = instance_of(n, seed, symmetric=flip)
    scalarization = scalar_of(instance)
    start, a = data.draw(st.integers(0, n - 1)), data.draw(st.integers(1, 3))
    b = data.draw(st.integers(0 if flip else 1, n - a - 1))
    working = make_working_tour(n)
    before = np.array(lengths(scalarization.costs, working.tour))
    foretold = np.array(length_change(working, scalarization, start, a, b, flip))
    apply_move(working, start, a, b, flip)
    assert np.array(lengths(scalarization.costs, working.tour)) == pytest.approx(before + foretold)


@settings(max_examples=30)
@given(seed=st.integers(0, 10**6), symmetric=st.booleans(), n=st.integers(8, 40))
def test_every_improving_move_gains_what_it_says(seed: int, symmetric: bool, n: int) -> None:
    scalarization = scalar_of(instance_of(n, seed, symmetric))
    working = make_working_tour(n)
    load(working, working.tour.copy(), *lengths(scalarization.costs, working.tour))
    enqueue_all(working)
    while working.ring[1] > 0:
        before = working.length.sum()
        if improve_at(working, scalarization, dequeue(working), 1e-9):
            assert working.length.sum() < before
            assert lengths(scalarization.costs, working.tour) == pytest.approx(
                tuple(working.length)
            )
    assert np.array_equal(np.sort(working.tour), np.arange(n))


def test_a_city_waits_only_once() -> None:
    working = make_working_tour(9)
    enqueue_all(working)
    enqueue(working, 4)
    assert [dequeue(working) for _ in range(int(working.ring[1]))] == list(range(9))


@pytest.mark.parametrize("symmetric", [True, False])
def test_the_nearest_neighbour_tour_visits_all(symmetric: bool) -> None:
    scalarization = scalar_of(instance_of(30, 1, symmetric))
    tour = np.empty(30, np.int32)
    nearest_neighbour(scalarization, 5, tour)
    assert tour[0] == 5
    assert np.array_equal(np.sort(tour), np.arange(30))


POINTS = st.lists(st.tuples(st.integers(1, 12), st.integers(1, 12)), min_size=1, max_size=40)


@given(points=POINTS)
def test_the_archive_holds_just_the_nondominated_points_and_their_tours(
    points: list[tuple[int, int]],
) -> None:
    archive = make_archive(1, 64)
    for k, (first, second) in enumerate(points):
        insert(archive, (float(first), float(second)), np.array([k], np.int32))
    kept = np.array(points, float)[nondominated(np.array(points, float))]
    size = archive.counts[0]
    assert np.array_equal(archive.points[:size], kept)
    owners = archive.tours[archive.slots[:size], 0]
    assert np.array_equal(np.array(points, float)[owners], kept)
    assert dominated_area(archive, 13.0, 13.0) == pytest.approx(
        169 * hypervolume(kept, np.full(2, 13.0))
    )
    # Powers of two, so that equal sums are equal to the last bit.
    assert best_point(archive, 0.25, 0.75) == np.argmin(kept @ [0.25, 0.75])


def test_a_full_archive_makes_room_and_keeps_its_ends() -> None:
    archive = make_archive(1, 16)
    for k in range(60):
        insert(archive, (1.0 + k, 100.0 - k), np.array([k], np.int32))
    size = archive.counts[0]
    assert 4 <= size <= 16
    assert archive.points[0].tolist() == [1.0, 100.0]
    assert archive.points[size - 1].tolist() == [60.0, 41.0]
    assert np.array_equal(archive.tours[archive.slots[:size], 0] + 1, archive.points[:size, 0])


def test_thinning_drops_the_points_that_add_least() -> None:
    archive = make_archive(1, 16)
    for first, second in [(1, 9), (4, 5), (4.1, 4.9), (4.2, 4.8), (8, 1)]:
        insert(archive, (float(first), float(second)), np.array([0], np.int32))
    thin(archive)
    assert [1.0, 9.0] in archive.points[: archive.counts[0]].tolist()
    assert [4.1, 4.9] not in archive.points[: archive.counts[0]].tolist()
