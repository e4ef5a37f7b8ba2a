"""Draw small fleets with all rules of the form, and some with bounds where routes arrive."""

import copy
import random
from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import Any, NamedTuple

from tests.fuzz.fleets_judged.days import OVER_THE_DAY, add_day, may_have_day
from tests.fuzz.fleets_judged.promises import add_promises
from tests.fuzz.fleets_judged.spreads import add_spread
from tests.fuzz.fleets_judged.timeline import Json
from tests.fuzz.fleets_judged.waits import has_waits

_MEASURES = (
    *("vehicles", "unassigned", "overtime", "lateness", "imbalance", "load_distance"),
    *("earliness", "weighted_arrival", "overlap"),
)
TAKING = 0.3  # share of fleets with stops that put something on board
WAITING = 0.5  # share of fleets with groups whose visits wait for others, if there is a clock
SPREADING = 0.15  # share of fleets whose times spread, if there is a clock
PROMISED = 0.12  # share of fleets of which a plan was promised
PROFILED = 0.2  # share of fleets whose vehicles have profiles
_RESTLESS = ("earliness", "weighted_arrival", "on_time")  # they are refused beside breaks
_TIMED = ("overtime", "lateness", "earliness", "weighted_arrival")


def random_fleet(rng: random.Random) -> Json:
    """Return a request of up to five stops to visit and two types of vehicles."""
    clients = rng.randint(1, 5)
    depots = rng.choice((1, 1, 2))
    n = clients + depots
    matrices = [_matrix(rng, n), _matrix(rng, n)]
    timed = rng.random() < 0.85
    request: Json = {
        "stops": [{"id": str(i)} for i in range(n)],
        "shipments": [],
        "objectives": _objectives(rng, matrices, timed),
    }
    if timed:
        _add_clock(rng, request, matrices)
    dimensions = rng.choice((0, 1, 1, 2))
    measures = {each.get("measure") for each in request["objectives"]}
    if "load_distance" in measures:
        dimensions = 1
    for stop in request["stops"][depots:]:
        stop |= _visit(rng, timed, dimensions, measures)
    maximum = any(each.get("over") == "max" for each in request["objectives"])
    request["vehicles"] = [
        _vehicle(rng, str(i), _Form(n, depots, timed, dimensions, maximum), measures)
        for i in range(rng.choice((1, 2, 2)))
    ]
    if clients > 1 and rng.random() < 0.25:
        _add_shipment(request, n)
    elif clients > 2 and rng.random() < 0.3:
        _add_groups(rng, request, [*range(depots, n)])
    _add_some(rng, request, matrices, depots)
    return request


def _add_some(rng: random.Random, request: Json, matrices: Sequence[Any], depots: int) -> None:
    """Add what only some fleets have: vehicles that differ, limits on driving, and profiles."""
    timed = request.get("clock") is not None
    if rng.random() < 0.4:
        _add_differences(rng, request, depots, timed)
    if rng.random() < 0.2:
        _add_limits(rng, request, timed)
    if rng.random() < TAKING:
        _add_pickups(rng, request)
    if rng.random() < PROFILED:
        _add_profiles(rng, request, matrices)
    if may_have_day(request, len(matrices[0]) - depots) and rng.random() < OVER_THE_DAY:
        add_day(rng, request)
    if rng.random() < SPREADING:
        add_spread(rng, request)
    elif rng.random() < PROMISED:
        add_promises(rng, request, [*range(depots, len(matrices[0]))])


def _add_pickups(rng: random.Random, request: Json) -> None:
    """Let some stops put something on board, where vehicles do not load again."""
    dimensions = len(request["vehicles"][0].get("capacity", ()))
    shipped = {stop for each in request["shipments"] for stop in each.values()}
    if not dimensions or any("reload" in vehicle for vehicle in request["vehicles"]):
        return
    for number, stop in enumerate(request["stops"]):
        if "demand" in stop and number not in shipped and rng.random() < 0.7:
            stop["pickup"] = [rng.randint(0, 4) for _ in range(dimensions)]


def _add_profiles(rng: random.Random, request: Json, matrices: Sequence[Any]) -> None:
    """Let vehicles drive by two profiles, whose costs differ."""
    for matrix in rng.choice((matrices, matrices[:1])):
        truck = _matrix(rng, len(matrix))
        by_profile = [{"profile": "car", "matrix": matrix}, {"profile": "truck", "matrix": truck}]
        for item in (*request["objectives"], request.get("clock")):
            if isinstance(item, dict) and item.get("matrix") is matrix:
                del item["matrix"]
                item["matrices"] = by_profile
    for vehicle in request["vehicles"]:
        vehicle["profile"] = rng.choice(("car", "truck"))


