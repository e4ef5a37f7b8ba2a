"""OR-Tools' routing solver for fleets with one depot and capacities.

Under a limit on each route, or with windows and shipments.
"""

import numpy as np
from numpy.typing import NDArray
from ortools.constraint_solver import pywrapcp, routing_enums_pb2

from service.fleet.evaluation import points_of
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route
from tests.benchmarks.rivals.ortools_routing import FINENESS
from tests.benchmarks.rivals.twice import cheapest_twice

_FINE = 1000  # whole units of a cost of 1
_LIMITS = 12  # of a sweep, the first of which is none


def swept(fleet: Fleet, seconds: float) -> list[Plan]:
    """Return the plans under evenly spaced limits on the longest route, down to the least."""
    least = 2 * float(fleet.matrices()[0, 0].max())
    free = route_fleet(fleet, np.inf, seconds / _LIMITS)
    if free is None:
        return []
    limits = np.linspace(points_of(fleet, [free])[0, 1], least, _LIMITS)[1:]
    limited = (route_fleet(fleet, limit, seconds / _LIMITS) for limit in limits)
    return [free, *(plan for plan in limited if plan is not None)]


def both_ends(fleet: Fleet, seconds: float) -> list[Plan]:
    """Return the plans for the least distance, and for the fewest vehicles, in `seconds` each."""
    return cheapest_twice(route_in_time, fleet, seconds)


def route_fleet(fleet: Fleet, limit: float, seconds: float) -> Plan | None:
    """The plan of the least first length with no route over a limit; None where none was found.

    From savings, by guided local search until the time is over. Of a fleet whose vehicles are of
    one type, start and end at stop 0, and have a capacity of one dimension.
    """
    (vehicle,) = fleet.rules.vehicles
    whole = np.ceil(fleet.matrices()[0] * FINENESS).astype(np.int64)
    manager = pywrapcp.RoutingIndexManager(fleet.rules.n, vehicle.count, 0)
    routing = pywrapcp.RoutingModel(manager)
    transit = routing.RegisterTransitMatrix(whole.tolist())
    routing.SetArcCostEvaluatorOfAllVehicles(transit)
    demands = [sum(visit.demand) for visit in fleet.rules.visits]
    load = routing.RegisterUnaryTransitVector(demands)
    routing.AddDimension(load, 0, vehicle.capacity[0], True, "load")
    if np.isfinite(limit):
        # Legs are rounded up.
        most = int(np.ceil(limit * FINENESS)) + fleet.rules.n
        routing.AddDimension(transit, 0, most, True, "length")
    solution = routing.SolveWithParameters(_parameters(seconds))
    return None if solution is None else _plan(manager, routing, solution)


def _parameters(seconds: float) -> pywrapcp.DefaultRoutingSearchParameters:
    parameters = pywrapcp.DefaultRoutingSearchParameters()
    parameters.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.SAVINGS
    metaheuristics = routing_enums_pb2.LocalSearchMetaheuristic
    parameters.local_search_metaheuristic = metaheuristics.GUIDED_LOCAL_SEARCH
    parameters.time_limit.FromNanoseconds(int(1e9 * seconds))
    return parameters


def _plan(
    manager: pywrapcp.RoutingIndexManager,
    routing: pywrapcp.RoutingModel,
    solution: pywrapcp.Assignment,
) -> Plan:
    routes = []
    for vehicle in range(routing.vehicles()):
        stops, index = [], solution.Value(routing.NextVar(routing.Start(vehicle)))
        while not routing.IsEnd(index):
            stops.append(manager.IndexToNode(index))
            index = solution.Value(routing.NextVar(index))
        routes.append(Route(0, tuple(stops)))
    return Plan(tuple(route for route in routes if route.stops))


def route_in_time(fleet: Fleet, vehicle_cost: float, seconds: float) -> Plan | None:
    """The plan of the least distance and cost of vehicles; None where none was found.

    By guided local search, from savings or with windows and shipments from parallel insertion. Of
    a fleet as above, whose clock has the same costs as the distance.
    """
    rules = fleet.rules
    (vehicle,) = rules.vehicles
    whole = np.ceil(fleet.matrices()[0] * _FINE).astype(np.int64)
    count = min(vehicle.count, len(rules.clients))
    manager = pywrapcp.RoutingIndexManager(rules.n, count, 0)
    routing = pywrapcp.RoutingModel(manager)
    routing.SetArcCostEvaluatorOfAllVehicles(routing.RegisterTransitMatrix(whole.tolist()))
    routing.SetFixedCostOfAllVehicles(round(vehicle_cost * _FINE))
    load = routing.RegisterUnaryTransitVector(_loads(fleet))
    # With shipments a vehicle may leave empty; what is delivered from the depot is on board first.
    routing.AddDimension(load, 0, vehicle.capacity[0], not rules.shipments, "load")
    if rules.clock is not None:
        _add_times(fleet, routing, manager, whole)
    for each in rules.shipments:
        _add_shipment(routing, *map(manager.NodeToIndex, (each.pickup, each.delivery)))
    parameters = _parameters(seconds)
    if rules.clock is not None:
        strategy = routing_enums_pb2.FirstSolutionStrategy.PARALLEL_CHEAPEST_INSERTION
        parameters.first_solution_strategy = strategy
    solution = routing.SolveWithParameters(parameters)
    return None if solution is None else _plan(manager, routing, solution)


def _loads(fleet: Fleet) -> list[int]:
    """What each stop adds to the load; of a delivery of a shipment it is negative."""
    visits = fleet.rules.visits
    loads = [sum(visit.demand) for visit in visits]
    for each in fleet.rules.shipments:
        loads[each.delivery] = -loads[each.pickup]
    return loads


def _add_times(
    fleet: Fleet,
    routing: pywrapcp.RoutingModel,
    manager: pywrapcp.RoutingIndexManager,
    whole: NDArray[np.int64],
) -> None:
    rules = fleet.rules
    (vehicle,) = rules.vehicles
    services = np.array([round(visit.service * _FINE) for visit in rules.visits])
    driven = routing.RegisterTransitMatrix((whole + services[:, np.newaxis]).tolist())
    begin, end = (round(time * _FINE) for time in vehicle.shift)
    routing.AddDimension(driven, end, end, False, "time")
    times = routing.GetDimensionOrDie("time")
    for stop in rules.clients:
        opens, closes = rules.visits[stop].windows[0]
        until = round(min(closes * _FINE, end))
        times.CumulVar(manager.NodeToIndex(stop)).SetRange(round(opens * _FINE), until)
    for number in range(routing.vehicles()):
        times.CumulVar(routing.Start(number)).SetRange(begin, end)
        times.CumulVar(routing.End(number)).SetRange(begin, end)


def _add_shipment(routing: pywrapcp.RoutingModel, pickup: int, delivery: int) -> None:
    routing.AddPickupAndDelivery(pickup, delivery)
    solver, times = routing.solver(), routing.GetDimensionOrDie("time")
    solver.Add(routing.VehicleVar(pickup) == routing.VehicleVar(delivery))
    solver.Add(times.CumulVar(pickup) <= times.CumulVar(delivery))
