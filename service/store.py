"""Fronts kept in memory for later questions, bounded in number and age."""

import time
from collections import OrderedDict
from collections.abc import Callable
from typing import Generic, TypeVar

T = TypeVar("T")


class Unknown(LookupError):
    """Nothing was ever kept under this key, or so long ago that it is forgotten."""


class Expired(LookupError):
    """What was kept under this key has made way: it was too old, or the store was full."""


class Store(Generic[T]):
    """At most `entries` values, none older than `max_age` seconds; the oldest makes way.

    Of what has made way it remembers the last `tombstones` keys. Not for use by several threads
    at once: everything happens on the event loop.
    """

    def __init__(
        self,
        entries: int,
        max_age: float,
        tombstones: int = 10_000,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._entries = entries
        self._max_age = max_age
        self._tombstones = tombstones
        self._clock = clock
        self._kept: OrderedDict[str, tuple[float, T]] = OrderedDict()
        self._gone: OrderedDict[str, None] = OrderedDict()

    def put(self, key: str, value: T) -> None:
        """Keep a value under a key that has not been used before."""
        self._kept[key] = (self._clock(), value)
        self._forget()

    def get(self, key: str) -> T:
        """The value under the key.

        Raises:
            Unknown: nothing was kept under it.
            Expired: it has made way.
        """
        self._forget()
        if key in self._kept:
            return self._kept[key][1]
        raise Expired(key) if key in self._gone else Unknown(key)

    def latest(self) -> T:
        """The value put last.

        Raises:
            Unknown: there never was one.
            Expired: it has made way.
        """
        self._forget()
        if self._kept:
            return next(reversed(self._kept.values()))[1]
        raise Expired if self._gone else Unknown

    def _forget(self) -> None:
        oldest_allowed = self._clock() - self._max_age
        while self._kept and (
            len(self._kept) > self._entries or next(iter(self._kept.values()))[0] < oldest_allowed
        ):
            key, _ = self._kept.popitem(last=False)
            self._gone[key] = None
        while len(self._gone) > self._tombstones:
            self._gone.popitem(last=False)
