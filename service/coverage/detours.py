"""Find further paths between the places of a map: longer in metres, cheaper in other objectives.

Each path is the cheapest under a weighted sum of metres and cost layers. In the best tour under
some weights, each leg takes its best path under the same weights. So a few paths of each leg are
enough for all tours, if their weights are spread between the objectives.

Only places that are near each other get further paths: tours seldom have other legs.
"""

from collections.abc import Callable
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from service.coverage import shortest_paths
from service.coverage.cheapest_paths import CheapestPaths
from service.coverage.frame import Array, Cells
from service.coverage.leg_paths import FurtherPaths, LegPaths
from service.coverage.shortest_paths import cell_numbers, make_grid, path_costs, path_steps
from service.preferences import lattice

# The number of nearest places to which each place gets further paths: the most, and the fewest, on
# a large map. The searches visit each cell a few times for each nearest place, whatever the number
# of places on the map.
_NEAREST, _FEWEST = 12, 5
_MOST_VISITED = 2**22  # free cells of the map times nearest places of a place
# Weights come from shares of the objectives: multiples of 1 / parts that add up to 1. The parts, by
# the number of objectives: for the paths, and for the further weights by which legs choose a path.
_PARTS = {2: 4, 3: 3, 4: 2}
_PARTS_OF_CHOICES = {2: 32, 3: 5, 4: 3}
_LEAST_SHARE = 1e-4  # in place of 0, so that of equally cheap paths the shortest is taken
_TINY = float(np.finfo(float).tiny)


def find_detours(
    shortest: LegPaths, layers: Array, stop: Callable[[], bool]
) -> FurtherPaths | None:
    """Return the cheapest paths between near places, under several weights of the objectives.

    Return None if there are fewer than two places, or `stop` returned True.

    Args:
        shortest: The places, and the shortest paths between them.
        layers: The cost of a step of one cell's length in each cell, under each objective, shape
            (m, cells of the grid). The first objective is metres, the same in all cells.
        stop: Called before each search; True ends the searches.
    """
    instance = shortest.instance
    assert instance.matrices is not None
    visited = int(shortest.grid.free.sum())
    nearest = int(np.clip(_MOST_VISITED // visited, _FEWEST, _NEAREST))
    pairs = _near_pairs(instance.matrices[0], nearest)
    if not len(pairs):
        return None
    first, second = pairs.T
    lengths = [instance.matrices[:, first, second]]
    steps = [shortest.steps[first, second]]
    weights: list[Array] = []

    def add(each: Array) -> None:
        weights.append(each)
        found = _cheapest(shortest, each @ layers, layers, pairs, stop)
        lengths.append(found[0])
        steps.append(found[1])

    corners = np.eye(len(layers))
    means = layers[:, shortest.grid.free].mean(axis=1)
    for corner in corners[1:]:
        add(np.maximum(corner, _LEAST_SHARE) / np.maximum(means, _TINY))
    totals = np.array(lengths).sum(axis=2)
    ranges = np.maximum(np.ptp(totals, axis=0), _LEAST_SHARE * totals.max(axis=0))
    for shares in _lattice(len(layers), _PARTS):
        if shares.max() < 1 - _LEAST_SHARE:
            add(shares / np.maximum(ranges, _TINY))
    if stop():
        return None
    found = np.array(lengths)
    many = _lattice(len(layers), _PARTS_OF_CHOICES) / np.maximum(ranges, _TINY)
    own = np.concatenate((corners[:1], weights))
    return FurtherPaths(
        pairs=pairs,
        lengths=found,
        steps=np.array(steps),
        layers=np.array(weights) @ layers,
        choices=_choices(found, np.concatenate((own, many))),
    )


def most_searches(places: int, objectives: int) -> int:
    """Return the most searches of `find_detours`: one for each place and each row of weights."""
    return places * (len(_lattice(objectives, _PARTS)) - 1)


def warm_up() -> None:
    """Compile the searches for paths, or load them from the cache of an earlier process."""
    shortest_paths.warm_up()
    grid = make_grid(np.ones((1, 2), np.bool_))
    cells = cell_numbers(grid, np.array([[0, 0], [0, 1]]))
    path_steps(CheapestPaths(grid).find(grid.layer, int(cells[0]), cells), cells)


def _near_pairs(metres: Array, count: int) -> Cells:
    """Return the pairs of each place and its `count` nearest places, shape (p, 2).

    Each pair is there once, its lower number first. Pairs are in ascending order.
    """
    nearest = np.argsort(metres, axis=1, kind="stable")[:, : count + 1]
    pairs = np.stack((np.repeat(np.arange(len(metres)), nearest.shape[1]), nearest.ravel()), axis=1)
    pairs = np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1)
    return np.unique(pairs, axis=0)


def _cheapest(
    shortest: LegPaths, weighted: Array, layers: Array, pairs: Cells, stop: Callable[[], bool]
) -> tuple[Array, NDArray[np.int32]]:
    """Return the lengths, shape (m, p), and the steps, shape (p,), of each pair's cheapest path.

    Args:
        shortest: The places, and the shortest paths between them.
        weighted: The weighted cost of each cell, which paths minimise, shape (cells of the grid,).
        layers: The cost of each cell under each objective, shape (m, cells of the grid).
        pairs: The pairs of places, shape (p, 2), in ascending order.
        stop: Called before each search. Once it returns True, all other lengths and steps are 0.
    """
    grid, cells = shortest.grid, shortest.cells
    lengths, steps = np.zeros((len(layers), len(pairs))), np.zeros(len(pairs), np.int32)
    for origin, group in groupby(range(len(pairs)), key=lambda pair: pairs[pair, 0]):
        if stop():
            break
        own = list(group)
        ends = cells[pairs[own, 1]]
        before = shortest.cheapest.find(weighted, int(cells[origin]), ends)
        steps[own] = path_steps(before, ends)
        for row, layer in zip(lengths, layers, strict=True):
            row[own] = path_costs(grid, before, layer, ends)
    return lengths, steps


def _lattice(objectives: int, parts: dict[int, int]) -> Array:
    """Return weights that are spread between the objectives, shape (k, m), all above 0."""
    return np.maximum(lattice(objectives, parts[objectives]), _LEAST_SHARE)


def _choices(lengths: Array, weights: Array) -> NDArray[np.int8]:
    """Return the number of each pair's best path under each row of weights, shape (w, p).

    Args:
        lengths: The length of each path under each objective, shape (paths, m, p).
        weights: Shape (w, m).
    """
    best = [np.tensordot(row, lengths, (0, 1)).argmin(axis=0) for row in weights]
    return np.array(best, np.int8)