def _add_groups(rng: random.Random, request: Json, clients: list[int]) -> None:
    """Let some stops ride together, some apart, and some in order; and routes be long."""
    together = rng.sample(clients, 2)
    other = rng.choice([stop for stop in clients if stop not in together])
    groups: Json = {
        "together": [together],
        "apart": [rng.choice(({"stops": together[:1], "others": [other]}, {"stops": [other]}))],
        "before": [{"first": rng.sample(clients, 1), "then": rng.sample(clients, 2)}],
    }
    request |= {name: each for name, each in groups.items() if rng.random() < 0.5}
    if request.get("clock") is not None and rng.random() < WAITING:
        add_waits(rng, request, clients)
    for vehicle in request["vehicles"]:
        if rng.random() < 0.3:
            vehicle["min_stops"] = min(2, vehicle.get("max_stops", 2))
        if "longest" in vehicle and rng.random() < 0.5:
            vehicle["shortest"] = _number(rng, 5, 30, 1)


def add_waits(rng: random.Random, request: Json, clients: list[int]) -> None:
    """Let some visits wait for others, whoever drives."""
    for vehicle in request["vehicles"]:
        for name in ("reload", "max_trips", "breaks"):
            vehicle.pop(name, None)
    order = rng.sample(clients, len(clients))
    waits = []
    for _ in range(rng.choice((1, 1, 2, 3))):
        a, b = sorted(rng.sample(range(len(order)), 2))
        item = {"first": [order[a]], "then": [order[b]], "vehicles": "any"}
        waits.append(item | ({"gap": _number(rng, 1, 20, 1)} if rng.random() < 0.4 else {}))
    request["before"] = [*request.get("before", ()), *waits]


def _matrix(rng: random.Random, n: int) -> list[list[float | None]]:
    digits = rng.choice((0, 2, None))
    costs: list[list[float | None]] = [
        [0.0 if i == j else _number(rng, 1.0, 30.0, digits) for j in range(n)] for i in range(n)
    ]
    if rng.random() < 0.15:
        i, j = rng.sample(range(n), 2)
        costs[i][j] = None
    return costs


def _number(rng: random.Random, least: float, most: float, digits: int | None = None) -> float:
    number = rng.uniform(least, most)
    return number if digits is None else round(number, digits)


def _objectives(rng: random.Random, matrices: Sequence[Any], timed: bool) -> list[Json]:
    """Return two or three objectives, named a, b and c."""
    a, b = matrices
    allowed = [m for m in _MEASURES if timed or m not in _TIMED]
    kind = rng.random()
    if kind < 0.5:
        second: Json = {"measure": rng.choice(allowed)}
    else:
        second = {"matrix": rng.choice((a, b)), "over": rng.choice(("sum", "max", "max"))}
    objectives = [{"name": "a", "matrix": a}, {"name": "b", **second}]
    if rng.random() < 0.3:
        others = [m for m in allowed if m != second.get("measure")]
        third: Json = {"measure": rng.choice(others)}
        if rng.random() < 0.4:
            used = second.get("matrix", b)
            over = "sum" if second.get("over") == "max" else rng.choice(("sum", "max"))
            third = {"matrix": used if used is not a else rng.choice(matrices), "over": over}
        objectives.append({"name": "c", **third})
    return objectives


def _add_clock(rng: random.Random, request: Json, matrices: Sequence[Any]) -> None:
    named = [each["name"] for each in request["objectives"] if "matrix" in each]
    request["clock"] = rng.choice(named)
    if len(named) == 1 and rng.random() < 0.5:
        request["clock"] = {"matrix": matrices[1]}
    if rng.random() < 0.2:
        request["slack"] = _number(rng, 1, 20, 1)
    if rng.random() < 0.2:
        request["leave"] = "early"


