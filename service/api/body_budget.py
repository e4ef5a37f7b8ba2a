"""A budget of bytes for all request bodies under way, so that stalled uploads fill no memory."""

import sys

from service.errors import Refusal

DEFAULT_BUDGET = 2**27  # bytes
_SMALL_SHARE = 8  # one part of so many is left to small bodies
_SMALL = 2**17  # bytes


class BodyBudget:
    """So many bytes for the bodies that are being received, parsed and planned for a caller.

    A part of it is left to bodies of at most 128 KiB, so that long ones do not keep them out.
    """

    def __init__(self, limit: int = DEFAULT_BUDGET) -> None:
        self._limit = limit
        self._limit_of_long = limit - limit // _SMALL_SHARE
        self._used = 0

    @property
    def used(self) -> int:
        """The bytes that are taken."""
        return self._used

    def open(self) -> "BodyAllowance":
        """Return the allowance of one request, a context that gives its bytes back at its end."""
        return BodyAllowance(self)

    def take(self, count: int, held: int) -> None:
        """Take bytes for a body that holds some already.

        Raises:
            Refusal: They are not there.
        """
        limit = self._limit if held + count <= _SMALL else self._limit_of_long
        if self._used + count > limit:
            raise Refusal("bodies-full", limit=self._limit)
        self._used += count

    def give_back(self, count: int) -> None:
        """Give bytes back."""
        self._used -= count


class BodyAllowance:
    """The bytes that the body of one request takes of a budget."""

    def __init__(self, budget: BodyBudget) -> None:
        self._budget = budget
        self._held = 0

    def __enter__(self) -> "BodyAllowance":
        return self

    def __exit__(self, *_: object) -> None:
        self._budget.give_back(self._held)
        self._held = 0

    def check(self, declared: int) -> None:
        """Raise a refusal where a body of a declared length would not fit now.

        Raises:
            Refusal: It would not.
        """
        self._budget.take(declared, 0)
        self._budget.give_back(declared)

    def add(self, chunk: bytes) -> None:
        """Take the bytes of a chunk that has come, with what it takes to hold it.

        Raises:
            Refusal: They are not there.
        """
        count = sys.getsizeof(chunk)
        self._budget.take(count, self._held)
        self._held += count
