"""The rest of a way through stops: from the task of an earlier front and what has changed."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from service.actor_info import ActorInfo
from service.errors import Refusal, invalid
from service.errors.parts import by_stop
from service.objectives import Objective
from service.requests.limits import Limits, check_breakpoints, check_router, within_limits
from service.requests.parser import front_task
from service.requests.replan.costs import (
    AllStops,
    all_stops,
    between,
    changed_sources,
    extended_sources,
)
from service.requests.replan.fields import NewStop, ReplanRequest, check_fields
from service.requests.replan.way import (
    EarlierFront,
    ReplanSource,
    RestOfWay,
    earlier_front,
    not_replannable,
    rest_of_way,
)
from service.requests.stop_fields import read_objectives, read_sources
from service.requests.stops import Hours, Labels, Source, Stops, kind_of, locations_of
from service.requests.task import Task
from service.requests.validation import parse_json, too_many_cities

Array = NDArray[np.float64]


def rest_of_stops(
    earlier: Stops,
    task: Task,
    source: ReplanSource,
    limits: Limits,
    actors: Mapping[str, ActorInfo],
) -> Task:
    """Return the rest of the way through the stops of a front.

    Raises:
        Refusal: The request is over a limit, no actor or routing engine serves it, or the front
            cannot be replanned so.
        InvalidInstance: The costs cannot be planned.
    """
    if earlier.spreads:
        raise not_replannable(source.front.id, "its costs spread from day to day")
    request = parse_json(ReplanRequest, source.body)
    front = earlier_front(source.front, task, earlier)
    check_fields(request, on_map=False)
    _check_certain(request)
    items: dict[str, NewStop | list[int]] = {
        f"add/{index}": item for index, item in enumerate(request.add)
    }
    if isinstance(request.position, NewStop | list):
        items["position"] = request.position
    stops = all_stops(front.labels.stops, items)
    rest = rest_of_way(front, request)
    if not request.objectives:
        # Before matrices grow by the added stops.
        _check_cities("add", rest, front.sources, limits)
    objectives, sources, changed = _all_costs(front, request, stops)
    _check_cities("objectives" if request.objectives else "costs", rest, sources, limits)
    if request.objectives:
        check_breakpoints(sources, limits)
    labels = Labels(
        tuple(stops.stops[index] for index in rest.stops),
        objectives,
        tuple(stops.parts[index] for index in rest.stops),
    )
    request = within_limits(request, len(labels.stops), limits, labels.id_bytes)
    sources_of_rest = [between(each, rest.stops) for each in sources]
    check_router(sources_of_rest, limits)
    rest_task = front_task(
        request,
        Stops(
            locations_of(labels.stops),
            sources_of_rest,
            rest.ends_in_rest,
            _hours_of_rest(front, request, stops, rest),
        ),
        limits,
        actors,
        labels=labels,
        earlier=rest.earlier_tours(front, request, None if request.objectives else changed),
    )
    return replace(rest_task, options=replace(rest_task.options, start=rest.begin or 0))


def _hours_of_rest(
    front: EarlierFront, request: ReplanRequest, stops: AllStops, rest: RestOfWay
) -> Hours | None:
    """Return the hours of the rest, which begins now; None if costs do not change over the day."""
    service = {part: item.service for part, item in stops.new.items()}
    if front.hours is None:
        given = {"now": request.now, **{f"{part}/service": s for part, s in service.items()}}
        for part, seconds in given.items():
            if seconds is not None:
                raise invalid(part, "day-unchanging")
        if any(item.changes for item in request.objectives):
            raise invalid("objectives", "objectives-change")
        return None
    if request.now is None:
        raise invalid("now", "no-now")
    seconds_of_all = np.append(front.hours.service, [s or 0.0 for s in service.values()])
    if rest.start is not None:
        seconds_of_all[rest.start] = 0.0  # the visit has ended
    return Hours(front.hours.clock, seconds_of_all[rest.stops], request.now, request.now)


def _check_cities(part: str, rest: RestOfWay, sources: Sequence[Source], limits: Limits) -> None:
    """Raise a refusal of a part of the request where the rest has too many stops."""
    kind = kind_of(sources)
    most = limits.most_cities(kind)
    if len(rest.stops) > most:
        code = "too-many-left-unless-planes" if kind == "matrices" else "too-many-left"
        raise too_many_cities(part, most, len(rest.stops), code)


def _all_costs(
    front: EarlierFront, request: ReplanRequest, stops: AllStops
) -> tuple[tuple[Objective, ...], list[Source], NDArray[np.int64]]:
    """Return the objectives, the source of the costs of each between all stops, and changed stops.

    Those are the stops to or from which single costs are changed.

    Raises:
        Refusal: Costs of a new stop are missing, or are given where they are not asked for; or a
            changed cost is of no objective or stop.
    """
    if request.objectives:
        objectives = read_objectives(request.objectives)
        for part, item in stops.new.items():
            for name in {"coordinates", "costs"} & item.model_fields_set:
                raise invalid(f"{part}/{name}", "not-beside", member="objectives")
        try:
            sources = read_sources(request.objectives, stops.stops)
        except Refusal as refusal:
            raise by_stop(refusal, stops.names) from None
    else:
        objectives = front.labels.objectives[: len(front.sources)]
        names = [objective.name for objective in objectives]
        sources = extended_sources(front.sources, names, stops)
    names = [objective.name for objective in objectives]
    sources, changed = changed_sources(sources, names, request.costs, stops)
    return objectives, sources, changed


def _check_certain(request: ReplanRequest) -> None:
    """Raise a refusal of objectives whose costs spread."""
    for index, item in enumerate(request.objectives):
        for name in ("spread", "days", "percentile"):
            if name in item.model_fields_set:
                raise invalid(f"objectives/{index}/{name}", "spread-of-rest")
