"""PyVRP alone, for fleets of one type of vehicle that start, load and end at stop 0.

It has everything in its own whole numbers: the longest leg is 10,000 to 100,000 units. Legs are
rounded up and windows inwards, so that its plans keep the rules.
"""

import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import ceil, floor, inf, log10

import numpy as np
import pyvrp
from pyvrp.exceptions import PenaltyBoundWarning
from pyvrp.IteratedLocalSearch import IteratedLocalSearchCallbacks, IteratedLocalSearchParams
from pyvrp.solve import SolveParams
from pyvrp.stop import FirstFeasible, MaxRuntime, MultipleCriteria, StoppingCriterion

from service.fleet.evaluation import violations
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route
from service.fleet.vehicles import Span

_LIMITS = 18  # of a sweep, the first of which is none
_FREE = 0.25  # share of the time of a sweep for the first
_DIGITS = 5  # of the longest leg
_EXACT = 1e-6  # units: what is as near to a whole number is meant to be that
_REDUCING = 0.5  # share of the time for the fewest vehicles in which their number is reduced


def least_total(fleet: Fleet, seconds: float) -> list[Plan]:
    """Return the plan of the least total that is found; none if none keeps the rules."""
    problem = _Problem(fleet)
    return problem.kept([_solved(problem.data, MaxRuntime(seconds))])


def both_ends(fleet: Fleet, seconds: float) -> list[Plan]:
    """Return the plan of the least total, and that of the fewest vehicles, in `seconds` each.

    For the second, one vehicle after another is taken away for at most half of the time, and then
    the total minimised with those that are left.
    """
    problem = _Problem(fleet)
    least = _solved(problem.data, MaxRuntime(seconds))
    if not least.is_feasible():
        return []
    began = time.perf_counter()
    fewest = _of_fewest(problem, least, MaxRuntime(_REDUCING * seconds))
    data = problem.with_vehicles(fewest.num_routes())
    left = max(0.0, seconds - (time.perf_counter() - began))
    return problem.kept([least, _solved(data, MaxRuntime(left), begun=_moved(fewest, data))])


def _of_fewest(problem: "_Problem", solution: pyvrp.Solution, stop: MaxRuntime) -> pyvrp.Solution:
    """Return a solution with as few vehicles as are found to do.

    As `pyvrp.minimise_fleet`, which fails where one vehicle does for shipments.
    """
    while solution.num_routes() > problem.least_vehicles:
        fewer = problem.with_vehicles(solution.num_routes() - 1)
        found = _solved(fewer, MultipleCriteria([FirstFeasible(), stop]))
        if not found.is_feasible():
            break
        solution = found
    return solution


def swept(fleet: Fleet, seconds: float) -> list[Plan]:
    """Return the front of total against longest route that is found under a sweep of limits.

    The limits are evenly spaced, from the longest route of the least total down to the least there
    can be. Each search starts from the plan of the one before, and every plan that it visits may
    enter the front.
    """
    problem, front = _Problem(fleet), _Front()
    plan = _solved(problem.data, MaxRuntime(_FREE * seconds), front)
    share = (1 - _FREE) * seconds / (_LIMITS - 1)
    longest = _longest(plan)
    for limit in np.linspace(longest, problem.least_limit, _LIMITS)[1:]:
        data = problem.limited(int(limit))
        found = _solved(data, MaxRuntime(share), front, _moved(plan, data))
        plan = found if found.is_feasible() else plan
    return problem.kept([solution for _, solution in front.found])


