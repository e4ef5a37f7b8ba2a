"""Let the times of a small fleet spread from day to day, and maybe trade that."""

import random
from typing import Any

from tests.fuzz.fleets_judged.day import is_over_the_day
from tests.fuzz.fleets_judged.timeline import Json
from tests.fuzz.fleets_judged.waits import has_waits


def add_spread(rng: random.Random, request: Json) -> None:
    """Let the clock's times spread where they may."""
    if request.get("clock") is None or has_waits(request):
        return
    clock = request["clock"]
    items = [each for each in (*request["objectives"], clock) if isinstance(each, dict)]
    timed = next(each for each in items if each is clock or each.get("name") == clock)
    if rng.random() < 0.5 and "matrix" in timed and not is_over_the_day(request):
        days = _days(rng, timed["matrix"])
        alike = [each for each in items if each.get("matrix") is timed["matrix"]]
        if isinstance(clock, dict) and len(alike) > 1:
            return
        for each in alike:
            del each["matrix"]
            each["days"] = days
    else:
        timed["spread"] = rng.choice((0.0, 0.1, 0.3, 0.6))
    if rng.random() < 0.8:
        _trade(rng, request, timed)


def _trade(rng: random.Random, request: Json, timed: Json) -> None:
    """Let the times be a percentile, or count late visits."""
    last = request["objectives"][-1]
    asked = False
    if any({"due", "window", "windows"} & each.keys() for each in request["stops"]):
        asked = rng.random() < 0.6 and last is not timed
        if asked:
            request["objectives"][-1] = {"name": last["name"], "measure": "on_time"}
    if request["clock"] == timed.get("name") and rng.random() < 0.6:
        asked = True
        timed["percentile"] = rng.choice((50, 80, 90, 99))
        for vehicle in request["vehicles"] if timed is request["objectives"][0] else ():
            for name in ("per_distance", "per_time"):
                vehicle.pop(name, None)
    for vehicle in request["vehicles"] if asked else ():
        vehicle.pop("breaks", None)


def _days(rng: random.Random, matrix: Any) -> list[Json]:
    """Return the costs of two to six days, some of which are slow."""

    def changed(cost: float | None, slow: float) -> float | None:
        return None if cost is None else round(cost * slow * rng.uniform(0.8, 1.3), 2)

    paces = [rng.choice((0.7, 1.0, 1.0, 2.0)) for _ in range(rng.randint(2, 6))]
    return [{"matrix": [[changed(cost, slow) for cost in row] for row in matrix]} for slow in paces]
