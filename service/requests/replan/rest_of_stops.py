"""The rest of a way through stops: from the task of an earlier front and what has changed."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from service.actor_info import ActorInfo
from service.replanning.earlier_tours import EarlierTours
from service.requests.limits import Limits, check_amounts, check_router, lower_defaults
from service.requests.parser import front_task
from service.requests.replan.costs import AllStops, all_costs, all_stops, between, changed_stops
from service.requests.replan.earlier_front import EarlierFront
from service.requests.replan.fields import ReplanRequest, check_of_stops
from service.requests.replan.way import (
    RestOfWay,
    driven_tour,
    indexes_in_rest,
    left_of_tours,
    rest_of_way,
)
from service.requests.stops import Labels, Source, Stops, kind_of, locations_of
from service.requests.task import Task
from service.requests.validation import too_many_stops


def rest_of_stops(
    request: ReplanRequest, front: EarlierFront, limits: Limits, actors: Mapping[str, ActorInfo]
) -> Task:
    """Return the rest of the way through the stops of a front.

    Raises:
        Refusal: The request is over a limit, no actor or routing engine serves it, or the front
            cannot be replanned so.
        InvalidInstance: The costs cannot be planned.
    """
    check_of_stops(request)
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
    sources_of_rest = [between(each, rest.stops) for each in sources]
    check_router(sources_of_rest, limits)
    task = front_task(
        lower_defaults(request, n, limits, id_bytes),
        Stops(locations_of(labels.stops), sources_of_rest, rest.ends_at(place)),
        limits,
        actors,
        labels=labels,
        earlier=EarlierTours(
            tours=place[left],
            min_kept=request.min_kept,
            touched=_touched(request, stops, moved, place),
            balance=front.balance_of(driven),
        ),
    )
    return replace(task, options=replace(task.options, start=rest.begin_at(place) or 0))


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
