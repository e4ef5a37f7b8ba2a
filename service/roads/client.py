"""Costs and lines between stops by road, from a routing engine, within bounds of time."""

import asyncio
import hashlib
import logging
import math
from collections import Counter
from collections.abc import Awaitable, Iterable, Mapping, Sequence
from functools import partial
from typing import NamedTuple, TypeVar

import numpy as np

from service.errors import Refusal, RouterTooSlow, RouterUnavailable, RouterUnusable, StreetsTooLong
from service.roads.cache import ArrayCache
from service.roads.osrm import Osrm
from service.roads.questions import Questions
from service.roads.router import Array, Line, RouterInterface, RouterSettings
from service.roads.streets import Indices, Leg, LegLines, count_legs, join_legs
from service.roads.transport import Observe, RouterTransport
from service.roads.valhalla import Valhalla

_DECIMALS = 6  # of a degree, as places are sent to the engine: 0.1 m
_DRAWN_AT_ONCE = 2  # requests for lines at a time, so that those for costs wait for few
_LEG = b"leg"  # before the places of one, in its key
_LOG = logging.getLogger("paretour")
_Result = TypeVar("_Result")


class RoadCosts(NamedTuple):
    """Seconds and metres by road from each stop (row) to each (column), shapes (n, n)."""

    seconds: Array
    metres: Array