def _visit(rng: random.Random, timed: bool, dimensions: int, measures: set[Any]) -> Json:
    shares = {
        "prize": 1.0 if "unassigned" in measures else 0.3,
        "skills": 0.15,
        "vehicle": 0.1,
        "due": 0.9 if {"lateness", "earliness"} & measures else 0.2,
        "urgency": 0.7 if "weighted_arrival" in measures else 0.0,
        "service": 0.4,
        "release": 0.15,
    }
    found: Json = {
        "prize": _number(rng, 1, 60, 1),
        "skills": ["cold"],
        "vehicle": "0",
    }
    if timed:
        found["due"] = due = _number(rng, 5, 90, 2)
        if "earliness" in measures or rng.random() < 0.2:
            found["due"] = [_number(rng, 1, due, 2), due]
        found["urgency"] = _number(rng, 0, 4, 1)
        found["service"] = _number(rng, 0, 8, 2)
        found["release"] = _number(rng, 0, 40, 2)
    visit = {name: value for name, value in found.items() if rng.random() < shares[name]}
    if dimensions:
        visit["demand"] = [rng.randint(0, 4) for _ in range(dimensions)]
    kind = rng.random()
    times = sorted(_number(rng, 0, 120, 1) for _ in range(4))
    if timed and kind < 0.35:
        visit["window"] = [times[0], times[2]]
    elif timed and kind < 0.55 and times[1] < times[2]:
        visit["windows"] = [times[:2], times[2:]]
    return visit


class _Form(NamedTuple):
    """What the vehicles of a fleet may have."""

    n: int
    depots: int
    timed: bool
    dimensions: int
    maximum: bool


def _vehicle(rng: random.Random, name: str, form: _Form, measures: set[Any]) -> Json:
    end = rng.choice((0, 0, None, form.depots - 1))
    vehicle: Json = {"id": name, "start": rng.choice((0, 0, 0, None)), "end": end}
    vehicle["count"] = rng.choice((1, 2, 5, 5))
    found: Json = {"skills": ["cold"], "fixed": _number(rng, 0, 20, 1)}
    shares = {"skills": 0.7, "fixed": 0.3, "initial_load": 0.15, "longest": 0.2}
    if form.dimensions:
        vehicle["capacity"] = [rng.randint(4, 12) for _ in range(form.dimensions)]
        found["initial_load"] = [rng.randint(0, 4) for _ in range(form.dimensions)]
    if form.timed or form.maximum:
        found["longest"] = _number(rng, 30, 120, 2)
    vehicle |= {name: value for name, value in found.items() if rng.random() < shares[name]}
    trips = rng.random()
    if form.dimensions and form.n < 6 and trips < 0.3:
        vehicle["reload"] = [rng.randrange(form.depots)]
        vehicle |= rng.choice(({}, {"max_trips": 2}))
    elif trips < 0.45:
        vehicle["max_stops"] = rng.randint(1, 3)
    if form.timed:
        _add_times(rng, vehicle, measures)
    return vehicle


def _add_differences(rng: random.Random, request: Json, depots: int, timed: bool) -> None:
    for vehicle in request["vehicles"]:
        vehicle |= _differences(rng, timed)
    for stop in request["stops"][depots:] if timed else ():
        if rng.random() < 0.3:
            stop["services"] = [{"vehicle": "0", "service": _number(rng, 0, 8, 1)}]


def _add_limits(rng: random.Random, request: Json, timed: bool) -> None:
    """Bound how far vehicles drive, and how long."""
    clock, objectives = request.get("clock"), request["objectives"]
    far = any("matrix" in each and each["name"] != clock for each in objectives)
    for vehicle in request["vehicles"]:
        if far and rng.random() < 0.6:
            vehicle["max_distance"] = _number(rng, 20, 90, 1)
        if timed and rng.random() < 0.6:
            vehicle["max_driving"] = _number(rng, 20, 90, 1)


def _differences(rng: random.Random, timed: bool) -> Json:
    """Return in what a type of vehicles may differ from others: speeds and prices."""
    found = {"per_distance": _number(rng, 0, 3, 1)}
    if timed:
        found |= {name: _number(rng, 0.3, 3, 1) for name in ("speed_factor", "service_factor")}
        found["per_time"] = _number(rng, 0, 2, 1)
    return {name: value for name, value in found.items() if rng.random() < 0.4}


