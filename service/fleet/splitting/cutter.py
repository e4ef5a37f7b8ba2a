"""Cut sequences of stops into routes: find the best of all cuts of all sequences."""

from collections.abc import Callable, Sequence
from math import inf
from typing import NamedTuple

import numpy as np

from service.errors import Refusal
from service.fleet.fleet import Array, Fleet, Rules, VehicleType, Visit
from service.fleet.plans import Plan
from service.fleet.scales import Horizon
from service.fleet.splitting.optimal_split import (
    RouteCosts,
    best_split,
    plan_of,
    states_of,
    stock_of,
)
from service.fleet.splitting.route_table import (
    FleetArrays,
    Indices,
    arrays_of,
    most_stops,
    route_table,
)
from service.instance import OBJECTIVES

_MOST_ROUTES = 2**22  # routes in the tables of all sequences together: 64 MB
_MOST_STEPS = 2e8  # steps of the dynamic program of a sequence: tenths of a second
_CYCLIC_STEPS = 1e7  # most steps with which every begin is tried; else only the first is
_ALL_STEPS = 5e9  # steps of all cuts together


class Cut(NamedTuple):
    """A plan whose routes follow a sequence, and its longest route in the limited objective."""

    plan: Plan
    longest: float


class Cutter:
    """Cuts the same sequences repeatedly.

    Args:
        fleet: The fleet.
        sequences: At least one sequence of all c stops to visit, shape (c,); c is at least 1.
        stop: Called often; once it returns True, no further cuts are made.

    Raises:
        Refusal: The fleet has shipments, or too many types and numbers of vehicles.
    """

    def __init__(
        self, fleet: Fleet, sequences: Sequence[Indices], stop: Callable[[], bool]
    ) -> None:
        self._fleet = fleet
        self._stop = stop
        arrays = _from_begin(fleet, arrays_of(fleet))
        most = max(most_stops(arrays, sequence) for sequence in sequences)
        routes = len(fleet.rules.vehicles) * len(sequences[0]) * most
        _check_cuttable(fleet, routes, routes * states_of(fleet.rules))
        self._stock = stock_of(fleet.rules)
        self._sequences = sequences[: _MOST_ROUTES // routes]
        self._tables = [route_table(arrays, sequence, most) for sequence in self._sequences]
        steps = len(self._sequences) * routes * self._stock.states
        self._begins = most if steps * most <= _CYCLIC_STEPS else 1
        self.affordable = int(_ALL_STEPS / (steps * self._begins))  # cuts

    def costs(self, weights: Array, limited: int | None = None) -> list[RouteCosts]:
        """Return the costs of all routes along each sequence, with weights of both lengths.

        The first objective includes prizes and fixed costs. `limited` is the objective to bound, if
        any.
        """
        return [
            self._costs(table, sequence, weights, limited)
            for table, sequence in zip(self._tables, self._sequences, strict=True)
        ]

    def best(self, costs: Sequence[RouteCosts], limit: float = inf) -> Cut | None:
        """Return the cheapest cut whose routes are all shorter than a limit, or None."""
        least, found = inf, None
        for number, routes in enumerate(costs):
            if self._stop():
                return None
            cost, chosen = best_split(self._stock, routes, self._begins, limit)
            if cost < least:
                least, found = cost, (number, chosen)
        if found is None:
            return None
        number, chosen = found
        vehicles, places, counts = chosen.T
        longest = costs[number].bounded[vehicles, places, counts - 1].max(initial=0.0)
        return Cut(plan_of(self._sequences[number], chosen), float(longest))

    def least_limit(self, limited: int) -> float:
        """Return the least limit that lets each required stop have a route of its own."""
        alone = self._tables[0][:, :, 0, limited].min(axis=0)
        required = [self._fleet.rules.visits[stop].prize is None for stop in self._sequences[0]]
        return float(alone[required].max(initial=0.0))

    def _costs(
        self, table: Array, sequence: Indices, weights: Array, limited: int | None
    ) -> RouteCosts:
        rules = self._fleet.rules
        fixed = np.array([vehicle.fixed for vehicle in rules.vehicles])[:, np.newaxis, np.newaxis]
        feasible = np.isfinite(table[..., 0])
        lengths = np.where(feasible[..., np.newaxis], table, 0.0)
        prizes = (rules.visits[stop].prize for stop in sequence)
        bounded = np.zeros_like(fixed + feasible) if limited is None else lengths[..., limited]
        return RouteCosts(
            cost=np.where(feasible, lengths @ weights + weights[0] * fixed, inf),
            bounded=np.ascontiguousarray(bounded),  # in the layout for which the code is compiled
            skipping=np.array([inf if prize is None else weights[0] * prize for prize in prizes]),
        )


def _from_begin(fleet: Fleet, arrays: FleetArrays) -> FleetArrays:
    """Return arrays whose times count from the earliest departure.

    The tolerance of lateness is relative to times: for seconds since 1970 it would be a second.
    """
    if fleet.rules.clock is None:
        return arrays
    begin = Horizon.of(fleet.rules, float(fleet.largest_legs[fleet.rules.clock])).begin
    window, shift = (np.maximum(0.0, spans - begin) for spans in (arrays.window, arrays.shift))
    return arrays._replace(window=window, shift=shift)


def warm_up() -> None:
    """Compile the optimal split, or load it from the cache."""
    rules = Rules(visits=(Visit(), Visit()), vehicles=(VehicleType(start=0, end=0),))
    fleet = Fleet(rules=rules, costs=np.ones((OBJECTIVES, rules.n, rules.n)))
    cutter = Cutter(fleet, [np.array([1])], lambda: False)
    cutter.best(cutter.costs(np.ones(OBJECTIVES)))


def _check_cuttable(fleet: Fleet, routes: int, steps: int) -> None:
    """Raise a refusal if tours cannot be cut into routes of a fleet, or into too many ones."""
    if fleet.rules.shipments:
        reason = "shipments need a time_limit over 0: no cut of a tour keeps them"
        raise Refusal("no-plan", reason=reason)
    if routes > _MOST_ROUTES or steps > _MOST_STEPS:
        reason = "this many stops, types and numbers of vehicles need a time_limit over 0"
        raise Refusal("no-plan", reason=reason)
