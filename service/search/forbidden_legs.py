"""Check conditions that every tour without a forbidden leg needs, and name what breaks them.

If none is broken, there may still be no tour. An open route counts as a closed tour through one
more city, which comes after the last city and before the first.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from service.errors import CityNames, NoTour, Obstacle
from service.instance import Instance, RouteEnds

Mask = NDArray[np.bool_]
_MOST_MATCHED = 64  # cities with few ways, among which too few different neighbours are looked for
_TIGHTEST = 3  # cities with the fewest ways that are named where no condition is broken


def check_legs(instance: Instance, names: CityNames | None = None) -> None:
    """Raise NoTour where the legs that are allowed cannot make a tour of an instance.

    O(n^2) where a leg is forbidden.
    """
    if instance.matrices is not None:
        check_ways(np.isinf(instance.matrices[0]), instance.ends, names)


def check_ways(
    forbidden: Mask, ends: RouteEnds, names: CityNames | None = None, code: str = "no-plan"
) -> None:
    """Raise NoTour where legs make no tour; those from row to column that are True are forbidden.

    Args:
        forbidden: Shape (n, n).
        ends: Whether tours are closed, and the fixed ends of open ones.
        names: The names of the cities.
        code: The code of the refusal.
    """
    if not forbidden.any():
        return
    if obstacles := find_obstacles(forbidden, ends):
        raise NoTour(obstacles, names, code)


def find_obstacles(forbidden: Mask, ends: RouteEnds) -> list[Obstacle]:
    """Return why no tour exists, several reasons where cities lack ways in or out."""
    if len(forbidden) == 1:
        return []
    allowed = ~forbidden
    np.fill_diagonal(allowed, False)
    if ends.start is not None:
        allowed[:, ends.start] = False
    if ends.end is not None:
        allowed[ends.end] = False
    cycle = allowed if ends.closed else _with_return(allowed, ends)
    if dead_ends := list(_dead_ends(cycle, len(allowed))):
        return dead_ends
    for find in (_apart(allowed, ends.closed), _pendants(cycle), _shared_neighbours(cycle, ends)):
        for obstacle in find:
            return [obstacle]
    return []


def tightest(instance: Instance) -> tuple[int, ...]:
    """Return the cities that the fewest ways lead to or from, the most restricted first."""
    assert instance.matrices is not None
    allowed = np.isfinite(instance.matrices[0])
    ways = np.minimum(allowed.sum(axis=0), allowed.sum(axis=1))
    return tuple(np.argsort(ways, kind="stable")[:_TIGHTEST].tolist())


def _with_return(allowed: Mask, ends: RouteEnds) -> Mask:
    """Return the allowed legs with one city more: after the last city, and before the first."""
    extended = np.pad(allowed, (0, 1))
    extended[slice(len(allowed)) if ends.end is None else ends.end, -1] = True
    extended[-1, slice(len(allowed)) if ends.start is None else ends.start] = True
    return extended


def _dead_ends(cycle: Mask, n: int) -> Iterator[Obstacle]:
    """Yield the cities, of the first n, that no way leads to or from."""
    for city in np.flatnonzero(~cycle[:, :n].any(axis=0)).tolist():
        yield Obstacle("no-way-to", (city,))
    for city in np.flatnonzero(~cycle[:n].any(axis=1)).tolist():
        yield Obstacle("no-way-from", (city,))


def _apart(allowed: Mask, closed: bool) -> Iterator[Obstacle]:
    """Yield two parts of the cities that no ways connect as a tour needs it."""
    parts = [tuple(sorted(part)) for part in _components(allowed)]
    if closed and len(parts) > 1:
        to_first = len(parts[0]) <= len(parts[-1])
        part = parts[0 if to_first else -1]
        rest = np.setdiff1d(np.arange(len(allowed)), part)
        code = "no-way-between-to" if to_first else "no-way-between-from"
        yield Obstacle(code, part, tuple(rest.tolist()))
    for one, other in pairwise(parts):
        # No part between them can be on the way: these are in the order in which ways lead.
        if not closed and not allowed[np.ix_(one, other)].any():
            yield Obstacle("apart", one, other)


def _components(allowed: Mask) -> list[list[int]]:
    """Return the strongly connected components, ordered so that no way leads to an earlier one.

    Kosaraju's algorithm, O(n^2).
    """
    unseen = np.ones(len(allowed), np.bool_)
    finished = [city for root in range(len(allowed)) for city in _search(allowed, root, unseen)]
    unseen[:] = True
    parts = (_search(allowed.T, root, unseen) for root in reversed(finished))
    return [part for part in parts if part]


def _search(allowed: Mask, root: int, unseen: Mask) -> list[int]:
    """Return the unseen cities that are reached from one, in the order in which they finish.

    They are marked as seen.
    """
    if not unseen[root]:
        return []
    path, finished = [root], []
    unseen[root] = False
    while path:
        following = allowed[path[-1]] & unseen
        city = int(following.argmax())
        if following[city]:
            unseen[city] = False
            path.append(city)
        else:
            finished.append(path.pop())
    return finished


def _pendants(cycle: Mask) -> Iterator[Obstacle]:
    """Yield a city whose ways lead to and from one other city alone, between which it must be."""
    if len(cycle) < 3:
        return
    neighbours = cycle | cycle.T
    for city in np.flatnonzero(neighbours.sum(axis=1) == 1).tolist():
        yield Obstacle("one-neighbour", (city,), (int(neighbours[city].argmax()),))


def _shared_neighbours(cycle: Mask, ends: RouteEnds) -> Iterator[Obstacle]:
    """Yield cities that have fewer cities to come next, or before, than they are."""
    n = len(cycle) if ends.closed else len(cycle) - 1
    for legs, few, few_but_one in (
        (cycle, "few-after", "few-after-but-last"),
        (cycle.T, "few-before", "few-before-but-first"),
    ):
        found = _too_few_neighbours(legs)
        if found is None:
            continue
        cities, others = (tuple(i for i in each if i < n) for each in found)
        if len(cities) <= 1:
            continue
        yield Obstacle(few_but_one if n in found[1] else few, cities, others)


def _too_few_neighbours(legs: Mask) -> tuple[list[int], list[int]] | None:
    """Return cities (rows) that together have legs to fewer cities (columns) than they are.

    Hall's theorem, by a matching of the rows with few legs, as only these can be such. None if
    no such cities exist, or too many rows would have to be searched.
    """
    counts = legs.sum(axis=1)
    order = np.argsort(counts, kind="stable")
    enough = np.flatnonzero(counts[order] <= np.arange(len(order)))
    if not len(enough) or enough[-1] >= _MOST_MATCHED:
        return None
    rows = order[: enough[-1] + 1].tolist()
    columns = {row: np.flatnonzero(legs[row]).tolist() for row in rows}
    taken: dict[int, int] = {}

    def assign(row: int, seen: set[int]) -> bool:
        for column in columns[row]:
            if column in seen:
                continue
            seen.add(column)
            if column not in taken or assign(taken[column], seen):
                taken[column] = row
                return True
        return False

    for row in rows:
        seen: set[int] = set()
        if not assign(row, seen):
            return sorted([row, *(taken[column] for column in seen)]), sorted(seen)
    return None
