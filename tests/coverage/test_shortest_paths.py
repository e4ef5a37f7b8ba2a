"""Shortest paths on grids, beside scipy's on the graph that a grid is."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from service.coverage.shortest_paths import (
    ShortestPaths,
    cell_numbers,
    framed_layer,
    make_grid,
    pairwise_paths,
    path_costs,
    trace_path,
)

SHAPES = st.tuples(st.integers(1, 7), st.integers(1, 7))
GRIDS = SHAPES.flatmap(
    lambda shape: st.tuples(
        arrays(np.bool_, shape, elements=st.sampled_from([True, True, False])),
        arrays(np.float64, shape, elements=st.integers(0, 3)),
    )
).filter(lambda grid: grid[0].any())


def never() -> bool:
    return False


def steps(free: np.ndarray, layer: np.ndarray) -> list[tuple[int, int, float, float]]:
    """Every step there is: from cell, to cell, its length and what the layer adds."""
    rows, columns = free.shape
    found = []
    for (r, c), is_free in np.ndenumerate(free):
        for s in (r - 1, r, r + 1):
            for d in (c - 1, c, c + 1):
                inside = 0 <= s < rows and 0 <= d < columns and (r, c) != (s, d)
                if is_free and inside and free[s, d] and free[s, c] and free[r, d]:
                    length = np.hypot(s - r, d - c)
                    cost = length * (layer[r, c] + layer[s, d]) / 2
                    found.append((r * columns + c, s * columns + d, length, cost))
    return found


def by_scipy(free: np.ndarray, layer: np.ndarray, weight: float) -> np.ndarray:
    """Between all cells, the least sum of the length and a multiple of the layer's cost."""
    n = free.size
    found = steps(free, layer)
    if not found:
        return np.where(np.eye(n), 0.0, np.inf)
    tails, heads, lengths, costs = map(np.array, zip(*found, strict=True))
    graph = coo_array((lengths + weight * costs, (tails, heads)), shape=(n, n))
    return dijkstra(graph.tocsr())


@given(GRIDS)
def test_lengths_are_those_of_scipy(drawn: tuple[np.ndarray, np.ndarray]) -> None:
    free, layer = drawn
    cells = np.argwhere(free)
    grid = make_grid(free, layer)
    lengths, costs = pairwise_paths(grid, cell_numbers(grid, cells), never)
    inside = np.ix_(free.ravel(), free.ravel())
    expected = by_scipy(free, layer, 0.0)[inside]
    np.testing.assert_allclose(lengths, expected)
    np.testing.assert_array_equal(lengths, lengths.T)
    # With a weight so small that no length is made up for, scipy finds the cheapest of the
    # shortest paths as well.
    reached = np.isfinite(expected)
    both = by_scipy(free, layer, 1e-5)[inside]
    added = (both[reached] - expected[reached]) * 1e5
    np.testing.assert_allclose(added, costs[0][reached], atol=1e-6)


@given(GRIDS)
def test_a_path_is_made_of_steps_and_is_as_long_and_as_costly_as_it_says(
    drawn: tuple[np.ndarray, np.ndarray],
) -> None:
    free, layer = drawn
    cells = np.argwhere(free)
    grid = make_grid(free, layer)
    numbers = cell_numbers(grid, cells)
    tree = ShortestPaths(grid).find(int(numbers[0]), numbers)
    table = {(tail, head): rest for tail, head, *rest in steps(free, layer)}
    for number, cell in zip(numbers, cells, strict=True):
        if np.isfinite(tree.length[number]):
            path = trace_path(grid, tree.predecessor, number)
            assert (path[0].tolist(), path[-1].tolist()) == (cells[0].tolist(), cell.tolist())
            taken = [table[step] for step in pairwise((path @ [free.shape[1], 1]).tolist())]
            length, cost = np.sum(taken, axis=0) if taken else (0, 0)
            np.testing.assert_allclose(tree.length[number], length)
            np.testing.assert_allclose(tree.cost[number], cost)
            by_layer = path_costs(grid, tree.predecessor, framed_layer(layer), numbers)
            np.testing.assert_allclose(by_layer[numbers == number], cost)


def test_no_corner_is_cut() -> None:
    free = np.array([[True, False], [True, True]])
    grid = make_grid(free)
    lengths, _ = pairwise_paths(grid, cell_numbers(grid, np.array([[0, 0], [1, 1]])), never)
    assert lengths[0, 1] == 2


def test_between_two_blocked_cells_nobody_slips_through() -> None:
    grid = make_grid(np.eye(2, dtype=np.bool_))
    lengths, _ = pairwise_paths(grid, cell_numbers(grid, np.array([[0, 0], [1, 1]])), never)
    assert np.isinf(lengths[0, 1])


def test_lengths_on_an_empty_grid_are_octile_distances() -> None:
    rng = np.random.default_rng(4)
    grid = make_grid(np.ones((300, 200), np.bool_))
    cells = rng.integers((300, 200), size=(30, 2))
    lengths, _ = pairwise_paths(grid, cell_numbers(grid, cells), never)
    steps = np.abs(cells[:, None] - cells)
    expected = steps.max(axis=2) + (np.sqrt(2) - 1) * steps.min(axis=2)
    np.testing.assert_allclose(lengths, expected)


def test_it_stops_when_told_to() -> None:
    grid = make_grid(np.ones((9, 9), np.bool_))
    answers = iter([False, True])
    lengths, _ = pairwise_paths(
        grid, cell_numbers(grid, np.array([[0, 0], [0, 3], [8, 8]])), lambda: next(answers)
    )
    assert (lengths[0, 1], lengths[1, 2]) == (3, 0)
    with pytest.raises(StopIteration):
        next(answers)
