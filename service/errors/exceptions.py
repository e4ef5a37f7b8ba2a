"""The exceptions of the service. Most are refusals, which are answered as problem documents.

    Exception
    ├── Refusal                   a request that is not served, answered as a problem document
    │   ├── InvalidInstance       the cities cannot be planned (also a ValueError)
    │   │   └── InvalidCoverage   the map, or its places, cannot be covered
    │   │       └── TooManyPlaces a spacing lays out too many places
    │   ├── NoWorker              no worker process can be started
    │   ├── QueueFull             no place is left for another task
    │   │   └── ShareFull         none is left for another task of this client
    │   ├── ShuttingDown          no more tasks are taken
    │   ├── WarmingUp             the search is still being compiled
    │   ├── WorkerLost            two workers died over a task
    │   ├── Cancelled             a task was cancelled before it had a front
    │   ├── DeadlineExceeded      a task took too long before it had a front
    │   ├── IdempotencyMismatch   a key was used for another body
    │   ├── OffRoad, NoRoad       stops without a road, or without a way to another
    │   ├── NoTour                every tour has a forbidden leg; see `tours.py`
    │   ├── RouterUnavailable, RouterUnusable, RouterTooSlow
    │   ├── StreetsTooLong        lines along streets are too many, or too long
    │   └── StoreUnavailable      the store does not answer
    └── LookupError
        ├── NotFound              the store has no front with this id
        └── Expired               the store had one, and dropped it

`problems.py` has the status and the sentence of each code.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from http import HTTPStatus
from typing import Any, Self

from service.errors.faults import Fault, Remedy, quoted, said
from service.errors.problems import PROBLEMS

MOST_FAULTS = 20  # the most that one problem document lists
_GUIDE = "/guide/errors"  # the page that has a row for each code


class Refusal(Exception):
    """A request that is not served, with all members of its problem document.

    Args:
        code: One of PROBLEMS; by default that of the class.
        pointer: The one field at fault, as a JSON pointer into the body.
        errors: The faults of fields, which have codes and sentences of their own. The sentence has
            the first in its fields `detail` and `reason`, unless these are given.
        limit: The most that is allowed.
        actual: The number that came, where it is known.
        headers: Further headers of the response.
        fields: Values for the fields of the sentence.
    """

    code: str
    remedies: tuple[Remedy, ...] = ()

    def __init__(
        self,
        code: str = "",
        *,
        pointer: str | None = None,
        errors: Sequence[Fault] = (),
        limit: float | None = None,
        actual: float | None = None,
        headers: Mapping[str, str] | None = None,
        **fields: object,
    ) -> None:
        self.code = code or type(self).code
        self.status, sentence, _ = PROBLEMS[self.code]
        if errors:
            first = summary(errors[0], len(errors))
            fields = {"detail": first, "reason": first, **fields}
        fields = {"limit": limit, "actual": actual, **fields}
        self.detail = said(sentence, fields)
        shown = tuple(errors[:MOST_FAULTS])
        self.errors = shown if pointer is None else (_own_fault(self.code, pointer, fields),)
        self.limit = limit
        self.actual = actual
        self.headers = dict(headers or {})
        super().__init__(self.detail)

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]:
        """Pickle all members: subclasses take other arguments than the base class."""
        return Exception.__new__, (type(self), self.detail), self.__dict__

    def with_remedies(self, remedies: Sequence[Remedy]) -> Self:
        """Return this refusal with changes to the request, after each of which it is planned."""
        refusal = copy(self)
        refusal.remedies = tuple(remedies)
        return refusal

    def document(self, request_id: str) -> dict[str, Any]:
        """Return the problem document (RFC 9457) without the members that are None."""
        members = {
            "type": f"{_GUIDE}#{self.code}",
            "title": HTTPStatus(self.status).phrase,
            "status": self.status,
            "code": self.code,
            "detail": self.detail,
            "errors": self._documents_of_faults or None,
            "limit": self.limit,
            "actual": self.actual,
            "request_id": request_id,
        }
        return _without_none(members)

    @property
    def _documents_of_faults(self) -> list[dict[str, Any]]:
        """The faults as members of a problem document, of which the first has the remedies."""
        faults = [fault.document for fault in self.errors]
        if not self.remedies:
            return faults
        first, *others = faults or [{"detail": self.detail, "code": self.code}]
        return [{**first, "remedies": [each.document for each in self.remedies]}, *others]


def invalid(part: str, code: str, **values: object) -> Refusal:
    """Return the refusal of a part of a request, as matrices/0/2, that misses a demand."""
    return Refusal("invalid-request", errors=[Fault.of(part, code, **values)])


def invalid_header(name: str, code: str, **values: float | str) -> Refusal:
    """Return the refusal of a header of a request."""
    return Refusal("invalid-request", errors=[Fault(code, name, values=values)])


class InvalidInstance(Refusal, ValueError):
    """The cities, or the costs between them, cannot be planned, for a reason with its values."""

    def __init__(self, reason: str, **values: object) -> None:
        super().__init__("invalid-instance", errors=[Fault(reason, values=values)])


class InvalidCoverage(InvalidInstance):
    """The map, or its places, cannot be covered."""

    code = "invalid-request"

    def __init__(self, *faults: Fault, limit: int | None = None, actual: int | None = None) -> None:
        self.faults = faults
        Refusal.__init__(self, errors=faults, limit=limit, actual=actual)

    def __str__(self) -> str:
        """Return all faults as one sentence."""
        return "; ".join(fault.detail for fault in self.faults)


def uncoverable(part: str, code: str, **values: object) -> InvalidCoverage:
    """Return the refusal of a part of a map, or of its places."""
    return InvalidCoverage(Fault.of(part, code, **values))


class TooManyPlaces(InvalidCoverage):
    """A spacing lays out more places than are allowed."""

    code = "too-many-cities"

    def __init__(self, limit: int, actual: int) -> None:
        fault = Fault.of("spacing", "too-many-places", limit=limit, actual=actual)
        super().__init__(fault, limit=limit, actual=actual)


class NoWorker(Refusal):
    """No worker process runs or can be started; the service keeps trying."""

    def __init__(self, reason: str) -> None:
        super().__init__("no-worker", reason=reason)


class QueueFull(Refusal):
    """No place is left for another task."""

    code = "queue-full"


class ShareFull(QueueFull):
    """No place is left for another task of this client, as it holds its share of them."""

    code = "share-full"

    def __init__(self, limit: int) -> None:
        super().__init__(limit=limit, actual=limit)


class ShuttingDown(Refusal):
    """The service takes no more tasks."""

    code = "shutting-down"


class WarmingUp(Refusal):
    """The search is still being loaded, or compiled, which happens once: so far `progress`."""

    code = "warming-up"

    def __init__(self, progress: str = "compiling the search", seconds_left: float = 1.0) -> None:
        headers = {"Retry-After": str(max(1, math.ceil(seconds_left)))}
        super().__init__(progress=progress, headers=headers)


class WorkerLost(Refusal):
    """Two workers died over the task, which may be the cause."""

    code = "worker-lost"


class Cancelled(Refusal):
    """The task was cancelled before it had a front."""

    code = "stopped"


class DeadlineExceeded(Refusal):
    """The task took longer than any may, and had no front yet."""

    code = "overdue"


class IdempotencyMismatch(Refusal):
    """The caller has used this idempotency key for another body."""

    code = "idempotency-mismatch"


class StoreUnavailable(Refusal):
    """The store does not answer."""

    code = "store-unavailable"


class OffRoad(Refusal):
    """Stops, given by index and id, lie too many metres from every road."""

    def __init__(self, stops: Sequence[tuple[int, str]], snap: float) -> None:
        faults = [
            Fault(
                "off-road",
                pointer=f"/stops/{index}/location",
                values={"stop": quoted(name), "limit": snap},
            )
            for index, name in stops
        ]
        super().__init__("off-road", errors=faults)


class NoRoad(Refusal):
    """There is no way by road between some stops.

    Each missing way is given as the index of the stop to look at, and the ids of both its ends.
    """

    def __init__(self, ways: Sequence[tuple[int, str, str]]) -> None:
        faults = [
            Fault(
                "no-way-by-road",
                pointer=f"/stops/{index}",
                values={"origin": quoted(origin), "destination": quoted(destination)},
            )
            for index, origin, destination in ways
        ]
        super().__init__("no-road", errors=faults)


class RouterUnavailable(Refusal):
    """The routing engine does not answer, or answers that it is busy."""

    code = "router-unavailable"


class RouterUnusable(Refusal):
    """The routing engine's answer is not as documented; the reason quotes none of its text."""

    def __init__(self, reason: str) -> None:
        super().__init__("router-unusable", reason=reason)


