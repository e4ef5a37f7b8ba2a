"""Make requests for fleets: their objectives, their clock, and what they measure."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import Literal, TypeVar, cast

import numpy as np
from paretour.member_parts import (
    ClockRequest,
    FleetObjectiveRequest,
    FleetStopRequest,
    Measure,
    ShipmentRequest,
    VehicleRequest,
)
from paretour.members import FleetRequest

from service.errors.printable import shortened
from service.files.reading import Source, quoted
from service.roads.great_circle import great_circle_distances

Stop = FleetStopRequest
Vehicle = VehicleRequest
Shipment = ShipmentRequest
Objective = FleetObjectiveRequest
End = Literal["start", "end"]
ENDS: tuple[End, ...] = ("start", "end")
Form = TypeVar("Form", FleetStopRequest, VehicleRequest)
_SPEED, _SPEED_BETWEEN_TOWNS = 30, 50  # km/h, along straight lines: a van in a city, and outside
_CITY = 10_000.0  # metres from the middle of a city, for half of all stops
_TIMES = ("service", "services", "window", "windows", "due", "release")
_MOST_NAMED = 3


def planar(total: Objective) -> list[Objective]:
    """Return both objectives of costs that are also times: the total, and the longest route."""
    longest: Objective = {**total, "name": "longest route", "over": "max"}
    return [{**total, "over": "sum"}, longest]


def measured(
    source: Source, timed: bool, stops: Sequence[Stop] = (), factor: float = 1
) -> list[Objective]:
    """Return both objectives of stops on the earth; if `timed`, the second is time in seconds.

    Args:
        timed: Whether the second is time.
        stops: The stops, whose distances say how fast vehicles are without a routing engine.
        factor: How much faster than usual the vehicles are.
    """
    distance: Objective = {"name": "distance", "from": "great_circle", "over": "sum"}
    if source.bounds.roads:
        return [distance, {"name": "time", "from": "road_time", "over": "max"}]
    if not timed:
        return [distance, {"name": "longest route", "from": "great_circle", "over": "max"}]
    speed = speed_between(stops) if factor == 1 else round(speed_between(stops) * factor, 3)
    where = f"along straight lines at {speed:g} km/h"
    source.note("objectives", f"Times are {where}, as there is no routing engine here.")
    return [distance, {"name": "time", "from": "great_circle", "speed": speed, "over": "max"}]


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


def add_windows(stop: Stop, found: Sequence[list[float]]) -> None:
    """Add windows to a stop: as `window`, or as `windows` if there are several."""
    if len(found) > 1:
        stop["windows"] = found
    elif found:
        stop["window"] = found[0]


def add_shifts(vehicle: Vehicle, found: Sequence[list[float]]) -> None:
    """Add shifts to a vehicle: as `shift`, or as `shifts` if there are several."""
    if len(found) > 1:
        vehicle["shifts"] = found
    elif found:
        vehicle["shift"] = found[0]


def without(form: Form, members: Collection[str]) -> Form:
    """Return a stop or a vehicle without some of its members."""
    return cast(Form, {name: value for name, value in form.items() if name not in members})


def without_empty(form: Form) -> Form:
    """Return a stop or a vehicle without members that are empty, apart from its id."""
    return without(form, [name for name, value in form.items() if not value and name != "id"])


def all_loads(stops: Sequence[Stop]) -> list[int]:
    """Return the sum of what stops get and give back."""
    demands = [stop["demand"] for stop in stops if "demand" in stop]
    pickups = [stop["pickup"] for stop in stops if "pickup" in stop]
    loads = np.array([*demands, *pickups])
    return [int(each) for each in loads.sum(axis=0)] if loads.size else []


def fleet_request(
    stops: list[Stop],
    vehicles: list[Vehicle],
    objectives: list[Objective],
    shipments: list[Shipment] | None = None,
    *,
    waits: bool = False,
) -> FleetRequest:
    """Return the request of a fleet, with a clock if it has times or its stops wait for others."""
    request: FleetRequest = {"stops": stops, "vehicles": vehicles, "objectives": objectives}
    if waits or have_times(stops, vehicles):
        request["clock"] = objectives[1]["name"]
    if shipments is not None:
        request["shipments"] = shipments
    return request


def fleet_of_tables(
    source: Source,
    stops: list[Stop],
    vehicles: list[Vehicle],
    plane: list[list[float]] | None,
    *,
    waits: bool,
) -> FleetRequest:
    """Return the request of a fleet with the objectives that its data are for.

    Args:
        source: The file of the stops.
        plane: The points of the stops in the plane, if they are not on the earth.
        waits: Whether some stops wait for others, whoever drives.
    """
    if plane:
        objectives = planar({"name": "total length", "coordinates": plane})
    else:
        objectives = measured(source, waits or have_times(stops, vehicles), stops)
        if any("per_distance" in vehicle for vehicle in vehicles):
            objectives[0]["name"] = "cost"
        if any("profile" in vehicle for vehicle in vehicles):
            objectives[0]["from"] = "road_distance"
    request = fleet_request(stops, vehicles, objectives, waits=waits)
    _measure(source, request, stops, vehicles)
    return request


def _measure(
    source: Source, request: FleetRequest, stops: Sequence[Stop], vehicles: Sequence[Vehicle]
) -> None:
    """Give a request the objectives that its prizes, and its times due or extra, are for.

    They take the place of the second objective, whose costs become those of the clock.
    """
    worthless = [stop["id"] for stop in stops if stop.get("prize") == 0]
    if worthless:
        source.note(
            "prize",
            f"{listed(worthless)} may be left out for nothing, as the prize is 0. Without a prize a"
            " stop must be visited.",
        )
    measures = dict(_measures(stops, vehicles))
    if not measures:
        return
    for number, means in zip(("second", "third"), measures.values(), strict=False):
        source.note("objectives", f"The {number} objective is {means}.")
    first, times = request["objectives"]
    measured: list[Objective] = [{"name": each, "measure": each} for each in measures]
    request["objectives"] = [first, *measured]
    if "clock" in request:
        del times["over"]
        request["clock"] = cast(ClockRequest, {**times, "name": "time"})


def _measures(stops: Sequence[Stop], vehicles: Sequence[Vehicle]) -> Iterator[tuple[Measure, str]]:
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
    return shortened([quoted(each) for each in texts], _MOST_NAMED)
