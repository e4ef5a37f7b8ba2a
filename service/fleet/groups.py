"""Groups of stops: those that share a vehicle, those that must not, and those in an order."""

from collections.abc import Collection, Iterator, Sequence
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
    """

    together: tuple[tuple[int, ...], ...] = ()
    apart: tuple[Pair, ...] = ()
    before: tuple[Pair, ...] = ()

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

        def paired(pairs: tuple[Pair, ...]) -> tuple[Pair, ...]:
            # A second group of which nothing is left must not become one that was not given.
            found = ((placed(a), placed(b), bool(b)) for a, b in pairs)
            return tuple((a, b) for a, b, given in found if bool(b) == given)

        return Groups(
            together=tuple(placed(group) for group in self.together),
            apart=paired(self.apart),
            before=paired(self.before),
        )


NO_GROUPS = Groups()


def check_groups(groups: Groups, depots: Collection[int], shipped: Collection[int]) -> None:
    """Raise a refusal if a group has a stop that it cannot have, or asks for what cannot be.

    Args:
        groups: The groups.
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
