"""A plan that was promised: who should visit each stop, and when, by the words of the guide."""

import random
from math import inf
from typing import NamedTuple

from tests.fuzz.fleets_judged.timeline import Bounds, Json, is_later


class Promise(NamedTuple):
    """The number of the route that should visit a stop, and until when the visit begins."""

    route: int
    until: float


def promises_of(request: Json) -> dict[int, Promise]:
    """Return what is promised of each stop."""
    plan = request.get("promised") or {"routes": []}
    found = {}
    for number, route in enumerate(plan["routes"]):
        arrivals = route.get("arrivals") or [0.0] * len(route["stops"])
        for stop, arrival in zip(route["stops"], arrivals, strict=True):
            until = inf
            if plan.get("tolerance") is not None:
                until = _begin(request, stop, arrival) + plan["tolerance"]
            found[stop] = Promise(number, until)
    return found


def bounds_of_promises(request: Json) -> Bounds:
    """Return until when no vehicle that leaves later than it must makes promised visits begin."""
    if all(each.get("measure") != "changes" for each in request["objectives"]):
        return {}
    return {stop: (0.0, each.until) for stop, each in promises_of(request).items()}


def types_by_promise(request: Json, vehicles: list[Json]) -> list[Json]:
    """Return types of vehicles of which each route of the promised plan has its own."""
    routes = (request.get("promised") or {"routes": []})["routes"]
    found = []
    for vehicle in vehicles:
        own = [
            number
            for number, route in enumerate(routes)
            if (route["vehicle"], route.get("shift", 0)) == (vehicle["id"], vehicle["number"])
        ]
        found += [{**vehicle, "count": 1, "route": number} for number in own]
        if left := vehicle.get("count", 1) - len(own):
            found.append({**vehicle, "count": left})
    return found


def add_promises(rng: random.Random, request: Json, clients: list[int]) -> None:
    """Promise some stops to some vehicles, and trade changes of that, unless that is the clock."""
    routes: list[Json] = []
    for vehicle in request["vehicles"]:
        for _ in range(rng.randint(0, min(2, vehicle["count"]))):
            shift = {"shift": rng.randrange(len(vehicle["shifts"]))} if "shifts" in vehicle else {}
            routes.append({"vehicle": vehicle["id"], **shift, "stops": []})
    name = request["objectives"][-1]["name"]
    if not routes or name == request.get("clock"):
        return
    for stop in rng.sample(clients, rng.randint(1, len(clients))):
        rng.choice(routes)["stops"].append(stop)
    request["promised"] = {"routes": [each for each in routes if each["stops"]]}
    request["objectives"][-1] = {"name": name, "measure": "changes"}
    if request.get("clock") is not None and rng.random() < 0.7:
        _add_tolerance(rng, request)


def _add_tolerance(rng: random.Random, request: Json) -> None:
    """Promise times as well; then vehicles do not rest."""
    request["promised"]["tolerance"] = round(rng.uniform(0, 20), 1)
    for route in request["promised"]["routes"]:
        route["arrivals"] = sorted(round(rng.uniform(0, 90), 1) for _ in route["stops"])
    for vehicle in request["vehicles"]:
        vehicle.pop("breaks", None)


def _begin(request: Json, stop: int, arrival: float) -> float:
    """Return when a promised visit begins, given when its vehicle arrives."""
    visit, slack = request["stops"][stop], request.get("slack", 0.0)
    windows = visit.get("windows") or ([visit["window"]] if visit.get("window") else [])
    opens = [a for a, b in windows if not is_later(arrival, b - slack)]
    return max(arrival, opens[0] if opens else arrival)
