"""Make requests for fleets: their objectives, their clock, and what they measure."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from service.files.reading import Request, Source, quoted
from service.roads.great_circle import great_circle_distances

Stop = dict[str, Any]
Vehicle = dict[str, Any]
_SPEED, _SPEED_BETWEEN_TOWNS = 30, 50  # km/h, along straight lines: a van in a city, and outside
_CITY = 10_000.0  # metres from the middle of a city, for half of all stops
_TIMES = ("service", "services", "window", "windows", "due", "release")
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
    members = {"breaks", "speed_factor", "per_time"}
    return timed(stops) or in_shifts(vehicles) or any(each.keys() & members for each in vehicles)


def spans(name: str, found: Sequence[list[float]]) -> dict[str, Any]:
    """Return windows or shifts as a member: `window`, or `windows` if there are several."""
    if len(found) > 1:
        return {f"{name}s": list(found)}
    return {name: found[0]} if found else {}


def all_demand(stops: Sequence[Stop]) -> list[int]:
    """Return the sum of the demands of stops."""
    return [sum(each) for each in zip(*(s["demand"] for s in stops if "demand" in s), strict=True)]


def fleet_request(
    stops: list[Stop],
    vehicles: list[Vehicle],
    objectives: list[dict[str, Any]],
    shipments: list[dict[str, str]] | None = None,
) -> Request:
    """Return the request of a fleet, with a clock if stops or vehicles have times."""
    request: Request = {"stops": stops, "vehicles": vehicles, "objectives": objectives}
    if have_times(stops, vehicles):
        request["clock"] = objectives[1]["name"]
    return request if shipments is None else {**request, "shipments": shipments}


def fleet_of_tables(
    source: Source, stops: list[Stop], vehicles: list[Vehicle], plane: list[list[float]] | None
) -> Request:
    """Return the request of a fleet with the objectives that its data are for.

    Args:
        source: The file of the stops.
        stops: The stops.
        vehicles: The vehicles.
        plane: The points of the stops in the plane, if they are not on the earth.
    """
    if plane:
        objectives = planar({"coordinates": plane})
    else:
        objectives = measured(source, have_times(stops, vehicles), stops)
        if any("per_distance" in vehicle for vehicle in vehicles):
            objectives[0]["name"] = "cost"
    return with_measure(source, fleet_request(stops, vehicles, objectives))


def with_measure(source: Source, request: Request) -> Request:
    """Return a request with the objectives that its prizes, and its times due or extra, are for.

    They take the place of the second objective, whose costs become those of the clock.
    """
    worthless = [str(stop["id"]) for stop in request["stops"] if stop.get("prize") == 0]
    if worthless:
        source.note(
            "prize",
            f"{listed(worthless)} may be left out for nothing, as the prize is 0. Without a prize a"
            " stop must be visited.",
        )
    measures = dict(_measures(request["stops"], request["vehicles"]))
    if not measures:
        return request
    for number, means in zip(("second", "third"), measures.values(), strict=False):
        source.note("objectives", f"The {number} objective is {means}.")
    first, times = request["objectives"]
    objectives = [first, *({"name": each, "measure": each} for each in measures)]
    if "clock" not in request:
        return {**request, "objectives": objectives}
    clock = {name: value for name, value in times.items() if name != "over"} | {"name": "time"}
    return {**request, "objectives": objectives, "clock": clock}


def _measures(stops: Sequence[Stop], vehicles: Sequence[Vehicle]) -> Iterator[tuple[str, str]]:
    """Yield the measures that stops and vehicles have data for, and what they are."""
    if any(stop.get("prize") for stop in stops):
        left = "the prizes of the stops that are left out: those with a prize may be"
        yield "unassigned", left
    if any("due" in stop for stop in stops):
        yield "lateness", "lateness after stops are due"
        if any(isinstance(stop.get("due"), list) for stop in stops):
            yield "earliness", "earliness before they are"
    elif any("max_overtime" in vehicle for vehicle in vehicles):
        yield "overtime", "overtime beyond shifts"


def numbers(loads: Sequence[int]) -> str:
    """Return loads for a sentence."""
    return " and ".join(map(str, loads))


def distinct(texts: Iterable[str]) -> list[str]:
    """Return each text once, in order."""
    return list(dict.fromkeys(texts))


def listed(texts: Sequence[str]) -> str:
    """Return the first texts for a sentence, and how many more there are."""
    more = f" and {len(texts) - _MOST_NAMED} more" if len(texts) > _MOST_NAMED else ""
    return ", ".join(quoted(each) for each in texts[:_MOST_NAMED]) + more
