"""Small random fleets, all their plans, and the times of a route by trying every departure."""

import dataclasses
from collections.abc import Iterator, Sequence
from itertools import permutations, product
from math import inf
from typing import Any

import numpy as np

from service.fleet.evaluation import plan_lengths, points_of, violations
from service.fleet.fleet import LAYERS, Fleet
from service.fleet.groups import Groups
from service.fleet.measures.table import Measure
from service.fleet.plans import FleetFront, Plan, Route, path_of
from service.fleet.rules import Over, Rules
from service.fleet.vehicles import ALWAYS, Break, Shipment, VehicleType, Visit
from service.pareto import hypervolume, nondominated

Point = tuple[float, ...]
Objectives = tuple[Over | Measure, ...]
# Each with the costs that its objectives are of.
MIXED: Sequence[tuple[Objectives, tuple[int, ...]]] = (
    (("sum", "imbalance"), (0, 0)),
    (("sum", "load_distance"), (0, 0)),
    (("sum", "max", "vehicles"), (0, 1, 0)),
    (("sum", "max", "sum"), (0, 0, 1)),
    (("sum", "unassigned", "max"), (0, 0, 0)),
    (("sum", "lateness", "vehicles"), (0, 0, 0)),
    (("sum", "overtime", "imbalance"), (0, 0, 0)),
    (("sum", "sum", "load_distance"), (0, 1, 0)),
    (("sum", "earliness"), (0, 0)),
    (("sum", "weighted_arrival"), (0, 0)),
    (("sum", "lateness", "earliness"), (0, 0, 0)),
    (("sum", "max", "lateness", "vehicles"), (0, 1, 0, 0)),
    (("sum", "sum", "unassigned", "imbalance"), (0, 1, 0, 0)),
)


def random_fleet(seed: int, over: tuple[str, str] | None = None) -> Fleet:
    """Return a fleet of up to six stops and two vehicles, with some of all that rules can ask."""
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 7))
    over = over or (("sum", "max"), ("max", "sum"), ("sum", "sum"))[seed % 3]
    costs = random.integers(1, 20, (2, n, n)).astype(float)
    if random.random() < 0.3:
        costs[1] = costs[0]
    clock = random.choice([None, 0, 1])
    clock = None if clock is None else int(clock)
    extras = over[0] == "sum" and random.random() < 0.5
    visits = [Visit()] + [_visit(random, clock, extras) for _ in range(n - 1)]
    shipments = ()
    if n >= 4 and random.random() < 0.4:
        shipments = (Shipment(1, 2),)
        visits[2] = Visit(service=visits[2].service, windows=visits[2].windows)
    rules = Rules(
        visits=tuple(visits),
        vehicles=_vehicles(random, clock, over, extras),
        shipments=shipments,
        over=over,
        clock=clock,
    )
    return Fleet(rules=rules, costs=costs)


def _visit(random: np.random.Generator, clock: int | None, extras: bool) -> Visit:
    timed = clock is not None and random.random() < 0.5
    begin = int(random.integers(0, 40))
    return Visit(
        demand=(int(random.integers(0, 5)),),
        service=float(random.integers(0, 4)) if timed else 0.0,
        windows=((begin, begin + int(random.integers(5, 60))),) if timed else (ALWAYS,),
        prize=float(random.integers(1, 40)) if extras and random.random() < 0.5 else None,
    )


def _vehicles(
    random: np.random.Generator, clock: int | None, over: tuple[str, str], extras: bool
) -> tuple[VehicleType, ...]:
    def vehicle(count: int) -> VehicleType:
        bounded = (clock is not None or "max" in over) and random.random() < 0.3
        return VehicleType(
            start=0,
            end=[0, None][int(random.integers(2))],
            count=count,
            capacity=(int(random.integers(6, 16)),),
            shift=(5.0, 120.0) if clock is not None and random.random() < 0.5 else ALWAYS,
            longest=float(random.integers(40, 90)) if bounded else inf,
            fixed=float(random.integers(0, 10)) if extras else 0.0,
        )

    return (vehicle(2),) if random.random() < 0.5 else (vehicle(1), vehicle(1))


