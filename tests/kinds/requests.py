"""A request of each kind, so large that no search of it converges, and what its answer is."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

CITIES = 100
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
    """

    command: tuple[str, ...]
    path: str
    body: Mapping[str, Any]
    kind: str
    column: str


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


def requests() -> Iterator[tuple[str, Asked]]:
    """Yield a request of each kind, by its name in the tables of tests."""
    plane = np.random.default_rng(3).random((CITIES, 2)).tolist()
    cities = np.random.default_rng(4).random((CITIES, 4)).tolist()
    vehicles = [{"id": "van", "count": 4, "start": 0, "end": 0, "capacity": [30]}]
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


def rest_of(kind: str, front: str) -> Asked:
    """Return the request to replan a front of a kind, after its first stop or place."""
    path = f"/front/{front}/replan"
    if kind == "coverage":
        return Asked(("replan", front), path, {"done": [0], "paths": True}, kind, "tour")
    return Asked(("replan", front), path, {"done": ["stop-0"]}, "front", "tour")


def as_input(asked: Asked, **options: Any) -> bytes:
    """Return a request with options as standard input."""
    return json.dumps({**asked.body, **options}).encode()
