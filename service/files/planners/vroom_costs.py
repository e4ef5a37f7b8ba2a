"""Make objectives of the costs, matrices and speeds in VROOM's JSON.

In VROOM the cost of a route is `fixed`, and `per_hour` for its travel time, and `per_km` for its
distance: by default one for each second. It is the first objective wherever a vehicle says more
than these defaults; the second objective is the longest route. Vehicles that differ have prices and
speeds of their own.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from service.files.fleets import Objective, Stop, Vehicle, have_times, measured, speed_between
from service.files.places import note_places
from service.files.planners.vroom_matrices import (
    Cut,
    Matrix,
    add_profiles,
    cuts_of,
    known_costs,
    layers_of,
    profiles_of,
)
from service.files.planners.vroom_members import note_others, note_unused
from service.files.planners.vroom_mixed import (
    OF_COSTS,
    Layers,
    Ride,
    is_cost,
    mixed_objectives,
    nameless,
    note_rates,
    rides_of,
)
from service.files.reading import Source, quoted

_SAME = "all vehicles have the same one, and the objectives are metres and seconds"
_LIMITS = ("max_travel_time", "max_distance")
Objectives = list[Objective]
_Limit = Literal["max_distance", "max_driving", "longest"]


def objectives_of(
    source: Source,
    problem: Mapping[str, Any],
    located: tuple[Sequence[Stop], Sequence[Any]],
    vehicles: list[Vehicle],
    timed: bool,
) -> Objectives:
    """Return both objectives, and convert what vehicles cost and their limits to these.

    Args:
        located: The stops, and the index of each in the matrices.
        vehicles: The vehicles, whose members are changed.
        timed: Whether stops or vehicles have times.

    Raises:
        UnreadableFile: Places or matrices are missing or do not fit.
    """
    items = problem["vehicles"]
    rides = rides_of(source, items)
    costs = [each.get("costs") or {} for each in items]
    note_others(source, costs, OF_COSTS)
    fixed = any(each.get("fixed") for each in costs)
    cuts = cuts_of(source, problem, *located)
    if not cuts:
        _check_places(source, located[0])
        _add_road_profiles(source, items, vehicles)
    if len(cuts) > 1:
        add_profiles(items, vehicles)
    if len(set(rides)) > 1 or len(cuts) > 1:
        layers = layers_of(cuts) if cuts else _measured(source, located[0])
        found = mixed_objectives(source, rides, vehicles, layers), 1.0
    elif not cuts:
        by_time = timed or any(each.get("max_travel_time") is not None for each in items)
        found = _by_places(source, located[0], rides[0], fixed, by_time)
    else:
        found = _by_matrices(source, cuts[0], rides[0], fixed)
    objectives, unit = found
    for vehicle in vehicles:
        if "fixed" in vehicle and unit != 1:
            vehicle["fixed"] = round(vehicle["fixed"] / unit, 6)
    clocked = have_times(located[0], vehicles)
    limiting = _limiting(source, objectives, known_costs(cuts, "distances"), clocked)
    _add_limits(source, items, vehicles, objectives, limiting)
    return objectives


def _check_places(source: Source, stops: Sequence[Stop]) -> None:
    """Raise UnreadableFile if a stop has no place on the earth, and note what cannot be used."""
    if any("location" not in stop for stop in stops):
        raise source.refusal("task-without-location", "each task")
    note_places(source, stops)


def _add_road_profiles(
    source: Source, items: Sequence[Mapping[str, Any]], vehicles: Sequence[Vehicle]
) -> None:
    """Add the profiles by which vehicles drive by road; note those that nothing knows."""
    profiles = profiles_of(items)
    if profiles == ["car"]:
        return
    unknown = [each for each in profiles if each not in source.bounds.profiles]
    if not unknown:
        add_profiles(items, vehicles)
    elif source.bounds.roads:
        why = f"the routing engine does not know {', '.join(map(quoted, unknown[:3]))}"
        note_unused(source, "profile", "vehicles", why)
    else:
        note_unused(source, "profile", "vehicles", "without matrices all vehicles drive as cars do")


def _measured(source: Source, stops: Sequence[Stop]) -> Layers:
    """Return the costs of legs between places on the earth."""
    distance, time = measured(source, True, stops)
    return Layers(time, nameless(**{"from": "road_distance"}) if source.bounds.roads else distance)


def _by_places(
    source: Source, stops: Sequence[Stop], ride: Ride, fixed: bool, timed: bool
) -> tuple[Objectives, float]:
    """Return the objectives of stops on the earth, and VROOM's cost of a unit of the first."""
    factor = ride.speed
    if source.bounds.roads and factor != 1:
        note_unused(source, "speed_factor", "vehicles", "times are by road")
        factor = 1
    if not fixed:  # at one speed, any rates have the same best plans
        note_rates(source, [ride], _SAME)
        if factor != 1 and not timed:
            note_unused(source, "speed_factor", "vehicles", "nothing here takes time")
        return measured(source, timed, stops, factor), 1
    distance, time = measured(source, ride.per_hour > 0 or timed, stops, factor)
    per_second, per_metre = ride.per_hour / 3600, ride.per_km / 1000
    if not per_second and per_metre:
        return [distance, time], _noted(source, "distance", per_metre)
    total: Objective = {**time, "name": "total time", "over": "sum"}
    if source.bounds.roads:
        if per_metre:
            note_unused(source, "per_km", OF_COSTS, "times by road are not distances")
    else:
        per_second += per_metre * speed_between(stops) * factor / 3.6
    return [total, time], _noted(source, "total time", per_second)


