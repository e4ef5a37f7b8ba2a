"""Parse requests to replan: make the source of a task from an earlier front and a body."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from service.actor_info import ActorInfo
from service.requests.limits import Limits
from service.requests.replan.earlier_front import StoredFront
from service.requests.replan.earlier_map import MAP_MODELS
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.rest_of_map import rest_of_map
from service.requests.replan.rest_of_stops import rest_of_stops
from service.requests.task import TaskSource, parse_task
from service.requests.validation import parse_json


@dataclass(frozen=True, eq=False)
class ReplanSource:
    """A request to replan, as it came, and the stored front that it is about."""

    body: bytes
    front: StoredFront

    @property
    def length(self) -> int:
        """The bytes to parse, without the tours, which the service wrote and parses quickly."""
        earlier = self.front.source
        upload = len(earlier.upload or b"")
        return len(self.body) + len(earlier.body) + upload + len(self.front.tours) // 8


def parse_replan(
    source: ReplanSource, limits: Limits, actors: Mapping[str, ActorInfo]
) -> TaskSource:
    """Return the rest of the way as a source with its task; the source is complete by itself.

    Raises:
        Refusal: The request is malformed or over a limit, no actor serves it, or the front cannot
            be replanned so.
        InvalidInstance: The costs or the map cannot be planned.
    """
    request = parse_json(ReplanRequest, source.body)
    if source.front.source.kind in MAP_MODELS:
        rest = rest_of_map(request, source.front, limits)
        return replace(rest, task=parse_task(rest, limits, actors))
    stops = rest_of_stops(request, source.front, limits)
    return replace(stops.source(), task=stops.task(limits, actors))
