"""Make requests for fleets: their objectives, depots, and one vehicle if a file names none."""

from collections.abc import Sequence
from typing import Any

from service.files.reading import Request, Source, quoted

Stop = dict[str, Any]
Vehicle = dict[str, Any]
_SPEED = 30  # km/h: a van in a city
_OF_VISITS = ("demand", "service", "window", "prize")


def planar(costs: dict[str, Any]) -> list[dict[str, Any]]:
    """Return both objectives of costs that are also times: the total, and the longest route."""
    total, longest = ("total length", "sum"), ("longest route", "max")
    return [{"name": name, **costs, "over": over} for name, over in (total, longest)]


def measured(source: Source, timed: bool) -> list[dict[str, Any]]:
    """Return both objectives of stops on the earth; if `timed`, the second is time in seconds."""
    distance = {"name": "distance", "from": "great_circle", "over": "sum"}
    if source.bounds.roads:
        return [distance, {"name": "time", "from": "road_time", "over": "max"}]
    if not timed:
        return [distance, {"name": "longest route", "from": "great_circle", "over": "max"}]
    where = f"along straight lines at {_SPEED} km/h"
    source.note("objectives", f"Times are {where}, as there is no routing engine here.")
    time = {"name": "time", "from": "great_circle", "speed": _SPEED, "over": "max"}
    return [distance, time]


def timed(stops: Sequence[Stop]) -> bool:
    """Return whether stops have times."""
    return any(stop.keys() & {"service", "window"} for stop in stops)


def at_depots(
    stops: Sequence[Stop], vehicles: Sequence[Vehicle]
) -> tuple[list[Stop], list[Vehicle]]:
    """Return stops and vehicles; fill in places and shifts that vehicles do not name.

    A vehicle without a start and an end drives from and to the first stop, unless that stop has a
    demand. Its shift is the window of the stop where it starts. Starts and ends are not visited.
    """
    first, by_id = stops[0], {stop["id"]: stop for stop in stops}
    home = {} if any(first.get("demand", ())) else dict.fromkeys(("start", "end"), first["id"])
    placed = [each if each.keys() & {"start", "end"} else each | home for each in vehicles]
    windows = [by_id.get(each.get("start"), {}).get("window") for each in placed]
    made = [
        {"shift": window, **each} if window else each
        for each, window in zip(placed, windows, strict=True)
    ]
    depots = {each.get(end) for each in made for end in ("start", "end")}
    kept = [
        {name: value for name, value in stop.items() if name not in _OF_VISITS}
        if stop["id"] in depots and not any(stop.get("demand", ()))
        else stop
        for stop in stops
    ]
    return kept, made


def all_demand(stops: Sequence[Stop]) -> list[int]:
    """Return the sum of the demands of stops."""
    return [sum(each) for each in zip(*(s["demand"] for s in stops if "demand" in s), strict=True)]


def fleet_request(
    stops: list[Stop], vehicles: list[Vehicle], objectives: list[dict[str, Any]]
) -> Request:
    """Return the request of a fleet, with a clock if stops or vehicles have times."""
    request: Request = {"stops": stops, "vehicles": vehicles, "objectives": objectives}
    if timed(stops) or any("shift" in each for each in vehicles):
        request["clock"] = objectives[1]["name"]
    return request


def with_one_vehicle(source: Source, stops: list[Stop], objectives: list[Any]) -> Request:
    """Return the request for one vehicle that starts at the first stop and holds all demand."""
    first, demands = stops[0], all_demand(stops)
    stops, [vehicle] = at_depots(stops, [{"id": "vehicle"}])
    if demands:
        vehicle["capacity"] = demands
    where = (
        f"from and to the first stop, {quoted(first['id'])}"
        if "start" in vehicle
        else "from any stop to any"
    )
    holds = f", and holds all demand, {vehicle['capacity']}" if demands else ""
    added = "The file names no vehicles, so one was added."
    source.note("vehicle", f"{added} It drives {where}{holds}.")
    return fleet_request(stops, [vehicle], objectives)
