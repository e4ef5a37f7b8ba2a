"""Let the costs of a small fleet change over the day, or its matrices stay as they are."""

import random
from typing import Any

from tests.fuzz.fleets_judged.timeline import Json

OVER_THE_DAY = 0.35  # share of fleets with a clock and few stops to visit
_MOST = 3  # stops to visit, so that all plans are soon tried
_UNDATED = ("overlap",)  # measures whose costs are means of the day


def may_have_day(request: Json, clients: int) -> bool:
    """Return whether the costs of a fleet of some stops to visit may change over the day."""
    waits = any(each.get("vehicles") == "any" for each in request.get("before", ()))
    measures = {each.get("measure") for each in request["objectives"]}
    timed = request.get("clock") is not None
    return timed and clients <= _MOST and not waits and measures.isdisjoint(_UNDATED)


def add_day(rng: random.Random, request: Json) -> None:
    """Let the clock's costs change over the day, and maybe the others."""
    clock = request["clock"]
    named = {each["name"]: each for each in request["objectives"]}
    timed = named[clock] if isinstance(clock, str) else clock
    items = [each for each in (*request["objectives"], clock) if isinstance(each, dict)]
    by_costs: dict[int, list[Json]] = {}
    for item in items:
        costs = item.get("matrix", item.get("matrices"))
        if costs is not None:
            by_costs.setdefault(id(costs), []).append(item)
    for alike in by_costs.values():
        is_clock = any(each is timed for each in alike)
        if is_clock or rng.random() < 0.6:
            _change(rng, alike, request)


def _change(rng: random.Random, items: list[Json], request: Json) -> None:
    """Let the costs of some items change alike."""
    item = items[0]
    kind = rng.choice(("over_the_day", "slices", "breakpoints"))
    begins = sorted(rng.sample(range(0, 150, 5), rng.randint(1, 4)))
    if kind == "over_the_day" or (kind == "breakpoints" and "matrices" in item):
        factors = [[begin, round(rng.uniform(0.3, 3.0), 1)] for begin in begins]
        members: Json = {"over_the_day": factors}
    elif "matrices" in item:
        own = [(each["profile"], each["matrix"]) for each in item["matrices"]]
        changed = [{"profile": name, "slices": _slices(rng, each, begins)} for name, each in own]
        members = {"matrices": changed}
    elif kind == "slices":
        members = {"slices": _slices(rng, item["matrix"], begins)}
    else:
        members = {"breakpoints": _breakpoints(rng, item["matrix"])}
        for vehicle in request["vehicles"]:  # who is slower could arrive earlier by leaving later
            if vehicle.get("speed_factor", 1.0) < 1:
                del vehicle["speed_factor"]
    for each in items:
        each |= members
        if kind in ("slices", "breakpoints") and "matrices" not in each:
            each.pop("matrix", None)


def _slices(rng: random.Random, matrix: Any, begins: list[int]) -> list[Json]:
    def changed(cost: float | None) -> float | None:
        return None if cost is None else round(cost * rng.uniform(0.4, 2.5), 2)

    return [
        {"from": begin, "matrix": [list(map(changed, row)) for row in matrix]} for begin in begins
    ]


def _breakpoints(rng: random.Random, matrix: Any) -> list[list[Any]]:
    """Return breakpoints of each pair that has a way; who leaves later arrives no earlier."""

    def pairs(cost: float) -> list[list[float]]:
        found = [[rng.randint(0, 40), cost]]
        for _ in range(rng.randint(0, 4)):
            time, last = found[-1]
            step = rng.randint(1, 40)
            found.append([time + step, max(0.0, last + rng.uniform(-1.0, 1.5) * step)])
        return found

    return [
        [None if i == j or cost is None else pairs(cost) for j, cost in enumerate(row)]
        for i, row in enumerate(matrix)
    ]
