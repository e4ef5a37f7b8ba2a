"""A budget of bytes for all request bodies under way, so that stalled uploads fill no memory."""

import sys
from collections import Counter
from dataclasses import dataclass, field

from service.api.task_parser import ParserBounds
from service.errors import Refusal

_SMALL_SHARE = 8  # one part of so many is left to small bodies
_SMALL = 2**17  # bytes


@dataclass(frozen=True, kw_only=True)
class BodyBounds:
    """What the bodies of all requests may take together.

    Args:
        under_way: Bytes of all bodies under way.
        share: The share of these that the long bodies of one client may take.
        parser: The bounds of a process that parses.
    """

    under_way: int = 2**27
    share: float = 0.5
    parser: ParserBounds = field(default_factory=ParserBounds)


class BodyBudget:
    """So many bytes for the bodies that are being received, parsed and planned for a caller.

    A part of it is left to bodies of at most 128 KiB, so that long ones do not keep them out.

    Args:
        limit: Bytes of all bodies.
        share: The share of them that the long bodies of one client may take; one alone may take
            more.
    """

    def __init__(self, limit: int, share: float) -> None:
        self._limit = limit
        self._limit_of_long = limit - limit // _SMALL_SHARE
        self._limit_of_client = int(share * limit)
        self._used = 0
        self._used_by: Counter[str] = Counter()

    @property
    def used(self) -> int:
        """The bytes that are taken."""
        return self._used

    def open(self, client: str = "") -> "BodyAllowance":
        """Return the allowance of one request, a context that gives its bytes back at its end."""
        return BodyAllowance(self, client)

    def take(self, client: str, count: int, held: int) -> None:
        """Take bytes for a body of a client, which holds some already.

        Raises:
            Refusal: They are not there.
        """
        if held + count <= _SMALL:
            room = self._limit - self._used
        else:
            room = min(self._limit_of_long - self._used, self._room_of(client, held))
        if count > room:
            raise Refusal("bodies-full", limit=self._limit)
        self._used += count
        self._used_by[client] += count

    def give_back(self, client: str, count: int) -> None:
        """Give bytes of a client back."""
        self._used -= count
        self._used_by[client] -= count
        if not self._used_by[client]:
            del self._used_by[client]

    def _room_of(self, client: str, held: int) -> int:
        """Return how many bytes more a client may take for a long body, which holds some."""
        used = self._used_by[client]
        return self._limit if used == held else self._limit_of_client - used


class BodyAllowance:
    """The bytes that the body of one request takes of a budget."""

    def __init__(self, budget: BodyBudget, client: str) -> None:
        self._budget = budget
        self._client = client
        self._held = 0
        self._came = 0

    def __enter__(self) -> "BodyAllowance":
        return self

    def __exit__(self, *_: object) -> None:
        self._budget.give_back(self._client, self._held)
        self._held = 0

    def reserve(self, declared: int) -> None:
        """Take the bytes of a body of a declared length before it comes.

        Else of many long bodies that come together each would be received in part, and most then
        refused.

        Raises:
            Refusal: They are not there.
        """
        self._take(declared)

    def add(self, chunk: bytes) -> None:
        """Take what it takes to hold a chunk that has come, beyond what is reserved.

        Raises:
            Refusal: It is not there.
        """
        self._came += sys.getsizeof(chunk)
        self._take(self._came)

    def _take(self, whole: int) -> None:
        missing = whole - self._held
        if missing > 0:
            self._budget.take(self._client, missing, self._held)
            self._held = whole