class _Problem:
    """PyVRP's data of a fleet."""

    def __init__(self, fleet: Fleet) -> None:
        self._fleet, rules = fleet, fleet.rules
        self._scale = 10.0 ** floor(_DIGITS - log10(float(fleet.matrices()[0].max())))
        self._timed = rules.clock is not None
        (vehicle,) = rules.vehicles
        legs = np.ceil(fleet.matrices()[0] * self._scale - _EXACT).astype(np.int64)
        self._clients = [stop for stop in rules.clients if stop not in rules.shipped]
        early, late = self._window(vehicle.shift)
        kind = pyvrp.VehicleType(
            min(vehicle.count, len(rules.clients)),
            list(vehicle.capacity),
            tw_early=early,
            tw_late=late,
            reload_depots=[0] if vehicle.reload else [],
        )
        self.data = pyvrp.ProblemData(
            [pyvrp.Location(0, 0)] * rules.n,
            [self._client(stop) for stop in self._clients],
            [pyvrp.Depot(0)],
            [kind],
            [legs],
            [legs if self._timed else np.zeros_like(legs)],
            shipments=list(self._shipments()),
        )
        loads = [sum(rules.visits[stop].demand) for stop in self._clients]
        self.least_vehicles = max(1, ceil(sum(loads) / max(1, sum(vehicle.capacity))))
        services = [self._units(visit.service) for visit in rules.visits]
        self.least_limit = int((legs[0] + legs[:, 0] + services).max())

    def with_vehicles(self, count: int) -> pyvrp.ProblemData:
        """Return the data with this number of vehicles."""
        (kind,) = self.data.vehicle_types()
        return self.data.replace(vehicle_types=[kind.replace(num_available=count)])

    def limited(self, limit: int) -> pyvrp.ProblemData:
        """Return the data with a limit on each route: its time, or its distance without a clock."""
        (kind,) = self.data.vehicle_types()
        if self._timed:
            return self.data.replace(vehicle_types=[kind.replace(shift_duration=limit)])
        return self.data.replace(vehicle_types=[kind.replace(max_distance=limit)])

    def kept(self, solutions: list[pyvrp.Solution]) -> list[Plan]:
        """Return the plans of solutions, but for those that break a rule of the fleet."""
        plans = [
            Plan(tuple(Route(0, tuple(self._stops(route))) for route in solution.routes()))
            for solution in solutions
        ]
        return [plan for plan in plans if not violations(self._fleet, plan)]

    def _stops(self, route: pyvrp.Route) -> Iterator[int]:
        shipments = self._fleet.rules.shipments
        for visit in _visits(route):
            if visit.is_client():
                yield self._clients[visit.idx]
            elif visit.is_depot():  # where the vehicle loads again
                yield 0
            elif visit.is_pickup():
                yield shipments[visit.idx].pickup
            else:
                yield shipments[visit.idx].delivery

    def _client(self, stop: int) -> pyvrp.Client:
        visit = self._fleet.rules.visits[stop]
        early, late = self._window(visit.windows[0])
        return pyvrp.Client(
            stop,
            list(visit.demand),
            service_duration=self._units(visit.service),
            tw_early=early,
            tw_late=late,
        )

    def _shipments(self) -> Iterator[pyvrp.Shipment]:
        visits = self._fleet.rules.visits
        for pair in self._fleet.rules.shipments:
            pickup, delivery = visits[pair.pickup], visits[pair.delivery]
            yield pyvrp.Shipment(
                pair.pickup,
                pair.delivery,
                *self._window(pickup.windows[0]),
                self._units(pickup.service),
                *self._window(delivery.windows[0]),
                self._units(delivery.service),
                list(pickup.demand),
            )

    def _units(self, time: float) -> int:
        return ceil(time * self._scale - _EXACT)

    def _window(self, span: Span) -> tuple[int, int]:
        opens, closes = span
        most = pyvrp.VehicleType().tw_late
        return self._units(opens), most if closes == inf else floor(closes * self._scale + _EXACT)


@dataclass
class _Front(IteratedLocalSearchCallbacks):
    """Keeps the solutions that no other one beats in total and longest route."""

    found: list[tuple[tuple[int, int], pyvrp.Solution]] = field(default_factory=list)

    def on_iteration(
        self,
        current: pyvrp.Solution,  # noqa: ARG002  PyVRP names them all
        candidate: pyvrp.Solution,
        best: pyvrp.Solution,  # noqa: ARG002
        cost_evaluator: pyvrp.CostEvaluator,  # noqa: ARG002
    ) -> None:
        """Offer the candidate."""
        self._offer(candidate)

    def on_best(self, best: pyvrp.Solution) -> None:
        """Offer a new best solution, which may be better than the candidate."""
        self._offer(best)

    def _offer(self, solution: pyvrp.Solution) -> None:
        if not solution.is_feasible():
            return
        total, longest = solution.distance(), _longest(solution)
        if any(other[0] <= total and other[1] <= longest for other, _ in self.found):
            return
        self.found = [each for each in self.found if each[0][0] < total or each[0][1] < longest]
        self.found.append(((total, longest), solution))


def _solved(
    data: pyvrp.ProblemData,
    stop: StoppingCriterion,
    front: _Front | None = None,
    begun: pyvrp.Solution | None = None,
) -> pyvrp.Solution:
    settings = SolveParams(ils=IteratedLocalSearchParams(callbacks=front))  # type: ignore[arg-type]
    with _quiet():
        result = pyvrp.solve(
            data,
            stop,
            collect_stats=False,
            display=False,
            params=settings,
            initial_solution=begun,
        )
    return result.best


def _longest(solution: pyvrp.Solution) -> int:
    """Return the longest route: its time, which is 0 without a clock, or its distance."""
    return max(max(route.duration(), route.distance()) for route in solution.routes())


def _moved(solution: pyvrp.Solution, data: pyvrp.ProblemData) -> pyvrp.Solution:
    """Return a solution as one of other data of the same fleet."""
    routes = [pyvrp.Route(data, _visits(route), 0) for route in solution.routes()]
    return pyvrp.Solution(data, routes)


def _visits(route: pyvrp.Route) -> list[pyvrp.Activity]:
    return list(route.schedule()[1:-1])


def _quiet() -> warnings.catch_warnings:
    """Ignore the warning that few plans are found under a tight limit."""
    return warnings.catch_warnings(action="ignore", category=PenaltyBoundWarning)
