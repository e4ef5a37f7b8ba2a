"""Join the legs of tours to trails, so that few questions ask for the streets of all legs."""

from collections.abc import Iterable

Leg = tuple[int, int]  # from one stop to another


def trails(legs: Iterable[Leg], most: int) -> list[list[int]]:
    """Return sequences of stops, of bounded length, that go along every leg once.

    Args:
        legs: Each from one stop to another; repeats count once.
        most: At least 2.

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
