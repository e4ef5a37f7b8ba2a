"""The rest of a way through stops: from the task of an earlier front and what has changed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from service.actor_info import ActorInfo
from service.errors import invalid
from service.objectives import Objective
from service.requests.arrays import costs_array
from service.requests.limits import Limits, check_amounts, check_router, lower_defaults
from service.requests.parser import front_task
from service.requests.replan.fields import CostEntry, NewStop, ReplanRequest, check_fields
from service.requests.replan.way import EarlierFront, RestOfWay, rest_of_way
from service.requests.stop_fields import find_index, read_objectives, read_sources
from service.requests.stops import (
    Changed,
    Labels,
    Matrix,
    Measured,
    Plane,
    Source,
    Stop,
    Stops,
    changed_costs,
    kind_of,
    locations_of,
)
from service.requests.task import Task
from service.requests.validation import show, too_many_stops

Array = NDArray[np.float64]


def rest_of_stops(
    request: ReplanRequest, front: EarlierFront, limits: Limits, actors: Mapping[str, ActorInfo]
) -> Task:
    """Return the rest of the way through the stops of a front.

    Raises:
        Refusal: The request is over a limit, no actor or routing engine serves it, or the front
            cannot be replanned so.
        InvalidInstance: The costs cannot be planned.
    """
    check_fields(request, on_map=False)
    stops = _all_stops(front, request)
    rest = rest_of_way(front, request)
    if not request.objectives:
        # Before matrices grow by the added stops.
        _check_cities("add", rest, front.sources, limits)
    objectives, sources, changed = _all_costs(front, request, stops)
    _check_cities("objectives" if request.objectives else "costs", rest, sources, limits)
    labels = Labels(tuple(stops.stops[index] for index in rest.stops), objectives)
    n, id_bytes = len(labels.stops), labels.id_bytes
    check_amounts(request, n, limits, id_bytes)
    sources_of_rest = [_between(each, rest.stops) for each in sources]
    check_router(sources_of_rest, limits)
    task = front_task(
        lower_defaults(request, n, limits, id_bytes),
        Stops(locations_of(labels.stops), sources_of_rest, rest.ends_in_rest),
        limits,
        actors,
        labels=labels,
        earlier=rest.earlier_tours(front, request, None if request.objectives else changed),
    )
    return replace(task, options=replace(task.options, start=rest.begin or 0))


def _check_cities(part: str, rest: RestOfWay, sources: Sequence[Source], limits: Limits) -> None:
    """Raise a refusal of a part of the request where the rest has too many stops."""
    kind = kind_of(sources)
    most = limits.most_cities(kind, len(sources))
    if len(rest.stops) > most:
        unless = " unless all costs are distances in planes" if kind == "matrices" else ""
        detail = f"{part} must leave at most {most} stops{unless}, got {len(rest.stops)}"
        raise too_many_stops(part, detail, most, len(rest.stops))


@dataclass(frozen=True, eq=False)
class _AllStops:
    """The stops of a front, the added ones, and the present position if it is new, in this order.

    Args:
        stops: All of them, the first n those of the front.
        n: The number of the front's stops.
        new: The others as the request has them, by their part of it: add/0 or position.
    """

    stops: tuple[Stop, ...]
    n: int
    new: Mapping[str, NewStop]


def _all_stops(front: EarlierFront, request: ReplanRequest) -> _AllStops:
    """Return the stops of a front, and those that a request brings.

    Raises:
        Refusal: Two have the same id.
    """
    items = {f"add/{index}": item for index, item in enumerate(request.add)}
    if isinstance(request.position, NewStop | list):
        items["position"] = request.position
    new: dict[str, NewStop] = {}
    seen = {stop.id for stop in front.labels.stops}
    for part, item in items.items():
        if isinstance(item, list):
            demand = "must be a stop with an id: row and column are of a place on a map"
            raise invalid(part, demand)
        if item.id in seen:
            raise invalid(
                f"{part}/id", f"must differ from the ids of all other stops, got {show(item.id)}"
            )
        seen.add(item.id)
        new[part] = item
    stops = (*front.labels.stops, *(Stop(item.id, item.location) for item in new.values()))
    return _AllStops(stops, front.n, new)


def _all_costs(
    front: EarlierFront, request: ReplanRequest, stops: _AllStops
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
                raise invalid(f"{part}/{name}", "must not be given together with objectives")
        sources = read_sources(request.objectives, stops.stops)
    else:
        objectives = front.labels.objectives[: len(front.sources)]
        _check_counts(stops, len(objectives))
        sources = [
            _extended(source, m, objective.name, stops)
            for m, (source, objective) in enumerate(zip(front.sources, objectives, strict=True))
        ]
    changed = _changes(request.costs, [objective.name for objective in objectives], stops)
    steps = [stop for entries in changed for step in entries for stop in step]
    sources = [
        _changed(source, entries) if entries else source
        for source, entries in zip(sources, changed, strict=True)
    ]
    return objectives, sources, np.array(steps, np.int64)


def _check_counts(stops: _AllStops, objectives: int) -> None:
    """Raise a refusal where a new stop has costs or coordinates, but not for each objective."""
    for part, item in stops.new.items():
        for name, given in (("coordinates", item.coordinates), ("costs", item.costs)):
            if given and len(given) != objectives:
                demand = f"must have {objectives} entries, one for each objective"
                raise invalid(f"{part}/{name}", f"{demand}, got {len(given)}")


def _between(source: Source, chosen: NDArray[np.int64]) -> Source:
    """Return the source of the costs between some of the stops, in this order."""
    match source:
        case Matrix(costs):
            return Matrix(costs[np.ix_(chosen, chosen)])
        case Plane(points):
            return Plane(points[chosen])
        case Changed(base, steps, costs):
            place = np.full(max(int(steps.max()), int(chosen.max())) + 1, -1)
            place[chosen] = np.arange(len(chosen))
            left = (place[steps] >= 0).all(axis=1)
            rest = _between(base, chosen)
            assert isinstance(rest, Plane | Measured)
            return Changed(rest, place[steps[left]], costs[left]) if left.any() else rest
    return source


def _extended(source: Source, m: int, name: str, stops: _AllStops) -> Source:
    """Return the source of an objective between all stops."""
    for part, item in stops.new.items():
        _check_given(source, part, item, m, name)
    match source:
        case Matrix(costs):
            return Matrix(_extended_matrix(costs, m, stops))
        case Plane(points):
            new = [item.coordinates[m] for item in stops.new.values()]
            return Plane(np.concatenate((points, np.array(new, np.float64).reshape(-1, 2))))
        case Changed(base, steps, costs):
            extended = _extended(base, m, name, stops)
            assert isinstance(extended, Plane | Measured)
            return Changed(extended, steps, costs)
    return source


def _check_given(source: Source, part: str, item: NewStop, m: int, name: str) -> None:
    """Raise a refusal unless a new stop has exactly the costs that an objective needs."""
    base = source.base if isinstance(source, Changed) else source
    given = {
        "costs": bool(item.costs) and item.costs[m] is not None,
        "coordinates": bool(item.coordinates) and item.coordinates[m] is not None,
    }
    needed = {Matrix: "costs", Plane: "coordinates"}.get(type(base))
    for member, there in given.items():
        if member == needed and not there:
            raise invalid(f"{part}/{member}", f"is required, with an entry for {show(name)}")
        if there and member != needed:
            kind = "measured" if needed is None else f"given by {needed}"
            raise invalid(f"{part}/{member}/{m}", f"must be null: {show(name)} is {kind}")
    if needed is None and item.location is None:
        raise invalid(f"{part}/location", f"is required, as {show(name)} is measured")


def _extended_matrix(costs: Array, m: int, stops: _AllStops) -> Array:
    n, size = stops.n, len(stops.stops)
    matrix = np.zeros((size, size))
    matrix[:n, :n] = costs
    for index, (part, item) in enumerate(stops.new.items(), start=n):
        entry = item.costs[m]
        assert entry is not None
        to = _row(entry.to, f"{part}/costs/{m}/to", index, size)
        back = _row(entry.back, f"{part}/costs/{m}/from", index, size) if entry.back else to
        matrix[index] = to
        matrix[:n, index] = back[:n]
    return matrix


def _row(costs: Sequence[float | None], part: str, own: int, size: int) -> Array:
    """Return a row of costs; that of the stop to itself is 0."""
    if len(costs) != size:
        raise invalid(part, f"must have {size} costs, one for each stop, got {len(costs)}")
    row = costs_array(costs)
    row[own] = 0.0
    return row


def _changes(
    entries: Sequence[CostEntry], names: Sequence[str], stops: _AllStops
) -> list[dict[tuple[int, int], float]]:
    """Return the changed costs of each objective by step; of changes of one step the last counts.

    Args:
        entries: The changes.
        names: The names of the objectives.
        stops: All stops.
    """
    changed: list[dict[tuple[int, int], float]] = [{} for _ in names]
    ids = {stop.id: index for index, stop in enumerate(stops.stops)}
    for index, entry in enumerate(entries):
        part = f"costs/{index}"
        origin, destination = (
            find_index(reference, ids, f"{part}/{name}", stops.n, "a stop of the front")
            for name, reference in (("from", entry.origin), ("to", entry.destination))
        )
        if origin == destination:
            raise invalid(f"{part}/to", "must not be the stop that the step leads from")
        cost = np.inf if entry.cost is None else entry.cost
        changed[_objective(entry.objective, names, part)][origin, destination] = cost
    return changed


def _changed(source: Source, entries: Mapping[tuple[int, int], float]) -> Source:
    if isinstance(source, Changed):
        known = zip(source.steps.tolist(), source.costs.tolist(), strict=True)
        return _changed(source.base, {(i, j): cost for (i, j), cost in known} | dict(entries))
    steps, costs = np.array(list(entries), np.int64), np.array(list(entries.values()))
    if isinstance(source, Matrix):
        return Matrix(changed_costs(source.costs, steps, costs))
    return Changed(source, steps, costs)


def _objective(objective: int | str, names: Sequence[str], part: str) -> int:
    if isinstance(objective, int) and objective < len(names):
        return objective
    if isinstance(objective, int) or objective not in names:
        indexes = ", ".join(map(str, range(len(names))))
        demand = f"must be {indexes} or {' or '.join(map(show, names))}"
        raise invalid(f"{part}/objective", f"{demand}, got {show(objective)}")
    return names.index(objective)
