"""The steps towards two sums: weights, the normals of the hull's edges (Aneja and Nair, 1979).

They reach supported points only. Points are in PyVRP's units: products of costs then fit a double.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from service.fleet.archive import Point, SolutionArchive
from service.fleet.scales import STEEPEST
from service.fleet.solver import Step
from service.fleet.translation import Goal, Translation


def weight_steps(
    translation: Translation, archive: SolutionArchive, iterations: int
) -> Iterator[Step]:
    """Yield searches with the weights of both ends of the front, and of all edges of its hull.

    No weight can outweigh huge numbers of the other objective. So with huge numbers, each end is
    first searched with weight 0 for the other objective.
    """
    alone = [(1, 0), (0, 1)] if translation.squeezed.changed else []
    for weights in [*alone, (STEEPEST, 1), (1, STEEPEST)]:
        yield _weighted(archive, weights, translation, iterations)
    done: set[tuple[Point, Point]] = set()
    while True:
        points = _in_units(archive.guides, translation)
        edges = [edge for edge in pairwise(_hull(points)) if edge not in done]
        if not edges:
            return
        edge = max(edges, key=_triangle)
        done.add(edge)
        (x1, y1), (x2, y2) = edge
        yield _weighted(archive, (y1 - y2, x2 - x1), translation, iterations)


def _weighted(
    archive: SolutionArchive,
    weights: tuple[float, float],
    translation: Translation,
    iterations: int,
) -> Step:
    """Return a search with these weights, from the solution that is best under them."""
    points = np.array(_in_units(archive.guides, translation))
    start = archive.solutions[int((points @ np.array(weights)).argmin())]
    first, second = (_whole(each / max(weights)) for each in weights)
    whole = (first, second) if translation.roles.distance == 0 else (second, first)
    return Step(Goal(weights=whole), start, iterations)


def _whole(weight: float) -> int:
    """Return a weight as a whole number, where the larger of both is 1; 0 only if it is 0."""
    return max(1, round(STEEPEST * weight)) if weight else 0


def _in_units(points: list[Point], translation: Translation) -> list[Point]:
    """Return lengths in both objectives as PyVRP has them."""
    first, second = (translation.scale(objective) for objective in range(2))
    return [(x * first, y * second) for x, y in points]


def _triangle(edge: tuple[Point, Point]) -> float:
    """Return the area of the box between two neighbours on the hull."""
    (x1, y1), (x2, y2) = edge
    return (x2 - x1) * (y1 - y2)


def _hull(points: list[Point]) -> list[Point]:
    """Return the points of a front that lie on its lower left hull, from left to right."""
    hull: list[Point] = []
    for point in points:
        while len(hull) > 1 and _above(hull[-2], hull[-1], point):
            hull.pop()
        hull.append(point)
    return hull


def _above(a: Point, b: Point, c: Point) -> bool:
    """Return whether b is on or above the line from a to c."""
    return (b[0] - a[0]) * (c[1] - a[1]) <= (c[0] - a[0]) * (b[1] - a[1])
