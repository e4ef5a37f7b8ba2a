"""Matrices of costs drawn at random: entries of no plane, rounded planes, roads, coverage maps."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, floyd_warshall, shortest_path

from models.data.generators import PLANES, coverage_matrices

Array = NDArray[np.float64]

_UNITS = (10.0, 1000.0)  # of a rounded plane: the side of the unit square, least and largest
_ONE_WAY = (0.2, 0.7)  # least and largest share of streets that go in one direction
_STREETS = 0.85  # share of the streets of a full grid
_SPEEDS = (1.0, 2.0, 4.0)  # of a street, by its class
_PLACES = 1.6  # the least number of crossings of a street graph for each city
_CONGESTION = 0.3  # standard deviation of the logarithm of a street's slowness


def entries(n: int, generator: Generator) -> Array:
    """Draw costs uniform between 0 and 1, shape (2, n, n), each step on its own."""
    drawn = generator.random((2, n, n))
    drawn[:, np.arange(n), np.arange(n)] = 0.0
    return drawn


def closed_entries(n: int, generator: Generator) -> Array:
    """Draw random costs and close them under the triangle inequality, by Floyd and Warshall."""
    return np.stack([floyd_warshall(matrix) for matrix in entries(n, generator)])


def planes(n: int, generator: Generator) -> Array:
    """Draw distances in two planes, each of a kind of its own."""
    return np.stack([_distances(n, generator) for _ in range(2)])


def rounded_planes(n: int, generator: Generator) -> Array:
    """Draw distances in two planes, rounded to whole numbers of a unit."""
    least, most = np.log(_UNITS)
    sides = np.exp(generator.uniform(least, most, size=(2, 1, 1)))
    return np.rint(sides * planes(n, generator))


def maps(n: int, generator: Generator) -> Array:
    """Draw the costs of a coverage map."""
    return coverage_matrices(generator, n)


def roads(n: int, generator: Generator) -> Array:
    """Draw the length and the time of shortest ways between crossings of a graph of streets.

    The streets are those of a grid that is bent, from which some are missing; some go in one
    direction, and they differ in speed. Both costs are of the shortest way in that cost.
    """
    side = int(np.ceil(np.sqrt(_PLACES * n))) + int(generator.integers(6))
    while True:
        lengths, times = _street_graph(side, generator)
        crossings = _strongly_connected(lengths)
        if len(crossings) >= n:
            break
    some = generator.permutation(crossings)[:n]
    ways = (shortest_path(graph, method="D", indices=some)[:, some] for graph in (lengths, times))
    return np.stack(list(ways))


def _street_graph(side: int, generator: Generator) -> tuple[csr_array, csr_array]:
    """Draw the streets between crossings: their lengths, and the time that each takes."""
    numbers = np.arange(side * side).reshape(side, side)
    grid = np.indices((side, side)).reshape(2, -1).T
    places = grid + generator.normal(scale=0.2, size=grid.shape)
    along = np.stack((numbers[:, :-1].ravel(), numbers[:, 1:].ravel()))
    across = np.stack((numbers[:-1].ravel(), numbers[1:].ravel()))
    streets = np.concatenate((along, across), axis=1)
    streets = streets[:, generator.random(streets.shape[1]) < _STREETS]
    streets = np.where(generator.random(streets.shape[1]) < 0.5, streets, streets[::-1])
    both_ways = generator.random(streets.shape[1]) >= generator.uniform(*_ONE_WAY)
    start, stop = np.concatenate((streets, streets[::-1, both_ways]), axis=1)
    lengths = np.hypot(*(places[start] - places[stop]).T) + 0.1
    speeds = generator.choice(_SPEEDS, size=streets.shape[1], p=(0.6, 0.3, 0.1))
    speeds = np.concatenate((speeds, speeds[both_ways]))
    slowness = np.exp(generator.normal(scale=_CONGESTION, size=len(start)))
    shape = (side * side, side * side)
    return (
        csr_array((lengths, (start, stop)), shape),
        csr_array((lengths * slowness / speeds, (start, stop)), shape),
    )


def _strongly_connected(graph: csr_array) -> NDArray[np.integer]:
    """Return the numbers of the places of the largest part that is strongly connected."""
    _, parts = connected_components(graph, connection="strong")
    return np.flatnonzero(parts == np.bincount(parts).argmax())


def _distances(n: int, generator: Generator) -> Array:
    kind = generator.choice(list(PLANES), p=(0.5, *3 * [0.5 / 3]))
    cities = PLANES[kind](n, generator)
    return np.hypot(*(cities[:, np.newaxis] - cities).transpose(2, 0, 1))


MATRICES: dict[str, Callable[[int, Generator], Array]] = {
    draw.__name__: draw for draw in (entries, closed_entries, planes, rounded_planes, maps, roads)
}
# How often each kind is drawn.
SHARES = (0.25, 0.3, 0.1, 0.05, 0.1, 0.2)


def any_matrices(n: int, generator: Generator) -> Array:
    """Draw costs of a kind drawn at random."""
    return MATRICES[generator.choice(list(MATRICES), p=SHARES)](n, generator)
