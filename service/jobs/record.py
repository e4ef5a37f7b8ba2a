"""The record of a job: the front of one request under its id, from queued to finished."""

import logging
from dataclasses import dataclass, replace
from typing import Any, Literal

from service.errors import Cancelled, DeadlineExceeded, Refusal
from service.jobs.webhook import Webhook
from service.kinds.front_document import FrontDocument

Status = Literal["queued", "running", "done", "cancelled", "failed"]
UNFINISHED: tuple[Status, ...] = ("queued", "running")
StopReason = type[Cancelled | DeadlineExceeded]

_LOG = logging.getLogger("paretour")


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """A job as it is stored and answered.

    Attributes:
        caller: The name of the API key, which alone may see the record.
        request_id: The id of the request that submitted the job; problem documents name it.
        front: The best front found so far.
        task: The task, as `encode_task` writes it; None where the job has failed. Stores return
            that of a finished job apart from its record, if they have kept it.
        key: The Idempotency-Key, if the request had one.
        digest: SHA-256 of the body. A second request with the key is a repeat if it has the same.
        problem: The problem document of a job that failed.
        client: The client whose share of the places it takes: the caller's name, or the
            address of a caller without a key. It is not stored.
        webhook: What is told when the job has ended. Stores keep it until then.
    """

    id: str
    caller: str
    request_id: str
    status: Status
    front: FrontDocument
    task: bytes | None = None
    key: str | None = None
    digest: str = ""
    problem: dict[str, Any] | None = None
    client: str = ""
    webhook: Webhook | None = None

    @property
    def finished(self) -> bool:
        """Whether the job is done, cancelled or failed, and will not change again."""
        return self.status not in UNFINISHED

    def json(self) -> bytes:
        """Return the JSON of a FrontAnswer."""
        more = {"problem": self.problem} if self.problem else {}
        return self.front.json(id=self.id, status=self.status, **more)


def as_ended(
    record: Record, front: FrontDocument, reason: StopReason | None, seconds: float
) -> Record:
    """Return the record of a job that ended with this front, which may have no tour.

    Args:
        front: The best front found.
        reason: Why the job was stopped; None if it was not.
        seconds: The time from the request to the end.
    """
    late = reason is DeadlineExceeded
    if front.tours:
        return as_finished(record, front.ended(seconds, late=late), reason)
    return as_failed(record, DeadlineExceeded(), front) if late else as_cancelled(record)


def as_finished(record: Record, front: FrontDocument, reason: StopReason | None) -> Record:
    """Return the record with its final front: cancelled for that reason, else done."""
    status: Status = "cancelled" if reason is Cancelled else "done"
    return replace(record, status=status, front=front)


def as_cancelled(record: Record) -> Record:
    """Return the record of a job that was cancelled with the front that it has."""
    return as_finished(record, replace(record.front, terminated="cancelled"), Cancelled)


def as_failed(record: Record, error: Exception, front: FrontDocument) -> Record:
    """Log the error, and return the record with its problem document and the best front so far."""
    if isinstance(error, Refusal):
        # Its sentence may quote the caller's names of stops, which must not be logged.
        _LOG.warning("front %s is refused: %s", record.id, error.code)
        refusal = error
    else:
        _LOG.warning("front %s failed", record.id, exc_info=error)
        refusal = Refusal("internal-error")
    problem = refusal.document(record.request_id)
    return replace(record, status="failed", front=front, problem=problem, task=None)
