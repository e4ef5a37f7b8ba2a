"""The loads of a fleet: those that vehicles carry, and other rules in the same terms.

A stop that only some types of vehicles may visit has a load of 1 in a dimension of its own, in
which the other types hold nothing. In one more dimension each stop counts 1, up to `max_stops`.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.fleet.rules import Rules

Indices = NDArray[np.int64]


class Loads(NamedTuple):
    """The loads of n stops and v types of vehicles, in d dimensions.

    A plan within these capacities keeps all rules about capacities, skills, pinned stops and
    `max_stops`.
    """

    demand: Indices  # (n, d); the load of a shipment is that of its pick-up
    taken: Indices  # (n, d), what each stop puts on board, to the end
    capacity: Indices  # (v, d)
    initial: Indices  # (v, d)


def loads_of(rules: Rules) -> Loads:
    """Return the loads of a fleet."""
    types, none = range(len(rules.vehicles)), (0,) * rules.dimensions
    demand = [_whole([visit.demand or none for visit in rules.visits], rules.dimensions)]
    taken = _whole([visit.pickup or none for visit in rules.visits], rules.dimensions)
    capacity = [_whole([each.capacity for each in rules.vehicles], rules.dimensions)]
    some = {rules.servers(stop) for stop in rules.clients} - {frozenset(types)}
    for servers in sorted(some, key=sorted):
        served = [
            stop in rules.clients and rules.servers(stop) == servers for stop in range(rules.n)
        ]
        demand.append(_column(served))
        capacity.append(_column([rules.n if each in servers else 0 for each in types]))
    most = [vehicle.max_stops for vehicle in rules.vehicles]
    if any(each is not None for each in most):
        demand.append(_column([stop in rules.clients for stop in range(rules.n)]))
        capacity.append(_column([rules.n if each is None else each for each in most]))
    capacities = np.hstack(capacity)
    initial = np.zeros_like(capacities)
    loaded = [vehicle.initial_load or none for vehicle in rules.vehicles]
    initial[:, : rules.dimensions] = _whole(loaded, rules.dimensions)
    demands = np.hstack(demand)
    put = np.zeros_like(demands)
    put[:, : rules.dimensions] = taken
    return Loads(demands, put, capacities, initial)


def _whole(rows: list[tuple[int, ...]], dimensions: int) -> Indices:
    return np.array(rows, np.int64).reshape(len(rows), dimensions)


def _column(values: list[bool] | list[int]) -> Indices:
    return np.array(values, np.int64)[:, np.newaxis]
