"""Make a task for the rest of a way through stops, from an earlier front and changes."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from service.actor_info import ActorInfo
from service.instance import PLANE, RouteEnds
from service.replanning.earlier_tours import EarlierTours
from service.requests.limits import Limits, check_amounts, check_router, lower_defaults
from service.requests.replan.costs import AllStops, all_costs, all_stops, between, changed_stops
from service.requests.replan.earlier_front import StoredFront, read_earlier_front
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.map_fields import check_of_stops
from service.requests.replan.rest_members import EarlierMembers
from service.requests.replan.way import (
    RestOfWay,
    driven_tour,
    indexes_in_rest,
    left_of_tours,
    rest_of_way,
)
from service.requests.stops import (
    Changed,
    Labels,
    Matrix,
    Measured,
    Objective,
    Plane,
    Source,
    UnmeasuredStops,
    kind_of,
    locations_of,
    make_instance,
)
from service.requests.task import Task, TaskSource, front_task
from service.requests.validation import too_many_stops


@dataclass(frozen=True, eq=False)
class RestOfStops:
    """The rest of a way through stops.

    Args:
        request: The request to replan, checked, whose options are those of the front of the rest.
        labels: The names of the stops that the rest has, by index, and of the objectives.
        sources: The source of the costs of each objective between these stops.
        ends: Whether the way leads back to where it begins, and its ends where it does not.
        begin: The stop at which it begins; None where that may be any.
        earlier: What is left of the earlier tours.
    """

    request: ReplanRequest
    labels: Labels
    sources: Sequence[Source]
    ends: RouteEnds
    begin: int | None
    earlier: EarlierTours

    def task(self, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
        """Return the task that `parse_task` would make of the source, in a tenth of the time.

        Raises:
            Refusal: No actor or routing engine serves it.
            InvalidInstance: The costs cannot be planned.
        """
        stops = UnmeasuredStops(locations_of(self.labels.stops), self.sources, self.ends)
        check_router(stops, limits)
        task = front_task(
            self.request,
            make_instance(stops) if stops.measured else stops,
            limits,
            actors,
            labels=self.labels,
            earlier=self.earlier,
        )
        return replace(task, options=replace(task.options, start=self.begin or 0))

    def source(self) -> TaskSource:
        """Return the rest as the source of a task, complete by itself."""
        file = _matrices_file(self.sources)
        members = {
            "stops": [vars(stop) for stop in self.labels.stops],
            "objectives": [
                _objective(objective, source, file is not None)
                for objective, source in zip(self.labels.objectives, self.sources, strict=True)
            ],
            "closed": self.ends.closed,
            "start": self.begin,
            "end": self.ends.end,
            **EarlierMembers.members(self.earlier),
            **self.request.model_dump(include=set(self.request.options_given)),
        }
        return TaskSource("replan", to_json(members, inf_nan_mode="null"), file)


def rest_of_stops(request: ReplanRequest, stored: StoredFront, limits: Limits) -> RestOfStops:
    """Return the rest of the way through the stops of a front.

    Raises:
        Refusal: The request is over a limit, or the front cannot be replanned so.
    """
    check_of_stops(request)
    front = read_earlier_front(stored, limits)
    stops = all_stops(front, request)
    rest = rest_of_way(front, request, stops)
    if not request.objectives:
        # Before matrices grow by the added stops.
        _check_cities("add", rest, front.sources, limits)
    objectives, sources = all_costs(front, request, stops)
    _check_cities("objectives" if request.objectives else "costs", rest, sources, limits)
    place = np.full(len(stops.stops), -1)
    place[rest.stops] = np.arange(len(rest.stops))
    driven = driven_tour(front, request)
    left, moved = left_of_tours(front, driven, rest)
    labels = Labels(tuple(stops.stops[index] for index in rest.stops), tuple(objectives))
    n, id_bytes = len(labels.stops), labels.id_bytes
    check_amounts(request, n, limits, id_bytes)
    return RestOfStops(
        request=lower_defaults(request, n, limits, id_bytes),
        labels=labels,
        sources=[between(each, rest.stops) for each in sources],
        ends=rest.ends_at(place),
        begin=rest.begin_at(place),
        earlier=EarlierTours(
            tours=place[left],
            min_kept=request.min_kept,
            touched=_touched(request, stops, moved, place),
            balance=front.balance_of(driven),
        ),
    )


def _check_cities(part: str, rest: RestOfWay, sources: Sequence[Source], limits: Limits) -> None:
    """Raise a refusal of a part of the request where the rest has too many stops."""
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
) -> NDArray[np.int64] | None:
    """Return the stops of the rest at which the earlier tours may have become worse, ascending.

    These are the stops with new neighbours, and those to or from which a single cost has changed.
    None if any stop may be affected, because the request has whole new objectives.
    """
    if request.objectives:
        return None
    return indexes_in_rest(place, np.union1d(moved, changed_stops(request, stops)))


def _matrices_file(sources: Sequence[Source]) -> bytes | None:
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