def bounded_fleet(seed: int) -> Fleet:
    """Return a fleet of up to four stops to visit with some of all bounds, against a measure."""
    measures: Sequence[Measure | None] = (None, "vehicles", "unassigned", "overtime", "lateness")
    measure = measures[seed % len(measures)]
    second = "max" if seed % 2 else "sum"
    return _bounded(seed, ("sum", second if measure is None else measure), (0, 1))


def mixed_fleet(seed: int) -> Fleet:
    """Return the same under three objectives, or two that the search knows nothing of."""
    return _bounded(seed, *MIXED[seed % len(MIXED)])


def shipping_fleet(seed: int) -> Fleet:
    """Return a fleet of a shipment and one to three other stops, with some of all bounds."""
    fleet = _bounded(seed, *MIXED[seed % len(MIXED)], least=3)
    visits, rules = list(fleet.rules.visits), fleet.rules
    first, second, *_ = rules.clients
    plain = dataclasses.replace(visits[first], windows=visits[first].windows[:1], release=0.0)
    visits[first] = plain
    visits[second] = dataclasses.replace(
        visits[second], windows=visits[second].windows[:1], release=0.0, demand=(), prize=None
    )
    vehicles = tuple(
        dataclasses.replace(each, reload=(), max_trips=None, max_stops=None)
        for each in rules.vehicles
    )
    shipped = dataclasses.replace(
        rules, visits=tuple(visits), vehicles=vehicles, shipments=(Shipment(first, second),)
    )
    return Fleet(rules=shipped, costs=fleet.costs)


def taking_fleet(seed: int) -> Fleet:
    """Return a fleet with shipments or without, whose other stops put something on board."""
    fleet = (shipping_fleet, mixed_fleet, random_fleet)[seed % 3](seed)
    rules, random = fleet.rules, np.random.default_rng([seed, 4])
    visits = tuple(
        dataclasses.replace(visit, pickup=(int(random.integers(0, 5)),))
        if stop in rules.clients and stop not in rules.shipped
        else visit
        for stop, visit in enumerate(rules.visits)
    )
    vehicles = tuple(
        dataclasses.replace(each, reload=(), max_trips=None) for each in rules.vehicles
    )
    # A stop at which vehicles loaded again is none to visit, though none starts or ends there.
    gone = rules.depots - dataclasses.replace(rules, visits=visits, vehicles=vehicles).depots
    visits = tuple(
        Visit(prize=0.0) if stop in gone and rules.over[0] == "sum" else visit
        for stop, visit in enumerate(visits)
    )
    return fleet.under(dataclasses.replace(rules, visits=visits, vehicles=vehicles))


def grouped_fleet(seed: int) -> Fleet:
    """Return a fleet of three or four stops that ride together, apart or in order, or are many."""
    fleet = _bounded(seed, *MIXED[seed % len(MIXED)], least=3)
    random, rules = np.random.default_rng(seed), fleet.rules

    def some(least: int) -> tuple[int, ...]:
        count = int(random.integers(least, 3))
        return tuple(random.permutation(rules.clients)[:count].tolist())

    def likely() -> bool:
        return bool(random.random() < 0.5)

    together = some(2)
    others = tuple(stop for stop in rules.clients if stop not in together)
    groups = Groups(
        together=(together,) if likely() else (),
        apart=((together[:1], others[:1]),) if likely() else (),
        before=((some(1), some(1)),) if likely() else (),
    )
    vehicles = tuple(
        dataclasses.replace(
            each,
            max_stops=None,
            min_stops=int(random.integers(0, 3)),
            shortest=float(random.integers(5, 40)) if random.random() < 0.3 else 0.0,
            longest=inf,
        )
        for each in rules.vehicles
    )
    return fleet.under(dataclasses.replace(rules, groups=groups, vehicles=vehicles))


