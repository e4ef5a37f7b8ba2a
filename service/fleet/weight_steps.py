"""The steps towards two sums: weights, the normals of the hull's edges (Aneja and Nair, 1979).

They reach supported points alone.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from service.fleet.archive import Point, SolutionArchive
from service.fleet.solver import Step
from service.fleet.translation import Goal, Translation

_STEEPEST = 1000  # weight of one objective, with 1 of the other


def weight_steps(
    translation: Translation, archive: SolutionArchive, iterations: int
) -> Iterator[Step]:
    """Yield searches under the weights of both ends of the front, and of all edges of its hull."""
    for weights in ((_STEEPEST, 1), (1, _STEEPEST)):
        yield _weighted(archive, weights, translation, iterations)
    done: set[tuple[Point, Point]] = set()
    while True:
        edges = [edge for edge in pairwise(_hull(archive.points)) if edge not in done]
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
    """Return a search under weights of both objectives, from the solution that is best there."""
    points = np.array(archive.points)
    start = archive.solutions[int((points @ np.array(weights)).argmin())]
    roles = translation.roles
    of_distance = weights[roles.distance] / translation.distance_scale
    of_duration = weights[1 - roles.distance] / translation.duration_scale
    unit = max(of_distance, of_duration) / _STEEPEST
    whole = (max(1, round(of_distance / unit)), max(1, round(of_duration / unit)))
    return Step(Goal(weights=whole), start, iterations)


def _triangle(edge: tuple[Point, Point]) -> float:
    """Return the area of the box between two neighbours."""
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
