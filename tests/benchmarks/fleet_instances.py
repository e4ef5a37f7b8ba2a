"""The fleets that are planned: requests of POST /fleet, made from a recipe or read from files."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from pydantic_core import to_json

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile
from service.fleet.evaluation import points_of
from service.fleet.fleet import Array, Fleet
from service.fleet.plans import Plan, Route
from service.requests.fleet import parse_fleet_request
from service.settings import Settings

_MOST_STOPS = 10_000
_DAY = 6000.0  # of those that load again, whose depot is at most 708 from a stop
_RELOADING = 0.06  # vehicles a stop, of which each does three or four trips of seven stops
CAPACITIES = {10: 30, 20: 30, 50: 40, 100: 50}  # of Bi-CVRP, by customers


class FleetInstance(NamedTuple):
    """A request without its time limit; the fleet it asks for, and the least distance known."""

    name: str
    request: dict[str, Any]
    fleet: Fleet
    least_known: float | None = None


def settings() -> Settings:
    """Return the settings of a service that plans all of them, for as long as it takes."""
    return Settings(
        max_fleet_stops=_MOST_STOPS,
        max_matrix_cities=_MOST_STOPS,
        max_body_bytes=2**28,
        max_time_limit=3600.0,
    )


def uniform(n: int, seed: int) -> FleetInstance:
    """Return the fleet of n stops with this number: uniform places, demands 1 to 29."""
    random = np.random.default_rng([n, seed])
    places = 1000 * random.random((n + 1, 2))
    return _with_capacity(f"{n}/{seed}", places, random.integers(1, 30, n).tolist(), 200)


def bi_cvrp(n: int, seed: int) -> FleetInstance:
    """Return the fleet of n customers with this number, in the unit square, demands 1 to 9."""
    random = np.random.default_rng([n, seed])
    places = random.random((n + 1, 2))
    demands = random.integers(1, 10, n).tolist()
    return _with_capacity(f"{n}/{seed}", places, demands, CAPACITIES[n])


def reloading(n: int, seed: int) -> FleetInstance:
    """Return the fleet of n stops with this number, whose few vehicles load three or four times.

    Places are uniform in a square with the depot in its middle, demands 1 to 29, capacity 100;
    every second stop has a window of a fifth of the day.
    """
    random = np.random.default_rng([n, seed])
    places = np.vstack([[500.0, 500.0], 1000 * random.random((n, 2))])
    made = _with_capacity(f"{n}/{seed}", places, random.integers(1, 30, n).tolist(), 100)
    stops, (vehicle,) = made.request["stops"], made.request["vehicles"]
    begins = random.uniform(0.1 * _DAY, 0.7 * _DAY, n).tolist()
    for number, (stop, begin) in enumerate(zip(stops[1:], begins, strict=True)):
        stop |= {"service": 20}
        if number % 2:
            stop |= {"window": [begin, begin + 0.2 * _DAY]}
    vehicle |= {"count": round(_RELOADING * n), "shift": [0, _DAY], "reload": ["0"]}
    request = {**made.request, "clock": "longest route"}
    return FleetInstance(made.name, request, fleet_of(request))


def read_instance(folder: Path, name: str, *, counts_vehicles: bool) -> FleetInstance:
    """Return the instance of a file, as the service reads it.

    Its objectives are the distance and the number of vehicles, or total and longest route. If the
    folder has a file of the best known routes as well, their distance is the least known.

    Args:
        folder: Holds the file, NAME.txt or NAME.vrp in any case, maybe in folders of its own.
        name: The name in capitals, as of CVRPLIB.
        counts_vehicles: Whether the second objective is the number of vehicles.

    Raises:
        SystemExit: There is no such file.
    """
    path = _found(folder, name, ".vrp" if name.startswith("X") else ".txt")
    if path is None:
        raise SystemExit(f"there is no file of {name} in {folder}")
    bounds = Bounds(cities=_MOST_STOPS, matrix_cities=_MOST_STOPS, cells=2**28)
    read = read_files([NamedFile(path.name, path.read_bytes())], bounds, wanted="fleet")
    request = _counting(read.request) if counts_vehicles else read.request
    fleet = fleet_of(request)
    solution = _found(folder, name, ".sol")
    known = None if solution is None else _distance(fleet, solution)
    return FleetInstance(name, request, fleet, known)


def fleet_of(request: dict[str, Any]) -> Fleet:
    """Return the fleet that a request asks for, as the service reads it."""
    return parse_fleet_request(to_json(request), settings().limits).subject().fleet()


def _with_capacity(name: str, places: Array, demands: list[int], capacity: int) -> FleetInstance:
    stops = [{"id": str(stop)} for stop in range(len(places))]
    for stop, demand in zip(stops[1:], demands, strict=True):
        stop |= {"demand": [demand]}  # type: ignore[dict-item]
    vehicle = {"id": "vehicle", "count": len(demands), "start": "0", "end": "0"}
    objectives = [
        {"name": name, "coordinates": places.tolist(), "over": over}
        for name, over in (("total", "sum"), ("longest route", "max"))
    ]
    request = {
        "stops": stops,
        "vehicles": [{**vehicle, "capacity": [capacity]}],
        "objectives": objectives,
    }
    return FleetInstance(name, request, fleet_of(request))


def _counting(request: dict[str, Any]) -> dict[str, Any]:
    """Return a request under distance and the number of vehicles. Its times stay what they were."""
    first, second = request["objectives"]
    objectives = [
        {**first, "name": "distance", "over": "sum"},
        {"name": "vehicles", "measure": "vehicles"},
    ]
    if "clock" not in request:
        return {**request, "objectives": objectives}
    clock = {key: value for key, value in second.items() if key != "over"}
    return {**request, "objectives": objectives, "clock": {**clock, "name": "time"}}


def _found(folder: Path, name: str, suffix: str) -> Path | None:
    """Return the first file of this name in any case, within folders as well."""
    wanted = f"{name}{suffix}".lower()
    paths = (path for path in sorted(folder.rglob("*")) if path.name.lower() == wanted)
    return next(paths, None)


def _distance(fleet: Fleet, solution: Path) -> float:
    """Return the first length of the routes in a file of CVRPLIB, whose customers are numbered.

    Where vehicles differ, each route is that of the vehicle of its number.
    """
    lines = solution.read_text(encoding="utf-8").splitlines()
    routes = [line.partition(":")[2].split() for line in lines if line.lower().startswith("route")]
    types = fleet.rules.vehicles
    kinds = [kind for kind, each in enumerate(types) for _ in range(each.count)]
    driven = zip(kinds if len(types) > 1 else [0] * len(routes), routes, strict=False)
    plan = Plan(tuple(Route(kind, tuple(map(int, stops))) for kind, stops in driven if stops))
    return round(float(points_of(fleet, [plan])[0, 0]), 3)
