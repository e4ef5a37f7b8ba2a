"""An independent check of plans for robots, and all plans of tiny tasks, on a map of their own."""

from collections.abc import Iterator, Mapping
from itertools import pairwise, permutations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def walked(cells: Any, cell_size: float, blocked: Any) -> float:
    """Return the metres of a path, after a check that each of its steps can be taken."""
    free = ~np.array(blocked, dtype=np.bool_)
    metres = 0.0
    assert all(free[tuple(cell)] for cell in cells)
    for (row, column), (down, right) in pairwise(cells):
        assert max(abs(down - row), abs(right - column)) == 1
        assert free[row, right]  # no corner is cut
        assert free[down, column]
        metres += cell_size * np.hypot(down - row, right - column)
    return metres


def distances(request: Mapping[str, Any]) -> Array:
    """Return the metres between all cells of a small map, shape (cells, cells): Floyd-Warshall."""
    grid = np.array(request["grid"])
    rows, columns = grid.shape
    found = np.full((grid.size, grid.size), np.inf)
    for row, column, down, right in product(range(rows), range(columns), (-1, 0, 1), (-1, 0, 1)):
        to_row, to_column = row + down, column + right
        if 0 <= to_row < rows and 0 <= to_column < columns:
            beside = grid[row, column] + grid[to_row, column] + grid[row, to_column]
            if not beside + grid[to_row, to_column]:
                step = request["cell_size"] * np.hypot(down, right)
                found[row * columns + column, to_row * columns + to_column] = step
    for between in range(grid.size):
        found = np.minimum(found, found[:, [between]] + found[[between]])
    return found


def check_answer(request: Mapping[str, Any], answer: Mapping[str, Any]) -> None:
    """Check the plans of an answer with paths: visits, ends, lengths and paths of all routes."""
    robots = {robot["id"]: robot for robot in request["robots"]}
    starts = {robot.get("start", 0) for robot in robots.values()}
    closed = request.get("closed", True)
    assert answer["front"]
    for plan in answer["front"]:
        routes = plan["routes"]
        assert len({route["robot"] for route in routes}) == len(routes)
        visited = [place for route in routes for place in set(route["tour"])]
        others = [place for place in visited if place not in starts]
        ends = [robot["end"] for robot in robots.values() if "end" in robot]
        assert set(others) == set(range(len(request["places"]))) - starts
        assert all(others.count(place) == 1 or place in ends for place in others)
        for route in routes:
            _check_route(request, answer["places"], robots[route["robot"]], route, closed)
        lengths = np.array([route["lengths"] for route in routes])
        np.testing.assert_allclose(plan["lengths"], [lengths[:, 0].sum(), lengths[:, 1].max()])
    points = [plan["lengths"] for plan in answer["front"]]
    assert all(a[0] < b[0] and a[1] > b[1] for a, b in pairwise(points))


def _check_route(
    request: Mapping[str, Any],
    places: list[list[int]],
    robot: Mapping[str, Any],
    route: Mapping[str, Any],
    closed: bool,
) -> None:
    tour, cells = route["tour"], route["path"]["cells"]
    assert tour[0] == robot.get("start", 0)
    if closed or "end" in robot:
        assert tour[-1] == (tour[0] if closed else robot["end"])
    assert (cells[0], cells[-1]) == (places[tour[0]], places[tour[-1]])
    onward = iter(cells)
    assert all(places[place] in onward or places[place] == cells[-1] for place in tour[1:-1])
    metres = walked(cells, request["cell_size"], request["grid"])
    np.testing.assert_allclose([metres, metres], [route["path"]["metres"], route["lengths"][0]])


def best_plans(request: Mapping[str, Any]) -> list[tuple[float, float]]:
    """Return the front of the total against the longest route, by trying every plan."""
    columns = len(request["grid"][0])
    metres = distances(request)
    cells = [row * columns + column for row, column in request["places"]]
    between = metres[np.ix_(cells, cells)]
    found = sorted({_lengths(request, between, plan) for plan in _plans(request)})
    front: list[tuple[float, float]] = []
    for total, longest in found:
        if not front or longest < front[-1][1] - 1e-9:
            front.append((total, longest))
    return front


def _plans(request: Mapping[str, Any]) -> Iterator[list[tuple[int, ...]]]:
    """Yield for each robot the places that it visits, in order."""
    starts = {robot.get("start", 0) for robot in request["robots"]}
    others = [place for place in range(len(request["places"])) if place not in starts]
    for takers in product(range(len(request["robots"])), repeat=len(others)):
        shares = [
            [place for place, taker in zip(others, takers, strict=True) if taker == robot]
            for robot in range(len(request["robots"]))
        ]
        yield from map(list, product(*(permutations(share) for share in shares)))


def _lengths(
    request: Mapping[str, Any], between: Array, plan: list[tuple[int, ...]]
) -> tuple[float, float]:
    lengths = [0.0]
    for robot, visits in zip(request["robots"], plan, strict=True):
        start = robot.get("start", 0)
        ends = [start] if request.get("closed", True) else [robot["end"]] if "end" in robot else []
        way = [start, *visits, *ends] if visits else [start]
        lengths.append(float(sum(between[a, b] for a, b in pairwise(way))))
    return round(sum(lengths), 9), round(max(lengths), 9)
