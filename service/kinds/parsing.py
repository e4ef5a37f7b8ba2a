"""Parse the body of a request of any kind into a Task."""

from service.errors import Refusal
from service.kinds.great_circles import with_great_circles
from service.kinds.kind import Actors
from service.kinds.table import KINDS, kind_of
from service.requests.limits import Limits, check_structure
from service.requests.notes.of_task import with_notes
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.fleet_fields import ReplanFleetRequest
from service.requests.replan.way import ReplanSource, StoredFront, not_replannable
from service.requests.task import Task, TaskSource
from service.requests.task_codec import decode_task
from service.requests.validation import parse_json

_READERS = {kind.path: kind.read for kind in KINDS.values()}


def parse_task(source: TaskSource, limits: Limits, actors: Actors) -> Task:
    """Return the task that a request asks for.

    Raises:
        Refusal: The body is malformed or over a limit, or no actor serves it.
        InvalidInstance: The cities or the map cannot be planned.
    """
    check_structure(source.body, limits)
    if source.kind not in _READERS:
        raise ValueError(f"no request is of kind {source.kind}")
    read = _READERS[source.kind]
    try:
        task = read(source, limits, actors)
    except Refusal as refusal:
        raise with_great_circles(refusal, source, lambda it: read(it, limits, actors)) from None
    return with_notes(task, has_parts=source.upload is None)


def parse_replan(source: ReplanSource, limits: Limits, actors: Actors) -> Task:
    """Return the rest of the way of a stored front.

    Raises:
        Refusal: The request is malformed or over a limit, no actor serves it, or the front cannot
            be replanned so.
        InvalidInstance: The costs or the map cannot be planned.
    """
    task = stored_task(source.front)
    rest = kind_of(task).rest(task.subject, task, source, limits, actors)
    return with_notes(rest, has_parts=False)


def stored_task(front: StoredFront) -> Task:
    """Return the task that a stored front was planned from.

    Raises:
        Refusal: It is damaged.
    """
    try:
        return decode_task(front.task)
    except ValueError as error:
        reason = "what it was planned from is damaged"
        raise not_replannable(front.id, reason) from error


def check_replan(body: bytes) -> None:
    """Raise a refusal if a body is a request to replan neither tours nor a fleet."""
    try:
        parse_json(ReplanFleetRequest, body)
    except Refusal:
        parse_json(ReplanRequest, body)