def waiting_fleet(seed: int) -> Fleet:
    """Return a fleet of three or four stops some of whose visits wait for others."""
    fleet = _bounded(seed, *MIXED[seed % len(MIXED)], least=3)
    random, rules = np.random.default_rng([seed, 3]), fleet.rules
    vehicles = tuple(
        dataclasses.replace(each, reload=(), max_trips=None, breaks=()) for each in rules.vehicles
    )
    rules = dataclasses.replace(rules, vehicles=vehicles)
    order = random.permutation(rules.clients).tolist()
    pairs = [((order[0],), (order[1],)), ((order[1],), (order[2],)), ((order[0],), (order[2],))]
    chosen = random.permutation(3)[: int(random.integers(1, 4))].tolist()
    gaps = random.choice([0.0, 0.0, 4.0, 15.0], len(chosen)).tolist()
    groups = Groups(before=tuple(pairs[each] for each in chosen), gaps=tuple(gaps))
    return fleet.under(dataclasses.replace(rules, groups=groups))


def varied_fleet(seed: int) -> Fleet:
    """Return one of the others with vehicles of different speeds, times at stops and prices."""
    makers = (random_fleet, bounded_fleet, mixed_fleet, shipping_fleet)
    fleet, random = makers[seed % len(makers)](seed), np.random.default_rng([seed, 1])
    rules = fleet.rules
    timed, summed = rules.clock is not None, rules.over[0] == "sum"

    def varied(vehicle: VehicleType) -> VehicleType:
        numbers = random.choice([0.25, 0.5, 1.0, 2.0, 3.0], 4).tolist()
        return dataclasses.replace(
            vehicle,
            speed_factor=numbers[0] if timed else 1.0,
            service_factor=numbers[1] if timed else 1.0,
            per_distance=numbers[2] if summed else 1.0,
            per_time=numbers[3] - 0.25 if timed and summed else 0.0,
            max_distance=20.0 * numbers[3] if rules.clock != 0 and seed % 3 == 0 else inf,
            max_driving=15.0 * numbers[2] if timed and seed % 3 == 1 else inf,
        )

    def served(visit: Visit) -> Visit:
        if not timed or visit == Visit() or random.random() < 0.5:
            return visit
        return dataclasses.replace(visit, services=tuple(map(float, random.integers(0, 6, 2))))

    pinned = any(visit.vehicles for visit in rules.visits)
    types = [
        dataclasses.replace(each, count=each.count if pinned else 1)
        for each in rules.vehicles
        for _ in range(1 if pinned else each.count)
    ]
    vehicles = tuple(map(varied, types))
    visits = tuple(map(served, rules.visits)) if len(vehicles) == 2 else rules.visits
    varied_rules = dataclasses.replace(rules, visits=visits, vehicles=vehicles)
    if seed % 8 > 3:
        return Fleet(rules=varied_rules, costs=fleet.costs)
    return _profiled(Fleet(rules=varied_rules, costs=fleet.costs), random)


def _profiled(fleet: Fleet, random: np.random.Generator) -> Fleet:
    """Return a fleet whose types of vehicles drive by two profiles, one of which lacks a leg."""
    n = fleet.rules.n
    costs = random.integers(1, 25, (LAYERS, n, n)).astype(float)
    costs[:, n - 1, random.integers(n)] = inf
    vehicles = tuple(
        dataclasses.replace(each, profile=int(random.integers(2))) for each in fleet.rules.vehicles
    )
    rules = dataclasses.replace(fleet.rules, vehicles=vehicles)
    return Fleet.of_profiles(rules, [fleet.costs, costs])


def tidy_fleet(seed: int) -> Fleet:
    """Return a fleet with overlap and changes of a promised plan among its objectives."""
    over: Objectives = (("sum", "overlap"), ("sum", "changes"), ("sum", "changes", "overlap"))[
        seed % 3
    ]
    fleet, random = _bounded(seed, ("sum", "sum"), (0, 0)), np.random.default_rng([seed, 2])
    rules = fleet.rules
    tolerance = float(random.integers(0, 10)) if random.random() < 0.6 else None

    def promised(visit: Visit) -> Visit:
        by = float(random.integers(1, 60)) if random.random() < 0.8 else inf
        return dataclasses.replace(visit, promised_to=int(random.integers(-1, 2)), promised_by=by)

    visits = [
        promised(visit) if stop in rules.clients and stop != rules.clients[1] else visit
        for stop, visit in enumerate(rules.visits)
    ]
    breaks = {} if tolerance is None else {"breaks": ()}
    vehicles = tuple(dataclasses.replace(each, **breaks) for each in rules.vehicles)
    layers = (0,) * len(over)
    changed = dataclasses.replace(
        rules,
        visits=tuple(visits),
        vehicles=vehicles,
        over=over,
        layers=layers,
        tolerance=tolerance,
    )
    return fleet.under(changed)


