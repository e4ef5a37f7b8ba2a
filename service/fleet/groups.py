"""Groups of stops: those that share a vehicle, those that must not, and those in an order."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, product
from typing import Literal

from service.errors import invalid

GroupRule = Literal["together", "apart", "before"]
Pair = tuple[tuple[int, ...], tuple[int, ...]]


@dataclass(frozen=True, kw_only=True)
class Groups:
    """Groups of stops, by their numbers.

    Args:
        together: The stops of each are visited by one vehicle on one route, or left out together.
        apart: Pairs of groups: no route has a stop of both. Without a second group, no route has
            two stops of the first.
        before: Pairs of groups: on a route that has stops of both, those of the first come before
            those of the second.
        gaps: For each of these pairs, how long after the end of the first visits the second ones
            begin at the earliest, whoever drives; None, or no gap, if only the order on a route
            counts.
    """

    together: tuple[tuple[int, ...], ...] = ()
    apart: tuple[Pair, ...] = ()
    before: tuple[Pair, ...] = ()
    gaps: tuple[float | None, ...] = ()

    def __bool__(self) -> bool:
        """Return whether there are any."""
        return bool(self.together or self.apart or self.before)

    @cached_property
    def mates(self) -> dict[int, frozenset[int]]:
        """The stops that ride with each stop that shares a group, with that stop itself.

        Groups that share a stop are one.
        """
        found: dict[int, frozenset[int]] = {}
        for group in self.together:
            joined = frozenset(group).union(*(found.get(stop, ()) for stop in group))
            found |= dict.fromkeys(joined, joined)
        return found

    @cached_property
    def rivals(self) -> frozenset[tuple[int, int]]:
        """The pairs of stops that no route has both of, in either order."""
        found = set[tuple[int, int]]()
        for stops, others in self.apart:
            found |= {*(product(stops, others) if others else combinations(stops, 2))}
        return frozenset(found | {(b, a) for a, b in found})

    @cached_property
    def ordered(self) -> frozenset[tuple[int, int]]:
        """The pairs of stops of which the first comes first, on a route that has both."""
        return frozenset(pair for first, then in self.before for pair in product(first, then))

    @cached_property
    def waiting(self) -> dict[tuple[int, int], float]:
        """The gaps of the pairs of stops whose second visit waits for the first, whoever drives."""
        found: dict[tuple[int, int], float] = {}
        for (first, then), gap in zip(self.before, self.gaps, strict=False):
            for pair in product(first, then) if gap is not None else ():
                found[pair] = max(gap or 0.0, found.get(pair, 0.0))
        return found

    def broken(self, visited: Sequence[int]) -> Iterator[tuple[GroupRule, int, int]]:
        """Yield each rule that a route breaks, and the two stops that break it."""
        places = {stop: place for place, stop in enumerate(visited)}
        for stop in visited:
            missing = self.mates.get(stop, frozenset()) - places.keys()
            if missing:
                yield "together", stop, min(missing)
        for a, b in combinations(visited, 2) if self.apart or self.before else ():
            if (a, b) in self.rivals:
                yield "apart", a, b
            if (b, a) in self.ordered:
                yield "before", b, a

    def among(self, places: dict[int, int]) -> "Groups":
        """Return the groups among some stops, with the new number of each."""

        def placed(group: tuple[int, ...]) -> tuple[int, ...]:
            return tuple(places[stop] for stop in group if stop in places)

        # A second group of which nothing is left must not become one that was not given.
        apart = ((placed(a), placed(b), bool(b)) for a, b in self.apart)
        return Groups(
            together=tuple(placed(group) for group in self.together),
            apart=tuple((a, b) for a, b, given in apart if bool(b) == given),
            before=tuple((placed(first), placed(then)) for first, then in self.before),
            gaps=self.gaps,
        )


NO_GROUPS = Groups()


def check_groups(groups: Groups, depots: Collection[int], shipped: Collection[int]) -> None:
    """Raise a refusal if a group has a stop that it cannot have, or asks for what cannot be.

    Args:
        depots: The stops at which vehicles start, end or load again.
        shipped: The stops of shipments.
    """
    parts = [
        *((f"together/{i}", group) for i, group in enumerate(groups.together)),
        *((f"apart/{i}", a + b) for i, (a, b) in enumerate(groups.apart)),
        *((f"before/{i}", a + b) for i, (a, b) in enumerate(groups.before)),
    ]
    for part, group in parts:
        for stop in group:
            if stop in depots:
                raise invalid(part, "depot-in-group", stop=stop)
            if stop in shipped:
                raise invalid(part, "shipped-in-group", stop=stop)
    for a, b in sorted(groups.rivals):
        if b in groups.mates.get(a, ()):
            raise invalid("apart", "together-and-apart", stop=a, other=b)


def check_waiting(groups: Groups, *, timed: bool, others: Mapping[str, bool]) -> None:
    """Raise a refusal of visits that wait for others, if they cannot.

    Args:
        others: Members of the request beside which visits cannot wait, and whether they are given.
    """
    gaps = enumerate(groups.gaps)
    part = next((f"before/{index}/vehicles" for index, gap in gaps if gap is not None), None)
    if part is None:
        return
    if not timed:
        raise invalid(part, "untimed")
    for member in (member for member, given in others.items() if given):
        raise invalid(part, "also-given", member=member)
    stop = _in_circle(groups.waiting)
    if stop is not None:
        raise invalid("before", "waits-for-itself", stop=stop)


def _in_circle(pairs: Collection[tuple[int, int]]) -> int | None:
    """Return a stop that waits for itself, maybe by way of others; None if there is none."""
    left = {*pairs}
    while left:
        firsts, thens = {first for first, _ in left}, {then for _, then in left}
        within = {(a, b) for a, b in left if a in thens and b in firsts}
        if len(within) == len(left):
            return min(firsts)
        left = within
    return None