class RoadClient:
    """A client of a routing engine, for one event loop, which remembers the answers.

    Args:
        settings: The engine to ask, and what may be spent on it.
        observe: Called with the outcome and the seconds of every question.
    """

    def __init__(self, settings: RouterSettings, observe: Observe = lambda *_: None) -> None:
        self._settings = settings
        self._transport = RouterTransport(settings.url, observe)
        self._cache = ArrayCache(settings.cache_bytes, settings.cache_seconds)
        self._drawing = asyncio.Semaphore(_DRAWN_AT_ONCE)

    async def costs(
        self, locations: Array, ids: Sequence[str], profile: str | None = None
    ) -> RoadCosts:
        """Return the costs between all stops, infinite where the engine knows no way.

        The arrays must not be changed.

        Args:
            locations: Longitude and latitude of each stop in degrees, shape (n, 2).
            ids: Their names, for refusals.
            profile: That of the vehicles that drive them, if they have one.

        Raises:
            OffRoad: Stops lie too far from every road.
            NoRoad: Some stops cannot be reached from the others, or the others from them.
            RouterUnavailable: The engine does not answer.
            RouterUnusable: Its answer is not as documented.
            RouterTooSlow: It takes too many seconds.
        """
        asking = self._remembered(np.round(locations, _DECIMALS), ids, profile)
        return RoadCosts(*await self._in_time(asking, self._settings.seconds))

    async def seconds_at(
        self,
        departures: Sequence[str],
        locations: Array,
        ids: Sequence[str],
        profile: str | None = None,
    ) -> Array:
        """Return the seconds by road between all stops at s times, shape (s, n, n).

        Args:
            departures: The times, as 2026-11-27T07:30. The others are as of `costs`.

        Raises:
            Refusal: As of `costs`.
        """
        places = np.round(locations, _DECIMALS)

        async def each() -> Array:
            asked = (places, ids, profile)
            return np.stack([(await self._remembered(*asked, d))[0] for d in departures])

        return await self._in_time(each(), self._settings.seconds)

    async def lines(
        self,
        locations: Array,
        ids: Sequence[str],
        ways: Sequence[Indices],
        seconds: float = math.inf,
        profiles: Sequence[str | None] = (),
    ) -> list[Line]:
        """Return the line along the streets of each way. Legs of several are asked for once.

        Args:
            locations: The locations of the stops, as for `costs`.
            ways: One at least: indices of stops in the order of their visits, shape (m,) each, m at
                least 2.
            seconds: The remaining time, if it is less than the settings allow.
            profiles: The profile of the vehicle of each way; without any they have none.

        Raises:
            StreetsTooLong: The ways have too many legs, or their lines too many positions.
            Refusal: As of `costs`.
        """
        kinds = list(dict.fromkeys(profiles)) or [None]
        if profiles:  # legs of another profile are between places of their own
            pairs = zip(ways, profiles, strict=True)
            ways = [way + len(ids) * kinds.index(profile) for way, profile in pairs]
        lines = await self._drawn(locations, ids, count_legs(ways), seconds, kinds)
        return await asyncio.to_thread(join_legs, ways, lines)

    async def streets(
        self, locations: Array, ids: Sequence[str], legs: Iterable[Leg]
    ) -> dict[Leg, Line]:
        """Return the line along the streets of each leg; otherwise like `lines`."""
        return await self._drawn(locations, ids, Counter(legs), math.inf, [None])

    async def close(self) -> None:
        """Close the connections to the engine."""
        await self._transport.close()

    async def _remembered(
        self,
        places: Array,
        ids: Sequence[str],
        profile: str | None = None,
        departure: str | None = None,
    ) -> Array:
        """Return both matrices, shape (2, n, n), at a time or at none in particular."""
        way = f"{departure or ''} {profile or ''}".encode()
        key = hashlib.sha256(places.tobytes() + way).digest()
        costs = self._cache.get(key)
        if costs is None:
            questions = self._questions(places, ids, profile, departure)
            await questions.check_snapped(self._settings.snap)
            costs = await questions.costs(self._settings.pairs)
            self._cache.put(key, costs)
        return costs

    async def _drawn(
        self,
        locations: Array,
        ids: Sequence[str],
        counts: Mapping[Leg, int],
        seconds: float,
        profiles: Sequence[str | None],
    ) -> dict[Leg, Line]:
        """Return the line of each leg, given how often each occurs.

        Legs by profile k of vehicles are between the n places k n to k n + n - 1.
        """
        if len(counts) > self._settings.legs:
            raise StreetsTooLong("different legs", self._settings.legs, len(counts))
        places = np.round(locations, _DECIMALS)
        seconds = max(0.0, min(seconds, self._settings.seconds))
        return await self._in_time(self._streets(places, ids, counts, profiles), seconds)

    async def _streets(
        self,
        places: Array,
        ids: Sequence[str],
        counts: Mapping[Leg, int],
        profiles: Sequence[str | None],
    ) -> dict[Leg, Line]:
        """Return the line of each leg, from the cache or from the engine."""
        n = len(places)

        def key_of(leg: Leg) -> bytes:
            profile = profiles[leg[0] // n] or ""
            return _LEG + places[[leg[0] % n, leg[1] % n]].tobytes() + profile.encode()

        keys = {leg: key_of(leg) for leg in counts}
        found = LegLines(counts, self._settings.positions)
        for leg, key in keys.items():
            if (line := self._cache.get(key)) is not None:
                found.add(leg, line)

        def keep(first: int, leg: Leg, line: Line) -> None:
            leg = (first + leg[0], first + leg[1])
            self._cache.put(keys[leg], line)
            found.add(leg, line)

        for number, profile in enumerate(profiles):
            first = number * n
            missing = [(a - first, b - first) for a, b in found.missing if a // n == number]
            if not missing:
                continue
            async with self._drawing:
                questions = self._questions(places, ids, profile)
                await questions.check_snapped(self._settings.snap)
                await questions.streets(missing, self._settings.snap, partial(keep, first))
        return found.lines

    def _questions(
        self,
        places: Array,
        ids: Sequence[str],
        profile: str | None,
        departure: str | None = None,
    ) -> Questions:
        settings = self._settings
        if profile is not None and profile not in settings.profiles:
            raise RouterUnusable(f"it must know the profile {profile!r}")
        own = settings.profile if profile is None else settings.profiles[profile]
        return Questions(_interface(settings, own, departure), self._transport, places, ids)

    async def _in_time(self, answers: Awaitable[_Result], seconds: float) -> _Result:
        """Return answers within a time limit, or log why there are none."""
        try:
            async with asyncio.timeout(seconds):
                return await answers
        except TimeoutError:
            failure: Refusal = RouterTooSlow(seconds)
        except (RouterUnavailable, RouterUnusable) as error:
            failure = error
        # Neither sentence says anything about the stops.
        _LOG.warning("%s", failure)
        raise failure from None


def _interface(settings: RouterSettings, profile: str, departure: str | None) -> RouterInterface:
    if settings.router == "osrm":
        assert departure is None, "OSRM knows no traffic by the hour"
        return Osrm(profile)
    return Valhalla(profile, settings.snap, departure)