# Objectives of times that spread, the first of which are the clock's, and their percentiles.
SPREADING: Sequence[tuple[Objectives, tuple[int, ...], tuple[int | None, ...]]] = (
    (("sum", "on_time"), (0, 0), ()),
    (("sum", "sum"), (0, 1), (90, None)),
    (("sum", "max"), (0, 0), (None, 80)),
    (("sum", "vehicles", "on_time"), (0, 0, 0), (95, None, None)),
    (("sum", "max"), (0, 0), (90, 90)),
)


def spreading_fleet(seed: int) -> Fleet:
    """Return one of the others with times that spread, and objectives of how they do."""
    over, layers, percents = SPREADING[seed % len(SPREADING)]
    makers = (random_fleet, bounded_fleet, mixed_fleet)
    fleet, random = makers[seed % len(makers)](seed), np.random.default_rng([seed, 3])
    rules = fleet.rules
    plain: dict[str, Any] = {"per_distance": 1.0, "per_time": 0.0, "breaks": ()}
    vehicles = tuple(dataclasses.replace(each, **plain) for each in rules.vehicles)

    def visited(visit: Visit) -> Visit:
        due = float(random.integers(5, 40)) if random.random() < 0.6 else visit.due
        return dataclasses.replace(visit, due=due, wanted=min(visit.wanted, due))

    visits = [
        visited(visit) if stop in rules.clients else visit
        for stop, visit in enumerate(rules.visits)
    ]
    visits[rules.clients[0]] = dataclasses.replace(visits[rules.clients[0]], due=20.0, wanted=0.0)
    changed = dataclasses.replace(
        rules,
        visits=tuple(visits),
        vehicles=vehicles,
        over=over,
        layers=layers,
        clock=0,
        spread=float(random.choice([0.0, 0.1, 0.3, 0.6])),
        percents=percents,
    )
    return Fleet(rules=changed, costs=fleet.costs if rules.clock == 0 else fleet.costs[::-1])


def sampled_fleet(seed: int) -> Fleet:
    """Return one of these with the times of two to seven days, some of which are slow."""
    fleet, random = spreading_fleet(seed), np.random.default_rng([seed, 4])
    days, n = int(random.integers(2, 8)), fleet.rules.n
    slow = random.choice([0.5, 1.0, 2.0], (days, 1, 1))
    times = np.round(slow * fleet.costs[0]) + random.integers(0, 5, (days, n, n))
    rules = dataclasses.replace(fleet.rules, spread=None, sampled=True)
    return Fleet(rules=rules, costs=np.stack((times.mean(axis=0), fleet.costs[1])), sampled=times)


