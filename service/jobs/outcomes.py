"""What becomes of the work of a record."""

import logging
from dataclasses import replace

from service.api.exception_handlers import problem_of
from service.jobs.front_document import Rendered
from service.jobs.record import Record, Status
from service.jobs.submission import Overdue, Stopped, as_ended

_LOG = logging.getLogger("paretour")


def done(record: Record, front: Rendered, stopped: type[Stopped | Overdue] | None) -> Record:
    """It ended with a front, perhaps because it was stopped."""
    status: Status = "cancelled" if stopped is Stopped else "done"
    return replace(record, status=status, front=front, work=None)


def cancelled(record: Record) -> Record:
    """It was stopped before there was a front."""
    members = {**record.front.members, "terminated": "cancelled"}
    return done(record, replace(record.front, members=members), Stopped)


def ended(
    record: Record, front: Rendered, why: type[Stopped | Overdue] | None, seconds: float
) -> Record:
    """It ended so long after it was asked for, with a front if any tour is in that."""
    if front.tours:
        return done(record, as_ended(front, seconds, late=why is Overdue), why)
    return failed(record, Overdue(), front) if why is Overdue else cancelled(record)


def failed(record: Record, error: Exception, front: Rendered) -> Record:
    """It ended with an error, and with the best front so far."""
    _LOG.warning("front %s failed", record.id, exc_info=error)
    problem = problem_of(error, record.request_id)
    return replace(record, status="failed", front=front, problem=problem, work=None)
