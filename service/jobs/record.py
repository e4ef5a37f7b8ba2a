"""A front under an id, from the moment it is asked for, and how it ends."""

import logging
from dataclasses import dataclass, replace
from typing import Any, Literal

from service.errors import Cancelled, DeadlineExceeded, Refusal
from service.jobs.front_document import FrontDocument
from service.requests.task import Work

Status = Literal["queued", "running", "done", "cancelled", "failed"]
UNFINISHED: tuple[Status, ...] = ("queued", "running")


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """Whose front it is, how it stands, and what was found so far.

    The work is kept for as long as it is not finished. Where the caller gave an idempotency key,
    the digest tells one body from another. A failed one has a problem document.
    """

    id: str
    caller: str
    request_id: str
    status: Status
    front: FrontDocument
    work: Work | None = None
    key: str | None = None
    digest: str = ""
    problem: dict[str, Any] | None = None

    @property
    def finished(self) -> bool:
        """Whether nothing about it will change."""
        return self.status not in UNFINISHED

    def json(self) -> bytes:
        """A FrontAnswer."""
        more = {"problem": self.problem} if self.problem else {}
        return self.front.json(id=self.id, status=self.status, **more)


def as_ended(front: FrontDocument, seconds: float, late: bool) -> FrontDocument:
    """A front that took so long from when it was asked for, and may have been ended for that."""
    total = 1000 * seconds
    phases = front.members["timings_ms"]
    timings = {"queue": total - sum(phases.values()), **phases, "total": total}
    members = {**front.members, "timings_ms": timings}
    if front.members["terminated"] in (None, "cancelled"):
        members["terminated"] = "time_limit" if late else "cancelled"
    return replace(front, members=members)


def as_planned(front: FrontDocument) -> FrontDocument:
    """A front that has ended, with the times of planning alone."""
    timings = {**front.members["timings_ms"]}
    del timings["queue"], timings["total"]
    return replace(front, members={**front.members, "timings_ms": timings})


_LOG = logging.getLogger("paretour")


def done(
    record: Record, front: FrontDocument, stopped: type[Cancelled | DeadlineExceeded] | None
) -> Record:
    """It ended with a front, perhaps because it was stopped."""
    status: Status = "cancelled" if stopped is Cancelled else "done"
    return replace(record, status=status, front=front, work=None)


def cancelled(record: Record) -> Record:
    """It was stopped before there was a front."""
    members = {**record.front.members, "terminated": "cancelled"}
    return done(record, replace(record.front, members=members), Cancelled)


def ended(
    record: Record,
    front: FrontDocument,
    why: type[Cancelled | DeadlineExceeded] | None,
    seconds: float,
) -> Record:
    """It ended so long after it was asked for, with a front if any tour is in that."""
    if front.tours:
        return done(record, as_ended(front, seconds, late=why is DeadlineExceeded), why)
    return (
        failed(record, DeadlineExceeded(), front) if why is DeadlineExceeded else cancelled(record)
    )


def failed(record: Record, error: Exception, front: FrontDocument) -> Record:
    """It ended with an error, and with the best front so far."""
    _LOG.warning("front %s failed", record.id, exc_info=error)
    problem = _refusal_of(error).document(record.request_id)
    return replace(record, status="failed", front=front, problem=problem, work=None)


def _refusal_of(error: Exception) -> Refusal:
    return error if isinstance(error, Refusal) else Refusal("internal-error")
