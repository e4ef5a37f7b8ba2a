"""Requests for fleets that no honest client sends: mutated ones, and ones of extreme numbers."""

import json
import random
from collections.abc import Callable
from typing import Any, get_args

from service.fleet.measures.table import Measure
from service.requests.task import TaskSource
from tests.fuzz.mutations import EXTREMES, TOKENS, mutated

Number = Callable[[], float]


def fleet(rng: random.Random) -> TaskSource:
    """Return JSON of a request for a fleet with tokens put in, or cut short."""
    body = json.dumps(_request(rng, lambda: rng.choice((0, 1, 2.5)))).encode()
    return TaskSource("fleet", mutated(rng, body, TOKENS, len(body)))


def extreme_fleet(rng: random.Random) -> TaskSource:
    """Return a request of numbers from 5e-324 to 1e308, of all scales or of one or two."""
    scales = rng.choice([EXTREMES, (rng.choice(EXTREMES),), rng.sample(EXTREMES, 2)])
    request = _request(rng, lambda: rng.choice(scales) * rng.choice((1, rng.random())))
    return TaskSource("fleet", json.dumps(request).encode())


def bounded_fleet(rng: random.Random) -> TaskSource:
    """Return a request of common or extreme numbers with any of the bounds of dispatchers."""
    scales = rng.choice([(1, 10, 100), EXTREMES])
    request = _request(rng, lambda: rng.choice(scales) * rng.choice((1, rng.random())))
    _add_bounds(rng, request, lambda: rng.choice(scales) * rng.choice((1, 5, rng.random())))
    return TaskSource("fleet", json.dumps(request).encode())


def _add_bounds(rng: random.Random, request: dict[str, Any], number: Number) -> None:
    """Add any of the bounds to the stops and vehicles of a request, and a measure."""
    timed = "clock" in request
    for stop in request["stops"][1:]:
        times = {"due": number(), "release": number()} if timed else {}
        if timed and "window" not in stop:
            times["windows"] = _spans(number)
        bounds = {"skills": ["cold"], "vehicle": rng.choice("01"), **times}
        stop |= {name: bounds[name] for name in bounds if rng.random() < 1 / 5}
    for vehicle in request["vehicles"]:
        rest = {"window": _span(number), "length": number()}
        times = {"max_overtime": number(), "breaks": [rest]} if timed else {}
        if timed and "shift" not in vehicle:
            times["shifts"] = _spans(number)
        trips = rng.choice([{"max_stops": rng.choice((1, 4))}, {"reload": [0], "max_trips": 2}])
        bounds = {"skills": ["cold"], "initial_load": [rng.choice((0, 5))], **trips, **times}
        vehicle |= {name: bounds[name] for name in bounds if rng.random() < 1 / 2}
    measures = rng.sample([each for each in get_args(Measure) if each != "changes"], 2)
    if request.get("clock") != "b" and rng.random() < 2 / 3:
        request["objectives"][1] = {"name": "b", "measure": measures[0]}
    if rng.random() < 1 / 2:
        costs = {**request["objectives"][0], "over": rng.choice(["sum", "max"])}
        third = rng.choice([costs, {"measure": measures[1]}])
        request["objectives"].append({**third, "name": "c"})


def _spans(number: Number) -> list[list[float]]:
    """Return two windows or shifts, in order but for equal times."""
    times = sorted(number() for _ in range(4))
    return [times[:2], times[2:]]


def _request(rng: random.Random, number: Number) -> dict[str, Any]:
    """Return a request of up to eleven stops, with any of the members that there are."""
    n = rng.randint(1, 11)
    clock = rng.choice(["a", "b", None])

    def given(**members: Any) -> dict[str, Any]:
        chosen = rng.sample(sorted(members), rng.randint(0, len(members)))
        return {name: members[name] for name in chosen}

    def stop(index: int) -> dict[str, Any]:
        timed = given(window=_span(number), service=number()) if clock else {}
        some = given(demand=[rng.choice((0, 1, 10**9))], prize=number())
        return {"id": str(index), "location": [24.9 + index / 100, 60.1], **timed, **some}

    def vehicle(index: int) -> dict[str, Any]:
        timed = given(shift=_span(number), longest=number()) if clock else {}
        count, capacity = rng.choice((1, 3, 10**6)), [rng.choice((0, 9, 10**9))]
        some = given(start=0, end=0, fixed=number(), count=count)
        return {"id": str(index), "capacity": capacity, **some, **timed}

    def objective(name: str) -> dict[str, Any]:
        sources: dict[str, Any] = {
            "matrix": [[number() for _ in range(n)] for _ in range(n)],
            "coordinates": [[number(), number()] for _ in range(n)],
            "from": "great_circle",
        }
        source = rng.choice(sorted(sources))
        speed = (
            {"speed": rng.choice((0.001, 30, 1000))}
            if source == "from" and rng.random() < 1 / 2
            else {}
        )
        return {"name": name, source: sources[source], **speed}

    return {
        "stops": [{"id": "0", "location": [24.9, 60.1]}, *(stop(index) for index in range(1, n))],
        "vehicles": [vehicle(index) for index in range(rng.randint(1, 2))],
        "objectives": [objective("a"), {**objective("b"), "over": rng.choice(["sum", "max"])}],
        **({"clock": clock} if clock else {}),
        "time_limit": rng.choice([0, 0.02]),
        **given(size=3),
    }


def _span(number: Number) -> list[float]:
    return sorted((number(), number()))
