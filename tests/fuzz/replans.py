"""Requests to replan that no honest client sends, about stored fronts of all kinds."""

import json
import random
from collections.abc import Callable
from typing import Any

import numpy as np

from service.requests.replan.way import ReplanSource
from service.requests.task import TaskKind, TaskSource
from tests.fuzz.mutations import EXTREMES, TOKENS, mutated
from tests.helpers.changes import Found, front_of

_CITIES = 5
_MATRIX = [[abs(i - j) for j in range(_CITIES)] for i in range(_CITIES)]
_STOPS = [{"id": name, "location": [24.9 + i / 100, 60.1]} for i, name in enumerate("abcde")]
_OBJECTIVES = [{"name": "way", "from": "great_circle"}, {"name": "risk", "matrix": _MATRIX}]
_PLACES = [[0, 0], [0, 3], [2, 0], [2, 3], [1, 0]]
_GRID = {"grid": [[0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]], "cell_size": 1, "origin": [0, 0, 0]}
_FRONTS: list[tuple[TaskKind, dict[str, Any]]] = [
    ("front", {"coordinates": [[i, i * i, 5 - i, 1] for i in range(_CITIES)]}),
    ("front", {"matrices": [_MATRIX, _MATRIX]}),
    ("front", {"stops": _STOPS, "objectives": _OBJECTIVES, "closed": False, "end": "e"}),
    ("coverage", {**_GRID, "places": _PLACES, "cost_layer": [[1, 2, 3, 4]] * 3}),
    ("coverage", {**_GRID, "places": _PLACES, "second_matrix": _MATRIX}),
]


def replan(rng: random.Random) -> ReplanSource:
    """Return a request of random changes to a front, of any kind, with tokens put into its JSON."""
    kind, request = rng.choice(_FRONTS)
    changes = {name: make(rng) for name, make in _CHANGES.items() if rng.random() < 1 / 8}
    body = json.dumps({"time_limit": 0.02, **changes}).encode()
    if rng.random() < 1 / 4:
        body = mutated(rng, body, TOKENS, len(body))
    source = TaskSource(kind, json.dumps({**request, "time_limit": 0.02}).encode())
    found = Found(_TOURS, _LENGTHS, request.get("places"))
    return ReplanSource(body, front_of(source, found))


_TOURS, _LENGTHS = np.arange(_CITIES)[np.newaxis], np.ones((1, 2))


def _reference(rng: random.Random) -> Any:
    return rng.choice([0, 1, 2, 3, 4, "0", "a", "e", "new", 9, "x", 2**31 - 1])


def _references(rng: random.Random) -> list[Any]:
    return [_reference(rng) for _ in range(rng.choice((0, 1, 1, 2, 5, 300)))]


def _number(rng: random.Random) -> float:
    return rng.choice((1, -1)) * rng.choice(EXTREMES)


def _cell(rng: random.Random) -> list[int]:
    return [rng.choice((0, 1, 2, 3, 2**31 - 1)), rng.choice((0, 1, 2, 3))]


def _cells(rng: random.Random) -> list[list[int]]:
    return [_cell(rng) for _ in range(rng.choice((1, 2, 40)))]


def _place(rng: random.Random) -> Any:
    """A new stop or place, with what it may need, or needs not."""
    if rng.random() < 1 / 3:
        return _cell(rng)
    row = [rng.choice((0.0, 1.0, 1e150)) for _ in range(rng.choice((_CITIES, 6, 7)))]
    members: dict[str, Any] = {
        "location": rng.choice([[24.9, 60.1], [180, 90], [0, 0]]),
        "coordinates": rng.choice([[[_number(rng), 0], [0, 1]], [None, None]]),
        "costs": rng.choice([[{"to": row}] * 2, [None, {"to": row, "from": row}]]),
    }
    chosen = rng.sample(sorted(members), rng.randint(0, 2))
    return {
        "id": rng.choice(["new", "other", "a", "0"]),
        **{name: members[name] for name in chosen},
    }


def _entries(rng: random.Random) -> list[dict[str, Any]]:
    return [
        {
            "objective": rng.choice([0, 1, "way", "first", 7]),
            "from": _reference(rng),
            "to": _reference(rng),
            "cost": abs(_number(rng)),
        }
        for _ in range(rng.randint(1, 3))
    ]


def _layer(rng: random.Random) -> list[list[float]]:
    rows, columns = rng.choice(((3, 4), (3, 4), (1, 1)))
    return [[rng.choice((0.0, 1.0, 1e150)) for _ in range(columns)] for _ in range(rows)]


def _grid(rng: random.Random) -> list[list[float]]:
    return [[rng.choice((0, 0, 0, 1)) for _ in range(4)] for _ in range(3)]


_CHANGES: dict[str, Callable[[random.Random], Any]] = {
    "done": _references,
    "remove": _references,
    "tour": lambda rng: rng.sample(range(_CITIES), _CITIES),
    "position": lambda rng: rng.choice([_reference, _place])(rng),
    "add": lambda rng: [_place(rng) for _ in range(rng.choice((1, 2, 60)))],
    "costs": _entries,
    "objectives": lambda rng: rng.choice([_OBJECTIVES, _OBJECTIVES[:1]]),
    "min_kept": lambda rng: rng.choice((0, 0.5, 1, 1.5)),
    "reference_point": lambda rng: [abs(_number(rng)), 1e3],
    "pose": lambda rng: [_number(rng), 1.5],
    "grid": _grid,
    "blocked": _cells,
    "freed": _cells,
    "cost_layer": _layer,
    "paths": lambda _: True,
}
