"""A request of each kind, so large that no search of it converges, and what its answer is."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

CITIES = 50
_SIDE = 20  # cells of a map


@dataclass(frozen=True)
class Asked:
    """A request of a kind.

    Args:
        command: The arguments of the command that plans it from standard input.
        path: The path to post it to.
        body: Its members, without options.
        kind: The kind of its answer.
        column: The last column of its CSV.
        objectives: How many it has.
    """

    command: tuple[str, ...]
    path: str
    body: Mapping[str, Any]
    kind: str
    column: str
    objectives: int = 2


def stops() -> dict[str, Any]:
    """Return the members of a request of stops on the earth, and two objectives."""
    random = np.random.default_rng(1)
    places = random.uniform((24.9, 60.15), (25.0, 60.2), (CITIES, 2)).tolist()
    return {
        "stops": [{"id": f"stop-{i}", "location": place} for i, place in enumerate(places)],
        "objectives": [
            {"name": "way", "from": "great_circle"},
            {"name": "risk", "coordinates": random.random((CITIES, 2)).tolist()},
        ],
    }


def on_map() -> dict[str, Any]:
    """Return the members of a request of places on a map."""
    random = np.random.default_rng(2)
    cells = random.choice(_SIDE * _SIDE, CITIES, replace=False)
    places = np.column_stack(np.divmod(cells, _SIDE)).tolist()
    return {"grid": [[0] * _SIDE] * _SIDE, "cell_size": 0.5, "places": places}


def over_the_day() -> dict[str, Any]:
    """Return the members of a request of stops whose first costs are dearer from 9 to 10."""
    times = np.random.default_rng(5).integers(60, 900, (CITIES, CITIES)).tolist()
    rush = [[0, 1.0], [9 * 3600, 1.5], [10 * 3600, 1.0]]
    time, risk = {"name": "time", "unit": "s", "matrix": times, "over_the_day": rush}, stops()
    return {**risk, "objectives": [time, risk["objectives"][0]], "departure": 8 * 3600}


def requests() -> Iterator[tuple[str, Asked]]:
    """Yield a request of each kind, by its name in the tables of tests."""
    plane = np.random.default_rng(3).random((CITIES, 2)).tolist()
    cities = np.random.default_rng(4).random((CITIES, 4)).tolist()
    vehicles = [{"id": "van", "count": 4, "start": 0, "end": 0, "capacity": [15]}]
    fleet = stops()
    for stop in fleet["stops"][1:]:
        stop["demand"] = [1]
    robots = [{"id": f"robot-{i}", "start": i} for i in range(3)]
    covered = {**on_map(), "second_coordinates": plane}
    yield "cities", Asked(("front",), "/front", {"coordinates": cities}, "front", "tour")
    yield "stops", Asked(("front",), "/front", stops(), "front", "tour")
    yield "coverage", Asked(("coverage",), "/coverage", covered, "coverage", "tour")
    shared = {**on_map(), "robots": robots}
    yield "robots", Asked(("coverage",), "/coverage", shared, "robots", "places")
    yield "fleet", Asked(("fleet",), "/fleet", {**fleet, "vehicles": vehicles}, "fleet", "stops")
    several = np.random.default_rng(6).random((CITIES, 6)).round(3).tolist()
    yield "three", Asked(("front",), "/front", {"coordinates": several}, "front", "tour", 3)
    yield "day", Asked(("front",), "/front", over_the_day(), "front", "tour")
    layer = np.random.default_rng(7).integers(1, 9, (_SIDE, _SIDE)).tolist()
    costly = {**on_map(), "cost_layer": layer, "detours": True}
    yield "detours", Asked(("coverage",), "/coverage", costly, "coverage", "tour")
    morning = {"robot_speed": 0.5, "departure": 9 * 3600 - 60}
    rush = [[0, 1.0], [9 * 3600, 1.5]]
    timed = {**covered, **morning, "over_the_day": [rush, []]}
    yield "day on a map", Asked(("coverage",), "/coverage", timed, "coverage", "tour")
    timed = {**shared, **morning, "over_the_day": [rush]}
    yield "day of robots", Asked(("coverage",), "/coverage", timed, "robots", "places")


def rest_of(kind: str, front: Mapping[str, Any]) -> Asked:
    """Return the request to replan a front of a kind, after its first stop or place."""
    command, path = ("replan", front["id"]), f"/front/{front['id']}/replan"
    if kind == "coverage":
        return Asked(command, path, {"done": [0], "paths": True}, kind, "tour")
    if kind == "fleet":
        done = front["front"][0]["routes"][0]["stops"][1:2]
        return Asked(
            command, path, {"plan": 0, "routes": [{"route": 0, "done": done}]}, kind, "stops"
        )
    return Asked(command, path, {"done": ["stop-0"]}, "front", "tour")


def as_input(asked: Asked, **options: Any) -> bytes:
    """Return a request with options as standard input."""
    return json.dumps({**asked.body, **options}).encode()
