"""Costs and streets between stops by road, from a routing engine, within bounds of time."""

import asyncio
import hashlib
import logging
from collections.abc import Awaitable, Iterable, Sequence
from typing import NamedTuple, TypeVar

import numpy as np

from service.errors import Refusal, RouterTooSlow, RouterUnavailable, RouterUnusable
from service.roads.cache import MatrixCache
from service.roads.osrm import Osrm
from service.roads.questions import Questions
from service.roads.router import Array, Line, RouterInterface, RouterSettings
from service.roads.trails import Leg
from service.roads.transport import Observe, RouterTransport
from service.roads.valhalla import Valhalla

_DECIMALS = 6  # of a degree that the engine is told: 0.1 m
_LOG = logging.getLogger("paretour")
_Result = TypeVar("_Result")


class RoadCosts(NamedTuple):
    """Seconds and metres by road from each stop (row) to each (column), shapes (n, n)."""

    seconds: Array
    metres: Array


class RoadClient:
    """A client of a routing engine, for one event loop, which remembers the matrices it was told.

    Args:
        settings: Which engine to ask, and what may be spent on it.
        observe: Called with the outcome and the seconds of every question.
    """

    def __init__(self, settings: RouterSettings, observe: Observe = lambda *_: None) -> None:
        self._settings = settings
        self._router = _interface(settings)
        self._transport = RouterTransport(settings.url, observe)
        self._cache = MatrixCache(settings.cache_bytes, settings.cache_seconds)

    async def costs(self, locations: Array, ids: Sequence[str]) -> RoadCosts:
        """Return the costs between all stops. The arrays must not be changed.

        Args:
            locations: Longitude and latitude of each stop in degrees, shape (n, 2).
            ids: Their names, for refusals.

        Raises:
            OffRoad: Stops lie too far from every road.
            NoRoad: There is no way between some stops.
            RouterUnavailable: The engine does not answer.
            RouterUnusable: It answers something else than it should.
            RouterTooSlow: It takes longer than the seconds.
        """
        places = np.round(locations, _DECIMALS)
        key = hashlib.sha256(places.tobytes()).digest()
        costs = self._cache.get(key)
        if costs is None:
            costs = await self._in_time(self._asked(places, ids))
            self._cache.put(key, costs)
        return RoadCosts(*costs)

    async def streets(
        self, locations: Array, ids: Sequence[str], legs: Iterable[Leg]
    ) -> dict[Leg, Line]:
        """Return the line along the streets of each leg, a pair of indices of stops.

        The other arguments and the exceptions are those of `costs`, except OffRoad.
        """
        return await self._in_time(self._questions(locations, ids).streets(legs))

    async def close(self) -> None:
        """Close the connections to the engine."""
        await self._transport.close()

    async def _asked(self, places: Array, ids: Sequence[str]) -> Array:
        """Return both matrices, shape (2, n, n), as the engine answers now."""
        questions = self._questions(places, ids)
        await questions.check_snapped(self._settings.snap)
        return await questions.costs(self._settings.pairs)

    def _questions(self, locations: Array, ids: Sequence[str]) -> Questions:
        return Questions(self._router, self._transport, np.round(locations, _DECIMALS), ids)

    async def _in_time(self, answers: Awaitable[_Result]) -> _Result:
        """Return answers within the time of the settings, or log why there are none."""
        try:
            async with asyncio.timeout(self._settings.seconds):
                return await answers
        except TimeoutError:
            failure: Refusal = RouterTooSlow(self._settings.seconds)
        except (RouterUnavailable, RouterUnusable) as error:
            failure = error
        # Neither sentence has anything of the stops.
        _LOG.warning("%s", failure)
        raise failure from None


def _interface(settings: RouterSettings) -> RouterInterface:
    if settings.router == "osrm":
        return Osrm(settings.profile)
    return Valhalla(settings.profile, settings.snap)
