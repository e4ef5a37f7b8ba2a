"""OR-Tools' routing solver for fleets with one depot, capacities and a limit on each route."""

import numpy as np
from ortools.constraint_solver import pywrapcp, routing_enums_pb2

from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route
from tests.benchmarks.rivals.ortools_routing import FINENESS


def route_fleet(fleet: Fleet, limit: float, seconds: float) -> Plan | None:
    """The plan of the least first length with no route over a limit; None where none was found.

    From savings, by guided local search until the time is over. Of a fleet whose vehicles are of
    one type, start and end at stop 0, and have a capacity of one dimension.
    """
    (vehicle,) = fleet.rules.vehicles
    whole = np.ceil(fleet.costs[0] * FINENESS).astype(np.int64)
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