def _bounded(seed: int, over: Objectives, layers: tuple[int, ...], least: int = 2) -> Fleet:
    random = np.random.default_rng(seed)
    n = int(random.integers(least, least + 2))
    costs = random.integers(1, 20, (2, n + 2, n + 2)).astype(float)

    def likely(share: float = 0.4) -> bool:
        return bool(random.random() < share)

    def whole(least: int, most: int) -> int:
        return int(random.integers(least, most))

    def windows() -> tuple[tuple[float, float], ...]:
        begin, between = whole(0, 40), whole(5, 25)
        first = (float(begin), float(begin + whole(3, 20)))
        second = (first[1] + between, first[1] + between + whole(3, 60))
        return (first, second) if likely(0.6) else ((first[0], second[1]),)

    def visit() -> Visit:
        return Visit(
            demand=(whole(1, 5),),
            service=float(whole(0, 4)),
            windows=windows() if likely() else (ALWAYS,),
            prize=float(whole(1, 40)) if "unassigned" in over or likely() else None,
            due=float(whole(5, 50)) if "lateness" in over or likely() else inf,
            release=float(whole(0, 30)) if likely(0.3) else 0.0,
            skills=("cold",) if likely(0.2) else (),
            vehicles=(whole(0, 2),) if likely(0.15) else (),
        )

    def breaks() -> tuple[Break, ...]:
        opens, wide, length = whole(5, 40), whole(0, 10), whole(3, 12)
        first = (float(opens), float(opens + wide), float(length))
        later = first[1] + first[2] + whole(1, 20)
        found = (first, (later, later + whole(0, 10), 5.0))
        return found[: whole(1, 3)] if likely(0.25) else ()

    def vehicle() -> VehicleType:
        begin, capacity = whole(0, 10), whole(5, 13)
        reload = ((0,), (n + 1,), (0, n + 1))[whole(0, 3)] if likely(0.5) else ()
        return VehicleType(
            start=0,
            end=[0, n + 1, None][whole(0, 3)],
            capacity=(capacity,),
            shift=(float(begin), float(begin + whole(40, 90))),
            longest=float(whole(40, 90)) if likely(0.2) else inf,
            fixed=float(whole(0, 10)),
            skills=("cold", "lift") if likely(0.7) else (),
            max_stops=None if reload or likely(0.6) else whole(1, 4),
            reload=reload,
            initial_load=(whole(0, capacity),) if likely(0.2) else (),
            max_overtime=float(whole(1, 30)) if "overtime" in over or likely(0.2) else 0.0,
            leaves_by=float(begin + whole(0, 20)) if likely(0.2) else inf,
            breaks=breaks(),
        )

    ends = (vehicle(), vehicle())
    types = tuple(
        dataclasses.replace(each, max_trips=2) if each.reload and likely() else each
        for each in ends
    )
    depots = {end for each in types for end in (0, each.end, *each.reload) if end is not None}
    visits = tuple(Visit() if stop in depots else visit() for stop in range(n + 2))
    if {"earliness", "weighted_arrival"} & {*over}:
        types = tuple(dataclasses.replace(each, breaks=()) for each in types)
        visits = tuple(
            dataclasses.replace(
                each, wanted=min(each.due, float(whole(1, 60))), urgency=float(whole(0, 4))
            )
            if stop not in depots
            else each
            for stop, each in enumerate(visits)
        )
    rules = Rules(
        visits=visits,
        vehicles=types,
        over=over,
        layers=layers,
        clock=whole(0, 2),
        slack=float(whole(1, 15)) if likely(0.25) else 0.0,
        leave="early" if likely(0.2) else "late",
    )
    return Fleet(rules=rules, costs=costs)


def every_plan(rules: Rules) -> Iterator[Plan]:
    """Yield every plan that leaves out none but optional stops, with at most two vehicles."""
    types = [index for index, each in enumerate(rules.vehicles) for _ in range(each.count)]
    deliveries = {each.delivery: each.pickup for each in rules.shipments}
    optional = [s for s in rules.clients if rules.visits[deliveries.get(s, s)].prize is not None]
    for left_out in product((False, True), repeat=len(optional)):
        without = {stop for stop, out in zip(optional, left_out, strict=True) if out}
        yield from _plans(rules, [stop for stop in rules.clients if stop not in without], types)


def _plans(rules: Rules, stops: list[int], types: list[int]) -> Iterator[Plan]:
    first, second = types
    for order in permutations(stops):
        for cut in range(len(order) + 1):
            for one in _trips(rules, first, order[:cut]):
                for other in _trips(rules, second, order[cut:]):
                    yield Plan(tuple(route for route in (one, other) if route.stops))


def _trips(rules: Rules, vehicle: int, stops: tuple[int, ...]) -> Iterator[Route]:
    """Yield the routes through these stops, which may load again before each."""
    reload = rules.vehicles[vehicle].reload
    routes: list[tuple[int, ...]] = [()]
    for stop in stops:
        loaded = [(*route, depot, stop) for route in routes for depot in reload]
        routes = [*((*route, stop) for route in routes), *loaded]
    yield from (Route(vehicle, route) for route in routes)


def exact_front(fleet: Fleet) -> list[Point]:
    """Return the points of all nondominated plans, by ascending first length."""
    found = {
        plan_lengths(fleet, plan) for plan in every_plan(fleet.rules) if not violations(fleet, plan)
    }
    points = np.array(sorted(found)).reshape(-1, len(fleet.rules.over))
    return [tuple(point.tolist()) for point in points[nondominated(points)]]


