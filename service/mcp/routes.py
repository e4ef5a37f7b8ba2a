"""The routes of a tour or plan as agents read them: clock times, lengths, loads and stops."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from paretour import FleetFront, FleetPlan, FleetRoute, FrontOfAnyKind, Objective, Tour
from paretour.kinds import kind_of

from service.amounts.said import amount, clock_time
from service.fleet.measures.table import MEASURES, OF_TIME


@dataclass(frozen=True)
class Way:
    """A route, or the one way of a tour.

    Attributes:
        known: What is known of all of it: by whom, when it leaves and is back, lengths, load.
        stops: Its stops in order.
        times: When each of them is reached, if that is known.
    """

    known: Mapping[str, Any]
    stops: Sequence[Any]
    times: Sequence[Any] | None = None


def ways_of(front: FrontOfAnyKind, number: int) -> list[Way]:
    """Return the routes of a tour or plan, by its number in the front."""
    item: Any = front[number]
    if isinstance(item, Tour):
        return [_way_of_tour(item)]
    names = names_of(front)
    stops = [visits for _, visits in kind_of(front.document).routes(item)]
    pairs = zip(item.routes, stops, strict=True)
    return [_way_of_route(front, names, *pair, at) for at, pair in enumerate(pairs)]


def measures_of(front: FrontOfAnyKind, number: int) -> dict[str, Any]:
    """Return the measures of a plan, in words; none of a tour."""
    item: Any = front[number]
    if not isinstance(item, FleetPlan) or not isinstance(front, FleetFront):
        return {}
    clock = front.clock
    return {name: _measure(name, value, clock) for name, value in item.measures.items()}


def _measure(name: str, value: float, clock: Objective | None) -> str | float:
    """Return a measure in words: times as "2:10 h", shares as "12 %", changes as "3 stops"."""
    row = MEASURES.get(name)  # None for what only a later service has
    unit = row and (row.of_plan or row.unit)
    if clock is not None and unit in OF_TIME and name != "weighted_arrival":  # times an urgency
        return amount(value, clock.unit)
    if row is not None and unit == "%":
        return f"{100 * value:.3g} % {row.said}"
    if unit == "stops":
        return "1 stop" if value == 1 else f"{value:.7g} stops"
    return float(f"{value:.7g}")


def hours_of(front: FrontOfAnyKind, number: int) -> dict[str, Any]:
    """Return when a tour leaves and ends, or the first and the last route of a plan, if known."""
    item: Any = front[number]
    if isinstance(item, Tour):
        return dict(_way_of_tour(item).known)
    timed = [each.arrivals for each in item.routes if getattr(each, "arrivals", None) is not None]
    if not timed or not isinstance(front, FleetFront):
        return {}
    unit = None if front.clock is None else front.clock.unit
    first, last = min(each[0] for each in timed), max(each[-1] for each in timed)
    return {"leaves": clock_time(float(first), unit), "ends": clock_time(float(last), unit)}


def left_out_of(front: FrontOfAnyKind, number: int) -> list[str]:
    """Return the ids of the stops that a plan leaves out."""
    return list(getattr(front[number], "unassigned", ()))


def fairest(front: FrontOfAnyKind) -> int | None:
    """Return the number of the plan whose routes differ least; None if that is not known."""
    if not isinstance(front, FleetFront) or "imbalance" not in front[0].measures:
        return None
    return min(range(len(front)), key=lambda number: front[number].measures["imbalance"])


def names_of(front: FrontOfAnyKind) -> list[str]:
    """Return the names of the objectives; their indexes if they have no names."""
    if front.objectives:
        return [objective.name for objective in front.objectives]
    return [str(index) for index in range(front.lengths.shape[1])]


def _way_of_tour(tour: Tour) -> Way:
    stops = tour.stops or tour.tour.tolist()
    if tour.times is None:
        return Way({}, stops)
    times = [clock_time(time, "s") for time in tour.times.tolist()]
    departure = tour.departure if tour.departure is not None else float(tour.times[0])
    known = {"leaves": clock_time(departure, "s"), "ends": times[-1]}
    return Way(known, stops, times[: len(stops)])


def _way_of_route(
    front: FrontOfAnyKind, names: Sequence[str], route: Any, stops: Sequence[Any], number: int
) -> Way:
    lengths = {name: float(f"{x:.7g}") for name, x in zip(names, route.lengths, strict=True)}
    mover = kind_of(front.document).mover
    known: dict[str, Any] = {"route": number, mover: getattr(route, mover), "lengths": lengths}
    if not isinstance(route, FleetRoute) or not isinstance(front, FleetFront):
        return Way(known, stops)
    if route.load:
        known["load"] = route.load[0] if len(route.load) == 1 else list(route.load)
    if route.route is not None:
        known["was_route"] = route.route
    if route.arrivals is None:
        return Way(known, stops)
    unit = None if front.clock is None else front.clock.unit
    times = [clock_time(time, unit) for time in route.arrivals.tolist()]
    known |= {"leaves": times[0], "ends": times[-1]}
    if route.breaks:
        known["breaks"] = [clock_time(time, unit) for time in route.breaks]
    return Way(known, stops, times)
