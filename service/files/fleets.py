"""Make requests for fleets: their objectives, depots, and vehicles if a file names none."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from service.files.reading import Request, Source, quoted
from service.roads.great_circle import great_circle_distances

Stop = dict[str, Any]
Vehicle = dict[str, Any]
_SPEED, _SPEED_BETWEEN_TOWNS = 30, 50  # km/h, along straight lines: a van in a city, and outside
_CITY = 10_000.0  # metres from the middle of a city, for half of all stops
_TIMES = ("service", "window", "windows", "due", "release")
_OF_VISITS = (*_TIMES, "demand", "prize", "skills", "vehicle")
_OF_VISITED = ("skills", "vehicle")  # members that no depot has
_MOST_NAMED = 3


def planar(costs: dict[str, Any]) -> list[dict[str, Any]]:
    """Return both objectives of costs that are also times: the total, and the longest route."""
    total, longest = ("total length", "sum"), ("longest route", "max")
    return [{"name": name, **costs, "over": over} for name, over in (total, longest)]


def measured(
    source: Source, timed: bool, stops: Sequence[Stop] = (), factor: float = 1
) -> list[dict[str, Any]]:
    """Return both objectives of stops on the earth; if `timed`, the second is time in seconds.

    Args:
        source: The file.
        timed: Whether the second is time.
        stops: The stops, whose distances say how fast vehicles are without a routing engine.
        factor: How much faster than usual the vehicles are.
    """
    distance = {"name": "distance", "from": "great_circle", "over": "sum"}
    if source.bounds.roads:
        return [distance, {"name": "time", "from": "road_time", "over": "max"}]
    if not timed:
        return [distance, {"name": "longest route", "from": "great_circle", "over": "max"}]
    speed = speed_between(stops) if factor == 1 else round(speed_between(stops) * factor, 3)
    where = f"along straight lines at {speed:g} km/h"
    source.note("objectives", f"Times are {where}, as there is no routing engine here.")
    time = {"name": "time", "from": "great_circle", "speed": speed, "over": "max"}
    return [distance, time]


def speed_between(stops: Sequence[Stop]) -> float:
    """Return how fast a van is along straight lines between stops, in km/h.

    It is faster where half of them or more lie outside a city.
    """
    places = np.array([stop["location"] for stop in stops if "location" in stop])
    if not len(places):
        return _SPEED
    off = great_circle_distances(places, np.median(places, axis=0))
    return _SPEED_BETWEEN_TOWNS if np.median(off) > _CITY else _SPEED


def timed(stops: Sequence[Stop]) -> bool:
    """Return whether stops have times."""
    return any(stop.keys() & set(_TIMES) for stop in stops)


def in_shifts(vehicles: Sequence[Vehicle]) -> bool:
    """Return whether vehicles have shifts."""
    return any(each.keys() & {"shift", "shifts"} for each in vehicles)


def have_times(stops: Sequence[Stop], vehicles: Sequence[Vehicle]) -> bool:
    """Return whether stops or vehicles have times, which need a clock."""
    return timed(stops) or in_shifts(vehicles) or any("breaks" in each for each in vehicles)


def spans(name: str, found: Sequence[list[float]]) -> dict[str, Any]:
    """Return windows or shifts as a member: `window`, or `windows` if there are several."""
    if len(found) > 1:
        return {f"{name}s": list(found)}
    return {name: found[0]} if found else {}


def at_depots(
    stops: Sequence[Stop], vehicles: Sequence[Vehicle]
) -> tuple[list[Stop], list[Vehicle]]:
    """Return stops and vehicles; fill in places and shifts that vehicles do not name.

    A vehicle without a start and an end drives from and to the first stop, unless that stop has a
    demand, skills or a vehicle. Its shift is the window of the stop where it starts. Starts, ends
    and stops for loading again are not visited.
    """
    first, by_id = stops[0], {stop["id"]: stop for stop in stops}
    home = {} if _is_visited(first) else dict.fromkeys(("start", "end"), first["id"])
    placed = [each if each.keys() & {"start", "end"} else each | home for each in vehicles]
    made = [
        each if in_shifts([each]) else each | _shift_of(by_id.get(each.get("start"), {}))
        for each in placed
    ]
    depots = {each.get(end) for each in made for end in ("start", "end")}
    depots |= {stop for each in made for stop in each.get("reload", ())}
    kept = [
        {name: value for name, value in stop.items() if name not in _OF_VISITS}
        if stop["id"] in depots and not _is_visited(stop)
        else stop
        for stop in stops
    ]
    return kept, made


def _is_visited(stop: Stop) -> bool:
    """Return whether a stop has what no depot has."""
    return any(stop.get("demand", ())) or any(stop.get(name) for name in _OF_VISITED)


def _shift_of(depot: Stop) -> Vehicle:
    """Return the windows of a depot as shifts of a vehicle."""
    return {
        shift: depot[window]
        for shift, window in (("shift", "window"), ("shifts", "windows"))
        if window in depot
    }


def all_demand(stops: Sequence[Stop]) -> list[int]:
    """Return the sum of the demands of stops."""
    return [sum(each) for each in zip(*(s["demand"] for s in stops if "demand" in s), strict=True)]


def fleet_request(
    stops: list[Stop], vehicles: list[Vehicle], objectives: list[dict[str, Any]]
) -> Request:
    """Return the request of a fleet, with a clock if stops or vehicles have times."""
    request: Request = {"stops": stops, "vehicles": vehicles, "objectives": objectives}
    if have_times(stops, vehicles):
        request["clock"] = objectives[1]["name"]
    return request


def with_measure(source: Source, request: Request) -> Request:
    """Return a request whose second objective is lateness or overtime, if it has either.

    The costs of the second objective become those of the clock.
    """
    stops, vehicles = request["stops"], request["vehicles"]
    if any("due" in stop for stop in stops):
        measure, means = "lateness", "lateness after stops are due"
    elif any("max_overtime" in vehicle for vehicle in vehicles):
        measure, means = "overtime", "overtime beyond shifts"
    else:
        return request
    first, times = request["objectives"]
    source.note("objectives", f"The second objective is {means}.")
    clock = {name: value for name, value in times.items() if name != "over"} | {"name": "time"}
    objectives = [first, {"name": measure, "measure": measure}]
    return {**request, "objectives": objectives, "clock": clock}


def with_vehicles(source: Source, stops: list[Stop], objectives: list[Any]) -> Request:
    """Return the request for the vehicles that stops name, or for one if they name none.

    Each vehicle starts at the first stop, holds all demand and has all skills.
    """
    first, demands = stops[0], all_demand(stops)
    named = _distinct(stop["vehicle"] for stop in stops if "vehicle" in stop)
    skills = _distinct(skill for stop in stops for skill in stop.get("skills", ()))
    held = ({"capacity": demands} if demands else {}) | ({"skills": skills} if skills else {})
    stops, vehicles = at_depots(stops, [{"id": name, **held} for name in named or ["vehicle"]])
    where = (
        f"from and to the first stop, {quoted(first['id'])}"
        if "start" in vehicles[0]
        else "from any stop to any"
    )
    holds = f", and holds all demand, {numbers(demands)}" if demands else ""
    able = f", and has all skills, {_listed(skills)}" if skills else ""
    added = "The file names no vehicles, so one was added. It"
    if named:
        added = f"One vehicle was added for each that stops name, {_listed(named)}. Each"
    source.note("vehicle", f"{added} drives {where}{holds}{able}.")
    return with_measure(source, fleet_request(stops, vehicles, objectives))


def numbers(loads: Sequence[int]) -> str:
    """Return loads for a sentence."""
    return " and ".join(map(str, loads))


def _distinct(texts: Iterable[str]) -> list[str]:
    """Return each text once, in order."""
    return list(dict.fromkeys(texts))


def _listed(texts: Sequence[str]) -> str:
    """Return the first texts for a sentence, and how many more there are."""
    more = f" and {len(texts) - _MOST_NAMED} more" if len(texts) > _MOST_NAMED else ""
    return ", ".join(quoted(each) for each in texts[:_MOST_NAMED]) + more
