"""The costs between the stops of an earlier front and those that a request to replan brings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from service.day.breakpoints import Breakpoints
from service.errors import CityNames, invalid
from service.errors.faults import show
from service.requests.arrays import costs_array
from service.requests.replan.fields import CostEntry, NewStop
from service.requests.stop_fields import find_index
from service.requests.stops import (
    Changed,
    FixedSource,
    Matrix,
    Measured,
    Plane,
    Slices,
    Source,
    Stop,
    Traffic,
    changed_costs,
    with_base,
)

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class AllStops:
    """The stops of a front, the added ones, and the present position if it is new, in this order.

    Args:
        stops: All of them, the first n those of the front.
        n: The number of the front's stops.
        new: The others as the request has them, by their part of it: add/0 or position.
    """

    stops: tuple[Stop, ...]
    n: int
    new: Mapping[str, NewStop]

    @cached_property
    def parts(self) -> tuple[str, ...]:
        """The part of the request that has each stop; empty for those of the front."""
        return (*[""] * self.n, *self.new)

    @property
    def names(self) -> CityNames:
        """The names of all stops in refusals."""
        return CityNames("stop", [stop.id for stop in self.stops], parts=self.parts)


def all_stops(known: Sequence[Stop], items: Mapping[str, NewStop | list[int]]) -> AllStops:
    """Return the stops of a front, and those that a request brings, by their part of it.

    Raises:
        Refusal: Two have the same id.
    """
    new: dict[str, NewStop] = {}
    seen = {stop.id for stop in known}
    for part, item in items.items():
        if isinstance(item, list):
            raise invalid(part, "cell-for-a-stop")
        if item.id in seen:
            raise invalid(f"{part}/id", "known-id", came=item.id)
        seen.add(item.id)
        new[part] = item
    stops = (*known, *(Stop(item.id, item.location) for item in new.values()))
    return AllStops(stops, len(known), new)


def extended_sources(
    sources: Sequence[Source], names: Sequence[str], stops: AllStops
) -> list[Source]:
    """Return the source of the costs of each objective between all stops.

    Raises:
        Refusal: Costs of a new stop are missing, or are given where they are not asked for.
    """
    _check_counts(stops, len(names))
    return [
        _extended_over_the_day(source, m, name, stops)
        for m, (source, name) in enumerate(zip(sources, names, strict=True))
    ]


def changed_sources(
    sources: Sequence[Source], names: Sequence[str], entries: Sequence[CostEntry], stops: AllStops
) -> tuple[list[Source], NDArray[np.int64]]:
    """Return the sources with changed costs, and the stops to or from which these are.

    Raises:
        Refusal: A changed cost is of no objective or stop, or of traffic.
    """
    changed = _changes(entries, names, stops)
    steps = [stop for each in changed for step in each for stop in step]
    found = [
        _changed_over_the_day(source, name, each) if each else source
        for source, name, each in zip(sources, names, changed, strict=True)
    ]
    return found, np.array(steps, np.int64)


def _check_counts(stops: AllStops, objectives: int) -> None:
    """Raise a refusal where a new stop has costs or coordinates, but not for each objective."""
    for part, item in stops.new.items():
        for name, given in (("coordinates", item.coordinates), ("costs", item.costs)):
            if given and len(given) != objectives:
                values = {"objectives": objectives, "came": len(given)}
                raise invalid(f"{part}/{name}", "entry-each", **values)


def between(source: Source, chosen: NDArray[np.int64]) -> Source:
    """Return the source of the costs between some of the stops, in this order."""
    if isinstance(source, Slices):
        return Slices(source.begins, source.costs[:, chosen[:, np.newaxis], chosen])
    if isinstance(source, Breakpoints):
        return source.among(chosen)
    return with_base(source, lambda base: _between(base, chosen))


def _between(source: FixedSource, chosen: NDArray[np.int64]) -> FixedSource:
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


def _extended_over_the_day(source: Source, m: int, name: str, stops: AllStops) -> Source:
    """Return the source of an objective between all stops."""
    if isinstance(source, Traffic):
        for part, item in stops.new.items():
            _check_given(Measured("road_time"), part, item, m, name)
        return source
    if isinstance(source, Slices | Breakpoints) and stops.new:
        raise invalid(next(iter(stops.new)), "slices-need-objectives", objective=name)
    return with_base(source, lambda base: _extended(base, m, name, stops))


def _extended(source: FixedSource, m: int, name: str, stops: AllStops) -> FixedSource:
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


def _check_given(source: FixedSource, part: str, item: NewStop, m: int, name: str) -> None:
    """Raise a refusal unless a new stop has exactly the costs that an objective needs."""
    base = source.base if isinstance(source, Changed) else source
    given = {
        "costs": bool(item.costs) and item.costs[m] is not None,
        "coordinates": bool(item.coordinates) and item.coordinates[m] is not None,
    }
    needed = {Matrix: "costs", Plane: "coordinates"}.get(type(base))
    for member, there in given.items():
        if member == needed and not there:
            raise invalid(f"{part}/{member}", "entry-needed", objective=name)
        if there and member != needed:
            code = "entry-of-measured" if needed is None else "entry-of-given"
            raise invalid(f"{part}/{member}/{m}", code, objective=name, member=needed)
    if needed is None and item.location is None:
        raise invalid(f"{part}/location", "location-needed", objective=name)


def _extended_matrix(costs: Array, m: int, stops: AllStops) -> Array:
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
        raise invalid(part, "cost-each", stops=size, came=len(costs))
    row = costs_array(costs)
    row[own] = 0.0
    return row


def _changes(
    entries: Sequence[CostEntry], names: Sequence[str], stops: AllStops
) -> list[dict[tuple[int, int], float]]:
    """Return the changed costs of each objective by step; of several the last one counts."""
    changed: list[dict[tuple[int, int], float]] = [{} for _ in names]
    ids = {stop.id: index for index, stop in enumerate(stops.stops)}
    for index, entry in enumerate(entries):
        part = f"costs/{index}"
        origin, destination = (
            find_index(reference, ids, f"{part}/{name}", stops.n, "a stop of the front")
            for name, reference in (("from", entry.origin), ("to", entry.destination))
        )
        if origin == destination:
            raise invalid(f"{part}/to", "step-to-itself")
        cost = np.inf if entry.cost is None else entry.cost
        changed[_objective(entry.objective, names, part)][origin, destination] = cost
    return changed


def _changed_over_the_day(
    source: Source, name: str, entries: Mapping[tuple[int, int], float]
) -> Source:
    """Return a source with changed costs: all day, or before the factors of the day."""
    if isinstance(source, Traffic):
        raise invalid("costs", "costs-of-traffic", objective=name)
    steps, costs = np.array(list(entries), np.int64), np.array(list(entries.values()))
    if isinstance(source, Breakpoints):
        return source.changed(steps, costs)
    if isinstance(source, Slices):
        matrices = [changed_costs(matrix, steps, costs) for matrix in source.costs]
        return Slices(source.begins, np.stack(matrices))
    return with_base(source, lambda base: _changed(base, entries))


def _changed(source: FixedSource, entries: Mapping[tuple[int, int], float]) -> FixedSource:
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
        values = {"indexes": indexes, "names": " or ".join(map(show, names)), "came": objective}
        raise invalid(f"{part}/objective", "no-such-objective", **values)
    return names.index(objective)
