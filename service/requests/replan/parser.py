"""Parse requests to replan: from an earlier front and a body to the source of a task."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from service.actor_info import ActorInfo
from service.instance import PLANE
from service.requests.limits import Limits, check_amounts
from service.requests.replan.costs import AllStops, all_costs, all_stops, between, changed_stops
from service.requests.replan.earlier_front import StoredFront, read_earlier_front
from service.requests.replan.earlier_map import MAP_MODELS
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.map_fields import check_of_stops
from service.requests.replan.rest_members import EncodedTours
from service.requests.replan.rest_of_map import rest_of_map
from service.requests.replan.way import RestOfWay, driven_tour, left_of_tours, rest_of_way
from service.requests.stops import Changed, Matrix, Measured, Objective, Plane, Source, kind_of
from service.requests.task import TaskSource, parse_task
from service.requests.validation import parse_json, too_many_stops


@dataclass(frozen=True, eq=False)
class ReplanSource:
    """A request to replan, as it came, and the stored front that it is about."""

    body: bytes
    front: StoredFront

    @property
    def length(self) -> int:
        """The bytes to parse; those of the tours, which are the service's own, are quick to."""
        earlier = self.front.source
        upload = len(earlier.upload or b"")
        return len(self.body) + len(earlier.body) + upload + len(self.front.tours) // 8


def parse_replan(
    source: ReplanSource, limits: Limits, actors: Mapping[str, ActorInfo]
) -> TaskSource:
    """Return the rest of the way as a source with its task.

    Raises:
        Refusal: The request is malformed or over a limit, no actor serves it, or the front cannot
            be replanned so.
    """
    rest = rest_source(source, limits)
    return replace(rest, task=parse_task(rest, limits, actors))


def rest_source(source: ReplanSource, limits: Limits) -> TaskSource:
    """Return the rest of the way as the source of a task, which stands by itself.

    Raises:
        Refusal: The body is malformed or over a limit, or the front cannot be replanned so.
    """
    request = parse_json(ReplanRequest, source.body)
    if source.front.source.kind in MAP_MODELS:
        return rest_of_map(request, source.front, limits)
    check_of_stops(request)
    front = read_earlier_front(source.front, limits)
    stops = all_stops(front, request)
    rest = rest_of_way(front, request, stops)
    if not request.objectives:
        # Before matrices grow by the stops added.
        _check_cities("add", rest, front.sources, limits)
    check_amounts(request, len(rest.stops), limits)
    objectives, sources = all_costs(front, request, stops)
    _check_cities("objectives" if request.objectives else "costs", rest, sources, limits)
    sources = [between(each, rest.stops) for each in sources]
    place = np.full(len(stops.stops), -1)
    place[rest.stops] = np.arange(len(rest.stops))
    driven = driven_tour(front, request)
    left, moved = left_of_tours(front, driven, rest)
    file = _matrices_file(sources)
    members = {
        "stops": [vars(stops.stops[index]) for index in rest.stops],
        "objectives": [
            _objective(objective, each, file is not None)
            for objective, each in zip(objectives, sources, strict=True)
        ],
        **rest.end_members(place),
        "earlier_tours": EncodedTours.members(place[left]),
        "touched": _touched(request, stops, moved, place),
        "balance": front.balance_of(driven),
        "min_kept": request.min_kept,
        **request.model_dump(include=set(request.options_given)),
    }
    return TaskSource("replan", to_json(members), file)


def _check_cities(part: str, rest: RestOfWay, sources: Sequence[Source], limits: Limits) -> None:
    """Raise a refusal of a part of the request where the rest is of more stops than it may be."""
    kind = kind_of(sources)
    most = limits.most_cities(kind)
    if len(rest.stops) > most:
        unless = " unless all costs are distances in planes" if kind == "matrices" else ""
        detail = f"{part} must leave at most {most} stops{unless}, got {len(rest.stops)}"
        raise too_many_stops(part, detail, most, len(rest.stops))


def _touched(
    request: ReplanRequest,
    stops: AllStops,
    moved: NDArray[np.int64],
    place: NDArray[np.int64],
) -> list[int] | None:
    """Return the stops of the rest at which the earlier tours may have become worse, ascending.

    Those are the ones with new neighbours, and those to or from which a single cost has changed.

    None where that may be any, as the request brings whole new objectives.
    """
    if request.objectives:
        return None
    touched = place[np.union1d(moved, changed_stops(request, stops))]
    return touched[touched >= 0].tolist()


def _matrices_file(sources: list[Source]) -> bytes | None:
    """Return both matrices as a .npy file, if both objectives have one: as JSON they are long."""
    matrices = [source.costs for source in sources if isinstance(source, Matrix)]
    if len(matrices) < len(sources):
        return None
    content = BytesIO()
    np.save(content, np.stack(matrices), allow_pickle=False)
    return content.getvalue()


def _objective(objective: Objective, source: Source, in_file: bool) -> dict[str, Any]:
    """Return an objective as JSON, without its matrix where that is in the file."""
    return asdict(objective) | ({} if in_file else _costs(source))


def _costs(source: Source) -> dict[str, Any]:
    match source:
        case Matrix(costs):
            return {"matrix": costs.tolist()}
        case Plane(points):
            return {"coordinates": points.reshape(-1, PLANE).tolist()}
        case Measured(measure):
            return {"from": measure}
        case Changed(base, steps, costs):
            entries = zip(*steps.T.tolist(), costs.tolist(), strict=True)
            return {**_costs(base), "changed": [list(entry) for entry in entries]}
