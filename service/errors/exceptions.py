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
    │   ├── OffRoad, NoRoad       stops without a road, or a way to another; see `roads.py`
    │   ├── NoTour                every tour has a forbidden leg; see `tours.py`
    │   ├── RouterUnavailable, RouterUnusable, RouterTooSlow
    │   ├── StreetsTooLong        lines along streets are too many, or too long
    │   └── StoreUnavailable      the store does not answer
    └── LookupError
        ├── NotFound              the store has no front with this id
        └── Expired               the store had one, and dropped it

`problems.py` has the status and the sentence of each code.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from http import HTTPStatus
from typing import Any

from service.errors.problems import PROBLEMS

MOST_FAULTS = 20  # the most that one problem document lists


@dataclass(frozen=True)
class Fault:
    """One thing wrong with a request, and at which JSON pointer (RFC 6901) or parameter."""

    detail: str
    pointer: str | None = None
    parameter: str | None = None


class Refusal(Exception):
    """A request that is not served, with all members of its problem document.

    Args:
        code: One of PROBLEMS.
        pointer: The one field at fault, as a JSON pointer into the body.
        errors: The fields at fault, where there are several or they have sentences of their own.
        limit: The most that is allowed.
        actual: The number that came, where it is known.
        headers: Further headers of the response.
        fields: Values for the fields of the sentence.
    """

    code: str

    def __init__(
        self,
        code: str,
        *,
        pointer: str | None = None,
        errors: Sequence[Fault] = (),
        limit: float | None = None,
        actual: float | None = None,
        headers: Mapping[str, str] | None = None,
        **fields: object,
    ) -> None:
        self.code = code
        self.status = PROBLEMS[code].status
        self.detail = PROBLEMS[code].sentence.format(limit=limit, actual=actual, **fields)
        self.errors = tuple(errors) if pointer is None else (Fault(self.detail, pointer),)
        self.limit = limit
        self.actual = actual
        self.headers = dict(headers or {})
        super().__init__(self.detail)

    def __reduce__(self) -> tuple[Callable[..., "Refusal"], tuple[Any, ...]]:
        """Pickle all members: subclasses take other arguments than the base class."""
        return _unpickled, (type(self), self.__dict__)

    def document(self, request_id: str) -> dict[str, Any]:
        """Return the problem document (RFC 9457) without the members that are None."""
        members = {
            "type": "about:blank",
            "title": HTTPStatus(self.status).phrase,
            "status": self.status,
            "code": self.code,
            "detail": self.detail,
            "errors": [_without_none(asdict(fault)) for fault in self.errors] or None,
            "limit": self.limit,
            "actual": self.actual,
            "request_id": request_id,
        }
        return _without_none(members)


def invalid(part: str, demand: str) -> Refusal:
    """Return the refusal of a part of a request, as matrices/0/2, that misses a demand."""
    return Refusal("invalid-request", detail=f"{part} {demand}", pointer=f"/{part}")


class InvalidInstance(Refusal, ValueError):
    """The cities, or the costs between them, cannot be planned."""

    def __init__(self, reason: str) -> None:
        super().__init__("invalid-instance", reason=reason)


class InvalidCoverage(InvalidInstance):
    """The map, or its places, cannot be covered. A fault is a part (places/3) and a demand."""

    code = "invalid-request"

    def __init__(
        self, *faults: tuple[str, str], limit: int | None = None, actual: int | None = None
    ) -> None:
        self.faults = faults
        errors = [Fault(f"{part} {demand}", f"/{part}") for part, demand in faults]
        detail, shown = summarize(errors), errors[:MOST_FAULTS]
        code = type(self).code
        Refusal.__init__(self, code, detail=detail, errors=shown, limit=limit, actual=actual)

    def __str__(self) -> str:
        """Return all faults as one sentence."""
        return "; ".join(f"{part} {demand}" for part, demand in self.faults)


class TooManyPlaces(InvalidCoverage):
    """A spacing lays out more places than are allowed."""

    code = "too-many-cities"

    def __init__(self, limit: int, actual: int) -> None:
        demand = f"must lay out at most {limit} places, got {actual}"
        super().__init__(("spacing", demand), limit=limit, actual=actual)


class _Plain(Refusal):
    """A refusal whose sentence has no fields."""

    def __init__(self) -> None:
        super().__init__(type(self).code)


class NoWorker(Refusal):
    """No worker process runs or can be started; the service keeps trying."""

    def __init__(self, reason: str) -> None:
        super().__init__("no-worker", reason=reason)


class QueueFull(_Plain):
    """No place is left for another task."""

    code = "queue-full"


class ShareFull(QueueFull):
    """No place is left for another task of this client, as it holds its share of them."""

    code = "share-full"

    def __init__(self, limit: int) -> None:
        Refusal.__init__(self, type(self).code, limit=limit, actual=limit)


class ShuttingDown(_Plain):
    """The service takes no more tasks."""

    code = "shutting-down"


class WarmingUp(_Plain):
    """The search is still being loaded, or compiled, which happens once."""

    code = "warming-up"


class WorkerLost(_Plain):
    """Two workers died over the task, which may be the cause."""

    code = "worker-lost"


class Cancelled(_Plain):
    """The task was cancelled before it had a front."""

    code = "stopped"


class DeadlineExceeded(_Plain):
    """The task took longer than any may, and had no front yet."""

    code = "overdue"


class IdempotencyMismatch(_Plain):
    """The caller has used this idempotency key for another body."""

    code = "idempotency-mismatch"


class StoreUnavailable(_Plain):
    """The store does not answer."""

    code = "store-unavailable"


class NotFound(LookupError):
    """The caller has no front with this id, and the store remembers none."""


class Expired(LookupError):
    """The caller's front with this id was dropped: too old, or the store was full."""


def _unpickled(kind: type[Refusal], members: dict[str, Any]) -> Refusal:
    refusal = kind.__new__(kind)
    refusal.__dict__.update(members)
    refusal.args = (refusal.detail,)
    return refusal


def summarize(faults: Sequence[Fault]) -> str:
    """Return the first fault, and how many more there are, as one sentence."""
    more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
    return faults[0].detail + more


def _without_none(members: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in members.items() if value is not None}
