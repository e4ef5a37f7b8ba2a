"""Small random fleets, all their plans, and the times of a route by trying every departure."""

from collections.abc import Iterator
from itertools import permutations, product
from math import inf

import numpy as np

from service.fleet.evaluation import plan_lengths, violations
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route, path_of
from service.fleet.rules import ALWAYS, Rules, Shipment, VehicleType, Visit
from service.pareto import nondominated

Point = tuple[float, float]


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
        visits[2] = Visit(service=visits[2].service, window=visits[2].window)
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
        window=(begin, begin + int(random.integers(5, 60))) if timed else ALWAYS,
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


def every_plan(rules: Rules) -> Iterator[Plan]:
    """Yield every plan that leaves out none but optional stops, with at most two vehicles."""
    types = [index for index, each in enumerate(rules.vehicles) for _ in range(each.count)]
    deliveries = {each.delivery: each.pickup for each in rules.shipments}
    optional = [s for s in rules.clients if rules.visits[deliveries.get(s, s)].prize is not None]
    for left_out in product((False, True), repeat=len(optional)):
        without = {stop for stop, out in zip(optional, left_out, strict=True) if out}
        yield from _plans([stop for stop in rules.clients if stop not in without], types)


def _plans(stops: list[int], types: list[int]) -> Iterator[Plan]:
    first, second = types
    for order in permutations(stops):
        for cut in range(len(order) + 1):
            routes = (Route(first, order[:cut]), Route(second, order[cut:]))
            yield Plan(tuple(route for route in routes if route.stops))


def exact_front(fleet: Fleet) -> list[Point]:
    """Return the points of all nondominated plans, by ascending first length."""
    found = {
        plan_lengths(fleet, plan) for plan in every_plan(fleet.rules) if not violations(fleet, plan)
    }
    points = np.array(sorted(found)).reshape(-1, 2)
    return [(float(x), float(y)) for x, y in points[nondominated(points)]]


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


def best_times(fleet: Fleet, route: Route) -> tuple[float, float] | None:
    """Return the earliest end of a route and then its latest departure, by trying each in turn.

    None where no departure keeps the windows and the shift. All times must be whole.
    """
    assert fleet.rules.clock is not None
    begins, ends = fleet.rules.vehicles[route.vehicle].shift
    found = []
    for departure in range(int(begins), 200):
        end = _driven(fleet, route, float(departure))
        if end is not None and end <= ends:
            found.append((end, -departure))
    return (min(found)[0], -float(min(found)[1])) if found else None


def _driven(fleet: Fleet, route: Route, departure: float) -> float | None:
    """Return when a route is done that begins at a time; None where it misses a window."""
    time, before = departure, None
    for stop in path_of(fleet.rules, route):
        visit = fleet.rules.visits[stop]
        if before is not None:
            time += fleet.costs[fleet.rules.clock, before, stop]
        time = max(time, visit.window[0])
        if time > visit.window[1]:
            return None
        time += visit.service
        before = stop
    return float(time)
