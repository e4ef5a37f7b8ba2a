"""Parse requests to replan: from a stored front and a body to the task of the rest."""

from collections.abc import Mapping
from dataclasses import dataclass

from service.actor_info import ActorInfo
from service.coverage.coverage import Coverage
from service.errors import Refusal
from service.requests.limits import Limits
from service.requests.notes.of_task import with_notes
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.fleet_fields import ReplanFleetRequest
from service.requests.replan.rest_of_fleet import rest_of_fleet
from service.requests.replan.rest_of_map import rest_of_map
from service.requests.replan.rest_of_stops import rest_of_stops
from service.requests.replan.way import StoredFront, earlier_front, not_replannable
from service.requests.stops import Stops
from service.requests.task import Task, UnmeasuredFleet
from service.requests.task_codec import read_task
from service.requests.validation import parse_json


@dataclass(frozen=True, eq=False)
class ReplanSource:
    """A request to replan, as it came, and the stored front that it is about."""

    body: bytes
    front: StoredFront


def parse_replan(source: ReplanSource, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
    """Return the rest of the way.

    Raises:
        Refusal: The request is malformed or over a limit, no actor serves it, or the front cannot
            be replanned so.
        InvalidInstance: The costs or the map cannot be planned.
    """
    return with_notes(_parse(source, limits, actors), has_parts=False)


def _parse(source: ReplanSource, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
    stored = source.front
    task = _stored_task(stored, limits, actors)
    if isinstance(task.subject, UnmeasuredFleet):
        changes = parse_json(ReplanFleetRequest, source.body)
        return rest_of_fleet(changes, stored, task, limits, actors)
    request = parse_json(ReplanRequest, source.body)
    match task.subject:
        case Stops() as stops:
            front = earlier_front(stored, task, stops)
            return rest_of_stops(request, front, limits, actors)
        case Coverage() as coverage:
            return rest_of_map(request, stored, coverage, limits, actors)
    raise not_replannable(stored.id, "it is of plans for several robots")


def check_replan(body: bytes) -> None:
    """Raise a refusal if a body is a request to replan neither tours nor a fleet."""
    try:
        parse_json(ReplanFleetRequest, body)
    except Refusal:
        parse_json(ReplanRequest, body)


def _stored_task(stored: StoredFront, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
    try:
        return read_task(stored.source, limits, actors)
    except Refusal as refusal:
        reason = f"what it was planned from is refused now ({refusal.detail})"
        raise not_replannable(stored.id, reason) from None
    except ValueError as error:
        raise not_replannable(stored.id, "what it was planned from is damaged") from error
