"""Budgets of bytes for the bodies of requests and answers: stalled ones must not fill memory."""

import sys
from collections import Counter

from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from service.errors import Refusal

_SMALL_SHARE = 8  # an eighth of the budget is left to small bodies
_SMALL = 2**17  # bytes
_PART = 2**18  # bytes of an answer that are sent at once


class BodyBudget:
    """A number of bytes for all requests' bodies in progress, or for all answers.

    Bodies of at most 128 KiB are small. A part of the budget of requests is kept for small bodies,
    so that long ones cannot keep them out. Small answers are not counted. A long answer may exceed
    the budget if it is the only one.

    Args:
        limit: Bytes of all bodies.
        share: The share of them that the long bodies of one client may take together. A single
            body may take more.
        answers: Whether the bodies are answers.
    """

    def __init__(self, limit: int, share: float, *, answers: bool = False) -> None:
        self._limit = limit
        self._limit_of_long = limit if answers else limit - limit // _SMALL_SHARE
        self._limit_of_client = int(share * limit)
        self._answers = answers
        self._used_by: Counter[str] = Counter()

    @property
    def used(self) -> int:
        """The bytes that are taken."""
        return self._used_by.total()

    def open(self, client: str = "", count: int = 0, *, always: bool = False) -> "BodyAllowance":
        """Return the allowance of one body, a context that gives its bytes back at its end.

        Args:
            client: The client that sends the body, or gets it.
            count: The bytes to take at once.
            always: Whether to take them even where no room is left.

        Raises:
            Refusal: No room is left.
        """
        return BodyAllowance(self, client, self.take(client, 0, count, always=always))

    def take(self, client: str, held: int, count: int, *, always: bool = False) -> int:
        """Take bytes for a body that holds some already, and return how many it holds then.

        Raises:
            Refusal: No room is left.
        """
        small = count <= _SMALL
        if count <= held or (small and self._answers):
            return held
        others, of_client = self.used - held, self._used_by[client] - held
        limit = self._limit if small else self._limit_of_long
        full = others + count > limit and not (self._answers and not others)
        crowded = not small and of_client and of_client + count > self._limit_of_client
        if (full or crowded) and not always:
            raise Refusal("bodies-full", limit=self._limit)
        self.give_back(client, held - count)
        return count

    def give_back(self, client: str, count: int) -> None:
        """Give bytes of a client back."""
        self._used_by[client] -= count
        if not self._used_by[client]:
            del self._used_by[client]


class BodyAllowance:
    """The bytes that one body takes of a budget."""

    def __init__(self, budget: BodyBudget, client: str, held: int) -> None:
        self._budget = budget
        self._client = client
        self._held = held
        self._came = 0

    def __enter__(self) -> "BodyAllowance":
        return self

    def __exit__(self, *_: object) -> None:
        self._budget.give_back(self._client, self._held)
        self._held = 0

    def hand_over(self) -> "BodyAllowance":
        """Move the bytes of this allowance to a new one, and return that."""
        held, self._held = self._held, 0
        return BodyAllowance(self._budget, self._client, held)

    def until_sent(self, response: Response) -> Response:
        """Return a response as one that gives the bytes back once it is sent."""
        return _CountedResponse(response, self.hand_over())

    def reserve(self, declared: int) -> None:
        """Take the bytes of a body of a declared length before it comes.

        Otherwise many long bodies that come together would each be received in part, and most of
        them refused later.

        Raises:
            Refusal: The budget has fewer left.
        """
        self._held = self._budget.take(self._client, self._held, declared)

    def add(self, chunk: bytes) -> None:
        """Take the bytes of a chunk that has come, unless they are reserved already.

        Raises:
            Refusal: The budget has fewer left.
        """
        self._came += sys.getsizeof(chunk)
        self.reserve(self._came)


class _CountedResponse(Response):
    """A response that is sent in parts, the next once the client has read most of those before."""

    def __init__(self, response: Response, allowance: BodyAllowance) -> None:
        vars(self).update(vars(response))
        self._allowance = allowance

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:  # noqa: ARG002
        """Send the response."""
        start = {"status": self.status_code, "headers": self.raw_headers}
        length = len(self.body)
        with self._allowance:
            await send({"type": "http.response.start", **start})
            for begin in range(0, max(length, 1), _PART):
                part, more = self.body[begin : begin + _PART], begin + _PART < length
                await send({"type": "http.response.body", "body": part, "more_body": more})