def _noted(source: Source, name: str, unit: float) -> float:
    """Note how fixed costs were converted, and return the cost of a unit of an objective."""
    if unit <= 0:
        note_unused(source, "per_hour", OF_COSTS, "nothing costs anything but the vehicles")
        unit = 1
    was = "" if unit == 1 else f", and was divided by {unit:g}, the cost of its unit"
    source.note("fixed", f"fixed of {OF_COSTS} is added to the first objective, {name}{was}.")
    return unit


def _by_matrices(source: Source, cut: Cut, ride: Ride, fixed: bool) -> tuple[Objectives, float]:
    """Return the objectives of matrices, and VROOM's cost of a unit of the first."""
    durations = cut.matrix("durations", 1 / ride.speed)
    longest: Objective = {"name": "longest route", "unit": "s", "matrix": durations, "over": "max"}
    total: Objective = {"name": "total time", "unit": "s", "matrix": durations, "over": "sum"}
    if cut.given.get("costs"):
        why = "there are matrices of costs"
        note_rates(source, [ride], why)
        if cut.given.get("distances"):
            note_unused(source, "distances", "matrices", why)
        return [{"name": "cost", "matrix": cut.matrix("costs"), "over": "sum"}, longest], 1
    if not cut.given.get("distances"):
        if ride.per_km:
            note_unused(source, "per_km", OF_COSTS, "there are no matrices of distances")
        return [total, longest], _unit(source, "total time", ride._replace(per_km=0), fixed)
    distances = cut.matrix("distances")
    distance: Objective = {"name": "distance", "matrix": distances, "over": "sum"}
    if ride.per_hour and ride.per_km:
        source.note("objectives", "The first objective is VROOM's cost: per_hour and per_km.")
        costs = _costs(durations, distances, ride)
        return [{"name": "cost", "matrix": costs, "over": "sum"}, longest], 1
    if fixed and not ride.per_km:
        return [total, longest], _unit(source, "total time", ride, fixed)
    return [distance, longest], _unit(source, "distance", ride, fixed)


def _unit(source: Source, name: str, ride: Ride, fixed: bool) -> float:
    """Return VROOM's cost of a unit of the first objective, time or distance, with a note."""
    if not fixed:
        if not ride.per_km:
            note_rates(source, [ride], _SAME)
        return 1
    return _noted(source, name, ride.per_km / 1000 if ride.per_km else ride.per_hour / 3600)


def _costs(durations: Matrix, distances: Matrix, ride: Ride) -> Matrix:
    """Return what legs cost by their time and their length."""
    return [
        [_sum(second, metre, ride) for second, metre in zip(*rows, strict=True)]
        for rows in zip(durations, distances, strict=True)
    ]


def _sum(second: Any, metre: Any, ride: Ride) -> Any:
    """Return the cost of a leg; None forbids it."""
    if not is_cost(second) or not is_cost(metre):
        return None
    return round(second * ride.per_hour / 3600 + metre * ride.per_km / 1000, 6)


def _add_limits(
    source: Source,
    items: Sequence[Mapping[str, Any]],
    vehicles: Sequence[Vehicle],
    objectives: Objectives,
    limiting: Mapping[str, _Limit],
) -> None:
    """Add the limits on routes; note those of which there is no objective.

    Args:
        items: VROOM's vehicles.
        vehicles: The vehicles, whose members are changed.
        objectives: Both objectives.
        limiting: The members of vehicles that say VROOM's limits.
    """
    for name in _LIMITS:
        given = [item.get(name) for item in items]
        if all(limit is None for limit in given):
            continue
        if name not in limiting:
            note_unused(source, name, "vehicles", f"{objectives[0]['name']} is no distance")
            continue
        for limit, vehicle in zip(given, vehicles, strict=True):
            if limit is not None:
                vehicle[limiting[name]] = limit


def _limiting(
    source: Source, objectives: Objectives, metres: Objective | None, timed: bool
) -> dict[str, _Limit]:
    """Return the members of vehicles that say VROOM's limits, which are on driving alone.

    Args:
        objectives: Both objectives, of which the second is the longest route.
        metres: The matrices of distances, if there are some.
        timed: Whether the second is the clock's.
    """

    def is_distance(objective: Mapping[str, Any]) -> bool:
        if "matrix" in objective or "matrices" in objective:
            return metres is not None and all(objective.get(k) == v for k, v in metres.items())
        straight = objective["from"] == "great_circle" and not source.bounds.roads
        return "speed" not in objective and (straight or objective["from"] == "road_distance")

    first, second = objectives
    members: dict[str, _Limit] = {"max_distance": "max_distance"} if is_distance(first) else {}
    if timed:
        return {**members, "max_travel_time": "max_driving"}
    return {**members, "max_distance" if is_distance(second) else "max_travel_time": "longest"}