def hull_corners(points: list[Point]) -> list[Point]:
    """Return the points of a front that some weights alone would choose."""
    corners: list[Point] = []
    for x, y in points:
        while len(corners) > 1:
            (ax, ay), (bx, by) = corners[-2:]
            if (bx - ax) * (y - ay) > (x - ax) * (by - ay) + 1e-9:
                break
            corners.pop()
        corners.append((x, y))
    return corners


def best_times(fleet: Fleet, route: Route) -> tuple[float, float, float] | None:
    """Return the earliest end of a route, its least lateness then, and its departure then.

    It is the latest, or the earliest where vehicles leave early.

    All departures are tried, and all windows. None where none of them is in time. All times must be
    whole.
    """
    assert fleet.rules.clock is not None
    begins, ends = fleet.rules.vehicles[route.vehicle].way
    path = path_of(fleet.rules, route)
    numbers = [range(len(fleet.rules.visits[stop].windows)) for stop in path]
    slots = [None, *product(range(len(path)), (0, 1))]
    breaks = fleet.rules.vehicles[route.vehicle].breaks
    latest = min(200.0, ends, fleet.rules.vehicles[route.vehicle].leaves_by)
    found = []
    early = 1 if fleet.rules.leave == "early" else -1
    for departure in range(int(begins), int(latest) + 1):
        for windows in product(*numbers):
            for rests in product(slots, repeat=len(breaks)):
                driven = _driven(fleet, route, windows, rests, float(departure))
                if driven is not None and driven[0] <= ends:
                    found.append((*driven, early * departure))
    if not found:
        return None
    end, lateness, departure = min(found)
    return end, lateness, early * float(departure)


def _driven(
    fleet: Fleet,
    route: Route,
    windows: Sequence[int],
    rests: Sequence[tuple[int, int] | None],
    departure: float,
) -> tuple[float, float] | None:
    """Return when a route is done that begins at a time, and its lateness.

    Each break is taken before or after the visit at a place, or not on the way. None where a window
    or a break is missed, or where it leaves before its load is released.
    """
    rules = fleet.rules
    breaks = list(zip(rules.vehicles[route.vehicle].breaks, rests, strict=True))
    path, reload = path_of(rules, route), rules.vehicles[route.vehicle].reload
    time, lateness = departure, 0.0
    if time < _released(rules, route.stops, reload):
        return None
    for place, stop in enumerate(path):
        visit, (opens, closes) = rules.visits[stop], rules.visits[stop].windows[windows[place]]
        if place:
            leg = fleet.costs[rules.clock, path[place - 1], stop]
            time += leg / rules.vehicles[route.vehicle].speed_factor
        time = _rested(time, breaks, (place, 0))
        if stop in reload and 0 < place < len(path) - 1:
            time = max(time, _released(rules, path[place + 1 :], reload))
        if time > closes - rules.slack or time == inf:
            return None
        time = max(time, opens)
        lateness += max(0.0, time - visit.due)
        service = rules.service(route.vehicle, stop)
        time = _rested(time + service, breaks, (place, 1))
    free = [each for each, taken in breaks if taken is None]
    missed = any(departure < each[0] + each[2] and time > each[1] for each in free)
    return None if missed or time == inf else (float(time), float(lateness))


def _rested(
    time: float, breaks: list[tuple[Break, tuple[int, int] | None]], slot: tuple[int, int]
) -> float:
    """Return the time after the breaks that are taken here; infinite if one is missed."""
    for (opens, closes, length), taken in breaks:
        if taken == slot:
            time = max(time, opens) + length if time <= closes else inf
    return time


def _released(rules: Rules, stops: Sequence[int], reload: Sequence[int]) -> float:
    """Return when all is released that is brought to these stops before loading again."""
    released = 0.0
    for stop in stops:
        if stop in reload:
            break
        released = max(released, rules.visits[stop].release)
    return released


def share_of_front(expected: FleetFront, found: FleetFront) -> float:
    """Return the hypervolume of a front's plans, in the fleet and box of another, by its own."""
    points = points_of(expected.fleet, found.plans)
    box = 1.01 * expected.points.max(axis=0)
    return hypervolume(points, box) / hypervolume(expected.points, box)
