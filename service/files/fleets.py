"""Requests for fleets: objectives for their stops, and one vehicle where a file names none."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from service.files.places import great_circle
from service.files.reading import Request, Source, quoted

Stop = dict[str, Any]
_SPEED = 30 / 3.6  # metres a second, of a van in a city
_OF_VISITS = ("demand", "service", "window", "prize")


def planar(costs: dict[str, Any]) -> list[dict[str, Any]]:
    """Return both objectives of costs that are time as well: the total, and the longest route."""
    total, longest = ("total length", "sum"), ("longest route", "max")
    return [{"name": name, **costs, "over": over} for name, over in (total, longest)]


def measured(source: Source, stops: Sequence[Stop], timed: bool) -> list[dict[str, Any]]:
    """Return both objectives of stops on the earth, the second in seconds where it must be time."""
    distance = {"name": "distance", "from": "great_circle", "over": "sum"}
    if source.bounds.roads:
        time: dict[str, Any] = {"name": "time", "from": "road_time", "over": "max"}
    elif not timed:
        return [distance, {"name": "longest route", "from": "great_circle", "over": "max"}]
    else:
        source.check_count("stops with times", source.bounds.matrix_cities, len(stops))
        metres = great_circle(np.array([stop["location"] for stop in stops]))
        seconds = np.rint(metres / _SPEED).astype(int).tolist()
        time = {"name": "time", "unit": "s", "matrix": seconds, "over": "max"}
        text = "Driving times are those of the straight way at 30 km/h, as there is no routing"
        source.note("objectives", f"{text} engine.")
    return [distance, time]


def timed(stops: Sequence[Stop]) -> bool:
    """Return whether stops ask for a clock."""
    return any(stop.keys() & {"service", "window"} for stop in stops)


def note_left_out(source: Source, what: str) -> None:
    """Note what a file asks for, and this service has not."""
    source.note("left-out", f"{what} was not used: fleets have no such thing here.")


def with_one_vehicle(source: Source, stops: list[Stop], objectives: list[Any]) -> Request:
    """Return the request for one vehicle from the first stop, that holds all demand.

    The first stop is the depot, whose window is the vehicle's shift, unless it has a demand.
    """
    first = stops[0]
    depot = not any(first.get("demand", ()))
    demands = [stop["demand"] for stop in stops if "demand" in stop]
    vehicle: dict[str, Any] = {"id": "vehicle"}
    if depot:
        vehicle |= {"start": first["id"], "end": first["id"]}
        if "window" in first:
            vehicle["shift"] = first["window"]
        kept = {name: value for name, value in first.items() if name not in _OF_VISITS}
        stops = [kept, *stops[1:]]
    if demands:
        vehicle["capacity"] = [sum(each) for each in zip(*demands, strict=True)]
    where = (
        f"from and to the first stop, {quoted(first['id'])}," if depot else "from any stop to any"
    )
    holds = f" It holds all demand, {vehicle['capacity']}." if demands else ""
    source.note("vehicle", f"The file names no vehicles: one drives {where} was added.{holds}")
    request: Request = {"stops": stops, "vehicles": [vehicle], "objectives": objectives}
    if timed(stops) or "shift" in vehicle:
        request["clock"] = objectives[1]["name"]
    return request