class RouterTooSlow(Refusal):
    """The routing engine took longer than its time limit."""

    def __init__(self, seconds: float) -> None:
        super().__init__("router-too-slow", limit=seconds)


class StreetsTooLong(Refusal):
    """Lines along streets have more legs or positions than one answer may have."""

    def __init__(self, parts: str, limit: int, actual: int | None = None) -> None:
        super().__init__("streets-too-long", parts=parts, limit=limit, actual=actual)


class NotFound(LookupError):
    """The caller has no front with this id, and the store remembers none."""


class Expired(LookupError):
    """The caller's front with this id was dropped: too old, or the store was full."""


def summary(first: Fault, count: int) -> str:
    """Return the first of `count` faults, and how many more there are, as one sentence."""
    return first.detail + (f" (and {count - 1} more)" if count > 1 else "")


def _own_fault(code: str, pointer: str, fields: Mapping[str, object]) -> Fault:
    """Return the one fault of a refusal, whose sentence is that of the refusal."""
    part, sentence = pointer[1:], PROBLEMS[code].sentence
    demand = sentence.removeprefix("{name} ").removeprefix(f"{part} ")
    named = None if demand == sentence else part
    return Fault(code, named, pointer, values=fields, said=said(demand, fields))


def _without_none(members: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in members.items() if value is not None}
