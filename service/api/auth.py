"""Authentication by API keys, and a rate limit for each caller.

Without keys everybody may call, and all are one caller: anyone who knows the id of a front can read
it. Each address then has its own rate and its own latest front.
"""

import logging
import math
import time
from collections.abc import Iterable
from dataclasses import dataclass
from hmac import compare_digest
from importlib.util import find_spec

from fastapi import Depends, Security
from fastapi.params import Depends as Dependency
from fastapi.security import HTTPBearer
from limits import RateLimitItem, parse
from limits.aio.storage import MemoryStorage, RedisStorage
from limits.aio.strategies import MovingWindowRateLimiter, SlidingWindowCounterRateLimiter
from limits.errors import StorageError
from starlette.requests import Request

from service.api.keys import KeyHash, digest_of
from service.api.middleware import ANONYMOUS, ANSWER_HEADERS, RawHeaders
from service.api.transport.connections import network_of
from service.api.transport.proxies import HIDDEN
from service.errors import Refusal

_REDIS_SECONDS = 0.5  # the longest that a request waits for Redis
_POLICY = "default"  # the name of the one policy that there is
_LOG = logging.getLogger("paretour")
_BEARER = HTTPBearer(auto_error=False, scheme_name="key", description="an API key")


@dataclass(frozen=True, kw_only=True)
class Quota:
    """The requests that a client's rate still allows.

    Attributes:
        remaining: The requests that it may make at once.
        seconds: The time until it may make more.
        allowed: Whether the request that was counted last was within the rate.
    """

    remaining: int
    seconds: int
    allowed: bool


class Rates:
    """A limit on the requests of each caller, in the notation of the package `limits`: 9/second.

    Requests are counted in memory, or in Redis for all replicas together. Where Redis does not
    answer, every request passes: an outage of Redis must not become one of the service.

    Raises:
        ValueError: The extra for Redis is not installed.
    """

    def __init__(self, rate: str, redis_url: str | None = None) -> None:
        self._rate: RateLimitItem = parse(rate)
        storage = _storage(redis_url)
        self._callers = MovingWindowRateLimiter(storage)
        # Keeps only two numbers for each address, because there may be very many.
        self._addresses = SlidingWindowCounterRateLimiter(storage)

    async def count(self, client: str, *, keyed: bool) -> Quota | None:
        """Count a request of a caller with a key, or of an address without one.

        Returns:
            What is left; None where Redis does not answer.
        """
        limiter = self._callers if keyed else self._addresses
        try:
            allowed = await limiter.hit(self._rate, client)
            window = await limiter.get_window_stats(self._rate, client)
        except StorageError:
            _LOG.warning("rates are not counted: Redis does not answer")
            return None
        # Others may have used what was left in between, and less than a second is still one.
        remaining = max(0, window.remaining) if allowed else 0
        seconds = max(1, math.ceil(window.reset_time - time.time()))
        return Quota(remaining=remaining, seconds=seconds, allowed=allowed)

    def headers(self, quota: Quota) -> RawHeaders:
        """Return the headers that tell a client its rate and what is left of it.

        They are those of draft-ietf-httpapi-ratelimit-headers: lists of RFC 9651.
        """
        policy = f'"{_POLICY}";q={self._rate.amount};w={self._rate.get_expiry()}'
        left = f'"{_POLICY}";r={quota.remaining};t={quota.seconds}'
        return [(b"ratelimit-policy", policy.encode()), (b"ratelimit", left.encode())]

    def refusal(self, client: str, quota: Quota) -> Refusal:
        """Return the refusal of a request that is over the rate."""
        return Refusal(
            "rate-limited",
            rate=self._rate,
            caller=client,
            wait=quota.seconds,
            limit=self._rate.amount,
            headers={"Retry-After": str(quota.seconds)},
        )


def caller_of(request: Request) -> str:
    """Return the name of the caller; all callers without a key share one name."""
    return str(request.scope["caller"])


def client_of(request: Request) -> str:
    """Return the client whose places in the queue are counted.

    It is the caller or, without keys, the address. An IPv6 address counts as its network of
    64 bits, because one client may have all of it.
    """
    if request.scope["caller"] != ANONYMOUS:
        return caller_of(request)
    return network_of(request.client.host if request.client else "")


def owner_of(request: Request) -> str:
    """Return the client whose latest front, and whose list of fronts, a request may ask for.

    It is that of `client_of`, unless that is the address of a proxy, which many clients share.

    Raises:
        Refusal: The request has no key, and a proxy that is not trusted hides its address.
    """
    if request.scope["caller"] == ANONYMOUS and request.scope.get(HIDDEN):
        raise Refusal("hidden-client")
    return client_of(request)


class Access:
    """Authenticates the callers of guarded routes, and limits the rate of each."""

    def __init__(self, keys: Iterable[KeyHash] = (), rates: Rates | None = None) -> None:
        self._keys = tuple(keys)
        self._rates = rates

    @property
    def dependencies(self) -> list[Dependency]:
        """The dependencies of a guarded router; with keys, its OpenAPI document asks for one."""
        admitted = [Depends(self.admit)] if self._keys or self._rates is not None else []
        return [*admitted, *([Security(_BEARER)] if self._keys else [])]

    async def admit(self, request: Request) -> None:
        """Write the caller into the request's scope, and count its request.

        Raises:
            Refusal: The key is unknown, or the caller or the address is over the rate.
        """
        if self._keys:
            request.scope["caller"] = self._caller(request)
        if self._rates is not None:
            await self._count(self._rates, request)

    async def _count(self, rates: Rates, request: Request) -> None:
        client = client_of(request)
        quota = await rates.count(client, keyed=bool(self._keys))
        if quota is None:
            return
        request.scope[ANSWER_HEADERS].extend(rates.headers(quota))
        if not quota.allowed:
            raise rates.refusal(client, quota)

    def _caller(self, request: Request) -> str:
        scheme, _, key = request.headers.get("authorization", "").partition(" ")
        if scheme.lower() != "bearer":
            raise _unauthorized("an API key is needed, as Authorization: Bearer KEY, and none came")
        digest = digest_of(key.strip())
        # All hashes are compared, so that the time taken does not tell how near a guess was.
        matches = [hash_.caller for hash_ in self._keys if compare_digest(hash_.digest, digest)]
        if not matches:
            raise _unauthorized("this service does not know that API key")
        return matches[0]


def _storage(redis_url: str | None) -> MemoryStorage | RedisStorage:
    if redis_url is None:
        return MemoryStorage()
    if find_spec("redis") is None:
        raise ValueError("PARETOUR_REDIS_URL needs the extra paretour[cluster]")
    return RedisStorage(
        f"async+{redis_url}",
        wrap_exceptions=True,
        implementation="redispy",
        socket_connect_timeout=_REDIS_SECONDS,
        socket_timeout=_REDIS_SECONDS,
    )


def _unauthorized(reason: str) -> Refusal:
    return Refusal("unauthorized", reason=reason, headers={"WWW-Authenticate": "Bearer"})
