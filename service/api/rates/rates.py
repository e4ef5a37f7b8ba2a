"""The rate of each caller with a key and of each address, and the refusal of what goes beyond."""

import logging
import math
import time
from importlib.util import find_spec
from typing import Protocol

from limits import RateLimitItem, parse
from limits.aio.storage import RedisStorage
from limits.aio.strategies import (
    MovingWindowRateLimiter,
    RateLimiter,
    SlidingWindowCounterRateLimiter,
)
from limits.errors import StorageError

from service.api.rates.windows import MovingWindow, SlidingWindow
from service.api.transport.addresses import network_of
from service.errors import Refusal

_REDIS_SECONDS = 0.5  # that a request waits for Redis at most
_LOG = logging.getLogger("paretour")


class Window(Protocol):
    """Counts the requests of each caller in a time."""

    async def hit(self, caller: str) -> float | None:
        """Count a request, and return None; or return in how many seconds the next one may come.

        Raises:
            StorageError: The counts cannot be reached.
        """


class Rates:
    """A limit on the requests of each caller, in the notation of the package `limits`: 9/second.

    Requests are counted in memory, or in Redis for all replicas together. Where Redis does not
    answer, every request passes: a rate is a protection, and must not be an outage.

    Raises:
        ValueError: The extra for Redis is not installed.
    """

    def __init__(self, rate: str, redis_url: str | None = None) -> None:
        self._rate = parse(rate)
        # Two numbers for each address: there may be very many.
        self._callers: Window
        self._addresses: Window
        if redis_url is None:
            amount, seconds = self._rate.amount, self._rate.get_expiry()
            self._callers = MovingWindow(amount, seconds)
            self._addresses = SlidingWindow(amount, seconds)
        else:
            storage = _redis_storage(redis_url)
            self._callers = _InRedis(MovingWindowRateLimiter(storage), self._rate)
            self._addresses = _InRedis(SlidingWindowCounterRateLimiter(storage), self._rate)

    async def check(self, caller: str) -> None:
        """Count a request of a caller with a key, and raise a refusal where there were too many.

        Raises:
            Refusal: The caller is over its rate.
        """
        await self._check(self._callers, caller)

    async def check_address(self, address: str) -> None:
        """Count a request from an address, and raise a refusal where there were too many.

        Raises:
            Refusal: The address is over its rate.
        """
        await self._check(self._addresses, network_of(address))

    async def _check(self, window: Window, caller: str) -> None:
        try:
            seconds = await window.hit(caller)
        except StorageError:
            _LOG.warning("rates are not counted: Redis does not answer")
            return
        if seconds is None:
            return
        wait = max(1, math.ceil(seconds))
        raise Refusal(
            "rate-limited",
            rate=self._rate,
            caller=caller,
            wait=wait,
            limit=self._rate.amount,
            headers={"Retry-After": str(wait)},
        )


class _InRedis:
    """A window of the package `limits`, whose counts are in Redis."""

    def __init__(self, limiter: RateLimiter, rate: RateLimitItem) -> None:
        self._limiter = limiter
        self._rate = rate

    async def hit(self, caller: str) -> float | None:
        """Count a request, and return None; or return in how many seconds the next one may come."""
        if await self._limiter.hit(self._rate, caller):
            return None
        window = await self._limiter.get_window_stats(self._rate, caller)
        return window.reset_time - time.time()


def _redis_storage(redis_url: str) -> RedisStorage:
    if find_spec("redis") is None:
        raise ValueError("PARETOUR_REDIS_URL needs the extra paretour[cluster]")
    return RedisStorage(
        f"async+{redis_url}",
        wrap_exceptions=True,
        implementation="redispy",
        socket_connect_timeout=_REDIS_SECONDS,
        socket_timeout=_REDIS_SECONDS,
    )
