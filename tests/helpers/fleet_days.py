"""Random fleets over the day, and routes of theirs driven step by step, as the guide has it."""

from dataclasses import replace
from itertools import pairwise
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.day.costs import CostsOfDay
from service.fleet.fleet import Fleet
from service.fleet.plans import Route, path_of
from tests.helpers.days import cost_at, knots_of, random_breakpoints, slice_of
from tests.helpers.fleets import bounded_fleet, mixed_fleet, random_fleet, shipping_fleet

_LATEST = 130  # departures
_MOST = 4  # stops to visit


class Driven(NamedTuple):
    """The times of a route that leaves at some time."""

    arrivals: list[float]
    end: float
    lateness: float
    driving: float


def day_fleet(seed: int) -> Fleet:
    """Return a fleet of few stops with a clock, whose costs change up to four times a day."""
    kinds = (random_fleet, bounded_fleet, mixed_fleet, shipping_fleet)
    drawn = (kinds[seed % len(kinds)](1000 * number + seed) for number in range(1000))
    fleet = next(
        each for each in drawn if each.rules.clock is not None and len(each.rules.clients) <= _MOST
    )
    random = np.random.default_rng(seed)
    # Vehicles that are slower than breakpoints say could arrive earlier if they leave later.
    slow = any(each.speed_factor < 1 for each in fleet.rules.vehicles)
    drawn_costs = _costs if slow or random.random() < 0.5 else _costs_by_pair
    first, second = (drawn_costs(random, costs) for costs in fleet.costs)
    return Fleet.over_the_day(fleet.rules, first, second)


def limited_day_fleet(seed: int) -> Fleet:
    """Return such a fleet that bounds how far and how long vehicles drive, half with profiles."""
    fleet, random = day_fleet(seed), np.random.default_rng([seed, 1])
    profiles = 1 + seed // 2 % 2
    assert fleet.day is not None

    def bound() -> float:
        return float(random.integers(10, 60)) if random.random() < 0.7 else inf

    vehicles = tuple(
        replace(
            each,
            max_distance=bound() if fleet.rules.clock != 0 else inf,
            max_driving=bound(),
            profile=int(random.integers(profiles)),
        )
        for each in fleet.rules.vehicles
    )
    days = [*fleet.day, *(_truck(random, each) for each in fleet.day)][: 2 * profiles]
    return Fleet.over_the_day(replace(fleet.rules, vehicles=vehicles), *days)


def _truck(random: np.random.Generator, costs: CostsOfDay) -> CostsOfDay:
    """Return costs of the same slices by another profile, which lacks a leg."""
    matrices = random.integers(1, 25, costs.matrices.shape).astype(np.float64)
    matrices[:, -1, 0] = inf
    return replace(costs, matrices=matrices)


def _costs(random: np.random.Generator, matrix: NDArray[np.float64]) -> CostsOfDay:
    count = int(random.integers(1, 5))
    begins = np.sort(random.choice(80, count, replace=False)).astype(np.float64)
    other = random.integers(1, 20, matrix.shape).astype(np.float64)
    other[np.isinf(matrix)] = inf
    layers = random.integers(0, 2, count)
    return CostsOfDay(
        begins, random.choice([0.5, 1.0, 2.0], count), layers, np.stack((matrix, other))
    )


def _costs_by_pair(random: np.random.Generator, matrix: NDArray[np.float64]) -> CostsOfDay:
    pairs = np.isfinite(matrix) & ~np.eye(len(matrix), dtype=np.bool_)
    return CostsOfDay.by_pair(random_breakpoints(random, pairs))


def driven(fleet: Fleet, route: Route, departure: float) -> Driven | None:
    """Return the times of a route of one window a stop that leaves at a time; None if it is late.

    The vehicle loads once, and has no breaks.
    """
    rules, vehicle = fleet.rules, fleet.rules.vehicles[route.vehicle]
    assert rules.clock is not None
    costs, path = fleet.day_by(route.vehicle)[rules.clock], path_of(rules, route)
    time, lateness, driving, arrivals = departure, 0.0, 0.0, []
    for place, stop in enumerate(path):
        if place:
            leaves = time
            time = _arrival(costs, path[place - 1], stop, time, vehicle.speed_factor)
            driving += time - leaves
        ((opens, closes),) = rules.windows[stop]
        if time > closes + 1e-7:
            return None
        arrivals.append(time)
        begin = max(time, opens)
        lateness += max(0.0, begin - rules.visits[stop].due)
        time = begin + rules.service(route.vehicle, stop)
    if time > vehicle.way[1] + 1e-7:
        return None
    return Driven(arrivals, time, lateness, driving)


def _arrival(costs: CostsOfDay, a: int, b: int, time: float, speed: float) -> float:
    """Return when a leg ends: it is driven at the speed of each slice until that ends."""
    if knots_of(costs, a, b):
        return time + cost_at(costs, time, a, b) / speed
    left = 1.0
    for known in range(slice_of(costs, time), len(costs.begins)):
        seconds = costs.factors[known] * costs.matrices[costs.layers[known], a, b] / speed
        ends = costs.begins[known + 1] if known + 1 < len(costs.begins) else inf
        if time + left * seconds <= ends:
            return float(time + left * seconds)
        left -= (ends - time) / seconds
        time = ends
    raise AssertionError


def other_length(fleet: Fleet, route: Route, leaves: list[float], layer: int) -> float:
    """Return the costs of the legs of a route that are not the time, each when it begins."""
    costs = fleet.day_by(route.vehicle)[layer]
    legs = zip(leaves, pairwise(path_of(fleet.rules, route)), strict=False)
    return sum(cost_at(costs, time, a, b) for time, (a, b) in legs)


def departures(fleet: Fleet, route: Route) -> list[float]:
    """Return departures of a route, ten in each unit of time."""
    vehicle = fleet.rules.vehicles[route.vehicle]
    released = max(fleet.rules.visits[stop].release for stop in route.stops)
    begin = max(vehicle.shift[0], released)
    last = min(begin + _LATEST, vehicle.leaves_by)
    return np.linspace(begin, last, 10 * _LATEST + 1).tolist() if last >= begin else []
