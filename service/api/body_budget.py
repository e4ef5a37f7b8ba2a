"""Budgets of bytes for the bodies of requests and answers, so that stalled ones fill no memory."""

import sys
from collections import Counter
from dataclasses import dataclass, field

from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from service.api.task_parser import ParserBounds
from service.errors import Refusal

_SMALL_SHARE = 8  # an eighth of the budget is left to small bodies
_SMALL = 2**17  # bytes
_PART = 2**18  # bytes of an answer that are sent at once


@dataclass(frozen=True, kw_only=True)
class BodyBounds:
    """The bytes that the bodies of all requests may take together, and those of all answers.

    Args:
        under_way: Bytes of all bodies of requests in progress; as many for answers.
        share: The share of these that the long bodies of one client may take.
        parser: The bounds of a process that parses.
    """

    under_way: int = 2**27
    share: float = 0.5
    parser: ParserBounds = field(default_factory=ParserBounds)


class BodyBudget:
    """A number of bytes for all request bodies that are being received, parsed or planned.

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
        """Take more bytes for a body of a client, which holds some already.

        Raises:
            Refusal: The budget has fewer left.
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
        """Return how many more bytes a client may take for a long body that holds some already."""
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

    def hand_over(self) -> "BodyAllowance":
        """Move the bytes of this allowance to a new one, and return that."""
        other = BodyAllowance(self._budget, self._client)
        other._held, self._held = self._held, 0
        return other

    def reserve(self, declared: int) -> None:
        """Take the bytes of a body of a declared length before it comes.

        Otherwise many long bodies that come together would each be received in part, and most of
        them refused later.

        Raises:
            Refusal: The budget has fewer left.
        """
        self._take(declared)

    def add(self, chunk: bytes) -> None:
        """Take the bytes of a chunk that has come, as far as they go beyond those reserved.

        Raises:
            Refusal: The budget has fewer left.
        """
        self._came += sys.getsizeof(chunk)
        self._take(self._came)

    def _take(self, whole: int) -> None:
        missing = whole - self._held
        if missing > 0:
            self._budget.take(self._client, missing, self._held)
            self._held = whole


class AnswerBudget:
    """A number of bytes for all long answers that are being made and sent.

    Answers of at most 128 KiB are not counted. A long answer may exceed the budget if it is the
    only one.

    Args:
        limit: Bytes of all long answers.
        share: The share of them that the answers of one client may take. A single answer may take
            more.
    """

    def __init__(self, limit: int, share: float) -> None:
        self._limit = limit
        self._limit_of_client = int(share * limit)
        self._used = 0
        self._used_by: Counter[str] = Counter()

    @property
    def used(self) -> int:
        """The bytes that are taken."""
        return self._used

    def open(self, client: str, count: int, *, always: bool = False) -> "AnswerAllowance":
        """Return the allowance of an answer, a context that gives its bytes back at its end.

        Args:
            client: The client that gets the answer.
            count: Its bytes.
            always: Whether to admit it even where there is no room.

        Raises:
            Refusal: There is no room.
        """
        count = count if count > _SMALL else 0
        total, own = self._used, self._used_by[client]
        full = (total and total + count > self._limit) or (
            own and own + count > self._limit_of_client
        )
        if count and full and not always:
            raise Refusal("bodies-full", limit=self._limit)
        self._add(client, count)
        return AnswerAllowance(self, client, count)

    def give_back(self, client: str, count: int) -> None:
        """Give bytes of a client back."""
        self._add(client, -count)

    def _add(self, client: str, count: int) -> None:
        self._used += count
        self._used_by[client] += count
        if not self._used_by[client]:
            del self._used_by[client]


class AnswerAllowance:
    """The bytes of one answer, until it is sent, or until the block ends without an answer."""

    def __init__(self, budget: AnswerBudget, client: str, count: int) -> None:
        self._budget = budget
        self._client = client
        self._held = count
        self._handed_over = False

    def __enter__(self) -> "AnswerAllowance":
        return self

    def __exit__(self, *_: object) -> None:
        if not self._handed_over:
            self.close()

    def until_sent(self, response: Response) -> Response:
        """Return a response as one that gives the bytes back once it is sent."""
        self._handed_over = True
        return _CountedResponse(response, self)

    def close(self) -> None:
        """Give the bytes back."""
        self._budget.give_back(self._client, self._held)
        self._held = 0


class _CountedResponse(Response):
    """A response that is sent in parts, the next once the client has read most of those before."""

    def __init__(self, response: Response, allowance: AnswerAllowance) -> None:
        vars(self).update(vars(response))
        self._allowance = allowance

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:  # noqa: ARG002
        """Send the response."""
        start = {"status": self.status_code, "headers": self.raw_headers}
        length = len(self.body)
        try:
            await send({"type": "http.response.start", **start})
            for begin in range(0, max(length, 1), _PART):
                part, more = self.body[begin : begin + _PART], begin + _PART < length
                await send({"type": "http.response.body", "body": part, "more_body": more})
        finally:
            self._allowance.close()
