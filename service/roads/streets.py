"""The legs of tours along the streets: ask for few trails, and join the lines of their legs."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from service.errors import StreetsTooLong
from service.roads.router import Line

Indices = NDArray[np.int64]
Leg = tuple[int, int]  # from one stop to another


def count_legs(ways: Sequence[Indices]) -> dict[Leg, int]:
    """Return how often each leg occurs in ways through stops, shape (m,) each, m at least 2.

    They are in the order of the ways, so that `trails` joins them to few trails.

    >>> count_legs([np.array([0, 1, 2, 0]), np.array([0, 1])])
    {(0, 1): 2, (1, 2): 1, (2, 0): 1}
    """
    legs = np.concatenate([np.stack((way[:-1], way[1:]), axis=-1) for way in ways])
    distinct, first, counts = np.unique(legs, axis=0, return_index=True, return_counts=True)
    order = np.argsort(first)
    pairs = zip(distinct[order].tolist(), counts[order].tolist(), strict=True)
    return {(i, j): n for (i, j), n in pairs}


def trails(legs: Iterable[Leg], most: int) -> list[list[int]]:
    """Return sequences of stops, of bounded length, that go along every leg once.

    Args:
        legs: Each from one stop to another; repeats count once.
        most: The most stops of a sequence, at least 2.

    >>> trails([(0, 1), (1, 2), (2, 0), (0, 2), (1, 2)], 4)
    [[0, 1, 2, 0], [0, 2]]
    """
    after: dict[int, list[int]] = {}
    for origin, destination in dict.fromkeys(legs):
        after.setdefault(origin, []).append(destination)
    found: list[list[int]] = []
    while after:
        trail = [next(iter(after))]
        while len(trail) < most and (destinations := after.get(trail[-1])):
            origin = trail[-1]
            trail.append(destinations.pop(0))
            if not destinations:
                del after[origin]
        found.append(trail)
    return found


class LegLines:
    """The lines of legs as they are found. Each counts as often as its leg occurs.

    Args:
        counts: How often each leg occurs.
        most: The most positions of all of them.
    """

    def __init__(self, counts: Mapping[Leg, int], most: int) -> None:
        self.lines: dict[Leg, Line] = {}
        self._counts = counts
        self._most = most
        self._positions = 0

    def add(self, leg: Leg, line: Line) -> None:
        """Add the line of a leg.

        Raises:
            StreetsTooLong: All have too many positions.
        """
        self.lines[leg] = line
        self._positions += self._counts[leg] * len(line)
        if self._positions > self._most:
            raise StreetsTooLong("positions", self._most)

    @property
    def missing(self) -> list[Leg]:
        """The legs that have no line yet."""
        return [leg for leg in self._counts if leg not in self.lines]


def join_legs(ways: Sequence[Indices], lines: Mapping[Leg, Line]) -> list[Line]:
    """Return the whole line of each way, shape (m,), joined from the lines of its legs, none empty.

    A line has two or more places; a longer one has no place twice in a row.
    """
    return [_join(way, lines) for way in ways]


def _join(way: Indices, lines: Mapping[Leg, Line]) -> Line:
    line = np.concatenate([lines[leg] for leg in pairwise(way.tolist())])
    moves = (line[1:] != line[:-1]).any(axis=1)
    line = line[np.concatenate(([True], moves))]
    return line if len(line) > 1 else line.repeat(2, axis=0)
