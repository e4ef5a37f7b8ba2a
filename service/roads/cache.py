"""A cache of arrays in memory, bounded in bytes and in age."""

import time
from collections import OrderedDict
from collections.abc import Callable

from service.roads.router import Array

BYTES_OF_ENTRY = 512  # of an array, its key and its entry, in addition to its numbers


class ArrayCache:
    """Arrays by their keys; when no room is left, the least recently used is dropped.

    Args:
        most_bytes: The most bytes of all arrays together.
        most_seconds: How long each is kept.
        clock: The present time in seconds.
    """

    def __init__(
        self, most_bytes: int, most_seconds: float, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._most_bytes = most_bytes
        self._most_seconds = most_seconds
        self._clock = clock
        self._bytes = 0
        self._entries: OrderedDict[bytes, tuple[float, Array]] = OrderedDict()

    def get(self, key: bytes) -> Array | None:
        """Return the array of a key, None if it is missing or too old."""
        if key not in self._entries:
            return None
        put_at, array = self._entries[key]
        if self._clock() - put_at > self._most_seconds:
            self._drop(key)
            return None
        self._entries.move_to_end(key)
        return array

    def put(self, key: bytes, array: Array) -> None:
        """Keep an array, unless it alone is too large. It must not be changed any more."""
        if key in self._entries:
            self._drop(key)
        if _size(array) > self._most_bytes:
            return
        self._entries[key] = self._clock(), array
        self._bytes += _size(array)
        while self._bytes > self._most_bytes:
            self._drop(next(iter(self._entries)))

    def _drop(self, key: bytes) -> None:
        _, array = self._entries.pop(key)
        self._bytes -= _size(array)


def _size(array: Array) -> int:
    return array.nbytes + BYTES_OF_ENTRY
