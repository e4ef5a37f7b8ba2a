"""Ask a routing engine all that one request needs, and put its answers together."""

from asyncio import TaskGroup, to_thread
from collections.abc import Awaitable, Callable, Iterable, Iterator, Sequence
from itertools import pairwise
from math import ceil, isqrt
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from service.errors import NoRoad, OffRoad, RouterUnusable
from service.roads.great_circle import great_circle_distances
from service.roads.reachability import MissingWay, missing_ways, ways_of_isolated
from service.roads.router import Array, Line, Location, NoWay, RouterInterface, Unintelligible
from service.roads.streets import Leg, trails
from service.roads.transport import AT_ONCE, RouterTransport

_PLACES_AT_ONCE = 100  # places in one question about the nearest roads
_MOST_REFUSED = 32  # pairs that are found one by one, each by a dozen questions
_Item = TypeVar("_Item")
_Result = TypeVar("_Result")
_Indices = NDArray[np.int64]


class Questions:
    """The questions about the places of one request, shape (n, 2), and their answers."""

    def __init__(
        self,
        router: RouterInterface,
        transport: RouterTransport,
        places: Array,
        ids: Sequence[str],
    ) -> None:
        self._router = router
        self._transport = transport
        self._places: list[Location] = [(lon, lat) for lon, lat in places.tolist()]
        self._ids = ids
        n = len(places)
        self._costs = np.full((2, n, n), np.nan)
        self._refused = np.zeros((n, n), np.bool_)

    async def check_snapped(self, snap: float) -> None:
        """Raise OffRoad if stops lie too many metres from every road."""
        parts = _parts(len(self._places), _PLACES_AT_ONCE)
        distances = [await self._snapped(part) for part in parts]
        off = np.flatnonzero(np.concatenate(distances) > snap).tolist()
        if off:
            raise OffRoad([(i, self._ids[i]) for i in off], snap)

    async def costs(self, pairs: int) -> Array:
        """Return both matrices, shape (2, n, n), asked for in blocks of a bounded number of pairs.

        An infinite entry says that no road leads there.

        Raises:
            NoRoad: Some stops cannot be reached from the others, or the others from them; or
                the engine refuses too many pairs one by one.
        """
        parts = _parts(len(self._places), isqrt(pairs))
        blocks = ((sources, targets) for sources in parts for targets in parts)
        await _for_each(blocks, self._fill)
        for costs in self._costs:
            np.fill_diagonal(costs, 0.0)
        if ways := ways_of_isolated(np.isinf(self._costs[0])):
            raise self._no_road(ways)
        self._costs.setflags(write=False)
        return self._costs

    async def streets(
        self, legs: Iterable[Leg], snap: float, keep: Callable[[Leg, Line], None]
    ) -> None:
        """Find the line along the streets of each leg, of stops that `check_snapped` let pass.

        Args:
            legs: Each from one stop to another.
            snap: The metres that a stop may lie from a road, as for `check_snapped`.
            keep: Called with each leg and its line, which is not empty, as they come.

        Raises:
            NoRoad: The engine finds no road for a leg.
            RouterUnusable: Some line does not lead from stop to stop.
        """

        async def follow(trail: list[int]) -> None:
            lines = await self._route(trail)
            self._check_ends(trail, lines, snap)
            for leg, line in zip(pairwise(trail), lines, strict=True):
                keep(leg, line)

        await _for_each(trails(legs, self._router.most_route_stops), follow)

    async def _fill(self, block: tuple[_Indices, _Indices]) -> None:
        sources, targets = block
        self._costs[:, sources[:, np.newaxis], targets] = await self._table(sources, targets)

    async def _route(self, trail: list[int]) -> list[Line]:
        """Return the line of each leg of a trail; if the engine has none, ask for its halves."""
        answer = await self._transport.ask(self._router.ask_route(self._places_of(trail)))
        try:
            # In a thread, because it may consist of tens of thousands of small lines.
            return await to_thread(
                _understood, lambda: self._router.read_route(answer, len(trail) - 1)
            )
        except NoWay:
            if len(trail) == 2:
                raise self._no_road([MissingWay(trail[0], trail[1], trail[0])]) from None
        middle = len(trail) // 2
        return [*await self._route(trail[: middle + 1]), *await self._route(trail[middle:])]

    def _check_ends(self, trail: Sequence[int], lines: Sequence[Line], snap: float) -> None:
        """Raise RouterUnusable unless each line begins and ends near its stops."""
        if not all(map(len, lines)):
            raise RouterUnusable("a line must have places")
        places = np.array(self._places_of(trail))
        for stops, end in ((places[:-1], 0), (places[1:], -1)):
            ends = np.array([line[end] for line in lines])
            # A table and a route may choose different roads of those near a stop.
            if (great_circle_distances(stops, ends) > 2 * snap).any():
                raise RouterUnusable("a line must begin and end at its stops")

    async def _snapped(self, part: _Indices) -> Array:
        """Return the metres from places to the nearest road, infinity where there is none."""
        places = self._places_of(part.tolist())
        answer = await self._transport.ask(self._router.ask_snapped(places))
        try:
            return _understood(lambda: self._router.read_snapped(answer, places))
        except NoWay:
            if len(part) == 1:
                return np.array([np.inf])
        return np.concatenate([await self._snapped(half) for half in np.array_split(part, 2)])

    async def _table(self, sources: _Indices, targets: _Indices) -> Array:
        """Return the costs of a block, shape (2, sources, targets).

        If the engine refuses the whole block, it is asked for halves of it, until the stops without
        a way are found.
        """
        places = self._places_of(sources.tolist()), self._places_of(targets.tolist())
        answer = await self._transport.ask(self._router.ask_table(*places))
        shape = len(sources), len(targets)
        try:
            return _understood(lambda: self._router.read_table(answer, shape))
        except NoWay:
            if shape == (1, 1):
                origin, destination = int(sources[0]), int(targets[0])
                if origin == destination:
                    return np.zeros((2, 1, 1))
                self._refuse(origin, destination)
                return np.full((2, 1, 1), np.inf)
        if shape[0] >= shape[1]:
            halves = [await self._table(half, targets) for half in np.array_split(sources, 2)]
            return np.concatenate(halves, axis=1)
        halves = [await self._table(sources, half) for half in np.array_split(targets, 2)]
        return np.concatenate(halves, axis=2)

    def _refuse(self, origin: int, destination: int) -> None:
        """Remember a pair that the engine refuses; if they are too many, raise NoRoad."""
        self._refused[origin, destination] = True
        if np.count_nonzero(self._refused) > _MOST_REFUSED:
            raise self._no_road(missing_ways(self._refused))

    def _places_of(self, indices: Sequence[int]) -> list[Location]:
        return [self._places[i] for i in indices]

    def _no_road(self, ways: list[MissingWay]) -> NoRoad:
        ids = self._ids
        return NoRoad([(way.blamed, ids[way.origin], ids[way.destination]) for way in ways])


async def _for_each(items: Iterable[_Item], do: Callable[[_Item], Awaitable[None]]) -> None:
    """Call a function with each item, a few at once. The first error ends all calls."""
    left: Iterator[_Item] = iter(items)

    async def work() -> None:
        for item in left:
            await do(item)

    try:
        async with TaskGroup() as group:
            for _ in range(AT_ONCE):
                group.create_task(work())
    except BaseExceptionGroup as errors:
        raise errors.exceptions[0] from None


def _parts(n: int, most: int) -> list[_Indices]:
    """Return the indices 0 to n - 1 in parts of about equal, bounded size."""
    return np.array_split(np.arange(n), ceil(n / most))


def _understood(read: Callable[[], _Result]) -> _Result:
    """Return the result of reading an answer; raise RouterUnusable if it cannot be read."""
    try:
        return read()
    except Unintelligible as error:
        raise RouterUnusable(str(error)) from None