def _add_times(rng: random.Random, vehicle: Json, measures: set[Any]) -> None:
    overtime = "overtime" in measures
    if overtime or rng.random() < 0.6:
        begin = _number(rng, 0, 20, 1)
        vehicle["shift"] = [begin, begin + _number(rng, 30, 200, 1)]
        if overtime or rng.random() < 0.2:
            vehicle["max_overtime"] = _number(rng, 1, 40, 1)
        elif rng.random() < 0.15:
            end = vehicle["shift"][1]
            vehicle["shifts"] = [vehicle.pop("shift"), [end + 10, end + 150]]
    if rng.random() < 0.35 and not {"earliness", "weighted_arrival"} & measures:
        opens, wide, length = _number(rng, 5, 60, 2), _number(rng, 0, 15, 2), rng.randint(2, 30)
        rests = [{"window": [opens, opens + wide], "length": length}]
        if rng.random() < 0.3:
            later = opens + wide + length + _number(rng, 0.1, 20, 2)
            rests.append({"window": [later, later + wide], "length": 5})
        vehicle["breaks"] = rests


def _add_shipment(request: Json, n: int) -> None:
    """Make a shipment of the last two stops."""
    for vehicle in request["vehicles"]:
        for name in ("reload", "max_trips", "max_stops"):
            vehicle.pop(name, None)
    delivery = request["stops"][n - 1]
    for stop in request["stops"][n - 2 :]:
        stop.pop("release", None)
        if several := stop.pop("windows", None):
            stop["window"] = several[0]
    for name in ("demand", "prize"):
        delivery.pop(name, None)
    request["shipments"] = [{"pickup": n - 2, "delivery": n - 1}]


def with_bounds_at_arrivals(rng: random.Random, request: Json, plan: Json) -> Json:
    """Return a request whose windows, breaks and limits end exactly where a plan arrives or ends.

    The arrivals are added up in another order, so that they differ by roundings.
    """
    changed: Json = copy.deepcopy(request)
    for route in plan["routes"]:
        arrivals = route["arrivals"]
        first = arrivals[0]
        again = list(accumulate(b - a for a, b in pairwise(arrivals)))
        times = [first, *(first + each for each in again)]
        for stop, arrival, other in zip(route["stops"], arrivals, times, strict=True):
            _bound(rng, changed, changed["stops"][int(stop)], rng.choice((arrival, other)))
        vehicle = next(v for v in changed["vehicles"] if v["id"] == route["vehicle"])
        _bound_vehicle(rng, vehicle, times, rests=_may_rest(changed))
    return changed


def _bound(rng: random.Random, request: Json, stop: Json, time: float) -> None:
    """Let a window of a stop end at a time, or begin there; or the stop is due then."""
    vehicles = request["vehicles"]
    places = [[each.get("start"), each.get("end"), *each.get("reload", ())] for each in vehicles]
    if int(stop["id"]) in (place for each in places for place in each):
        return
    shipped = any(int(stop["id"]) in each.values() for each in request["shipments"])
    kind = rng.random()
    if kind < 0.6:
        for name in ("window", "windows"):
            stop.pop(name, None)
        first = [max(0.0, time - rng.choice((0.0, 1.5, 17.13))), time]
        if kind < 0.3 and not shipped:
            later = time + rng.choice((0.5, 60.0))
            stop["windows"] = [first, [later, later + rng.choice((1.0, 60.0))]]
        elif kind < 0.5:
            stop["window"] = first
        else:
            stop["window"] = [time, time + rng.choice((0.0, 10.0))]
    elif kind < 0.8:
        stop["due"] = time


def _may_rest(request: Json) -> bool:
    """Return whether no objective, and no visit that waits, forbids breaks."""
    measures = {each.get("measure") for each in request["objectives"]}
    of_days = any("percentile" in each for each in request["objectives"])
    tolerant = request.get("promised", {}).get("tolerance") is not None
    return measures.isdisjoint(_RESTLESS) and not (of_days or tolerant or has_waits(request))


def _bound_vehicle(rng: random.Random, vehicle: Json, times: list[float], *, rests: bool) -> None:
    """Let the shift, the longest route or a break end at times of a route."""
    if rng.random() < 0.4 and "shifts" not in vehicle:
        begin = max(0.0, times[0] - rng.choice((0.0, 0.0, 5.0)))
        vehicle["shift"] = [begin, max(begin, times[-1])]
    if rng.random() < 0.2 and times[-1] > times[0]:
        vehicle["longest"] = times[-1] - times[0]
    if rests and rng.random() < 0.4:
        time = rng.choice(times)
        length = rng.choice((2.0, 7.7, 30.0))
        vehicle["breaks"] = [{"window": [max(0.0, time - 10), time], "length": length}]
