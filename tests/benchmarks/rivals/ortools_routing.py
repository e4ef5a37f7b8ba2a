"""OR-Tools' routing solver under weighted sums: as the paper's rival, guided, and with hints."""

import time

import numpy as np
from numpy.typing import NDArray
from ortools.constraint_solver import pywrapcp, routing_enums_pb2
from ortools.util import optional_boolean_pb2

Array = NDArray[np.float64]

FINENESS = 1_000_000  # the largest cost becomes this many whole units
HINTED_WEIGHTS = 5  # making a routing model for each takes a tenth of a second or two
_LEAST = 0.002  # seconds of a search


def solve(cost: Array, solution_limit: int | None) -> NDArray[np.int64]:
    """A tour under costs of shape (n, n), by the cheapest arc first and local search from there.

    Without a solution limit the local search runs until no move of its neighbourhoods improves.
    """
    parameters = pywrapcp.DefaultRoutingSearchParameters()
    parameters.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PATH_CHEAPEST_ARC
    if solution_limit is not None:
        parameters.solution_limit = solution_limit
    return _tour(cost, parameters)


def guided(cost: Array, seconds: float) -> NDArray[np.int64]:
    """A tour under costs of shape (n, n), by guided local search for some seconds.

    The settings are the best of a short trial on 60 stops by road: five first solutions, with and
    without operators that are off by default. The two for single tours gain most.
    """
    parameters = pywrapcp.DefaultRoutingSearchParameters()
    strategies = routing_enums_pb2.FirstSolutionStrategy
    parameters.first_solution_strategy = strategies.PARALLEL_CHEAPEST_INSERTION
    heuristics = routing_enums_pb2.LocalSearchMetaheuristic
    parameters.local_search_metaheuristic = heuristics.GUIDED_LOCAL_SEARCH
    parameters.local_search_operators.use_tsp_opt = optional_boolean_pb2.BOOL_TRUE
    parameters.local_search_operators.use_tsp_lns = optional_boolean_pb2.BOOL_TRUE
    parameters.time_limit.FromMicroseconds(int(1e6 * seconds))
    return _tour(cost, parameters)


def improved_routes(costs: Array, hints: NDArray[np.int64], seconds: float) -> NDArray[np.int64]:
    """Routes from city 0 to the last one, each the best of some hints and improved from there.

    Args:
        costs: Shape (2, n, n).
        hints: Routes, shape (k, n).
        seconds: For all of them together; evenly spread weighted sums are taken in turn.

    Returns:
        A route for each weighted sum that there was time for, shape (m, n).
    """
    ends = time.perf_counter() + seconds
    routes = []
    for turn, share in enumerate(np.linspace(0, 1, HINTED_WEIGHTS)):
        turn_ends = ends - (HINTED_WEIGHTS - 1 - turn) * seconds / HINTED_WEIGHTS
        cost = (1 - share) * costs[0] + share * costs[1]
        if turn and time.perf_counter() >= turn_ends:
            continue
        lengths = cost[hints[:, :-1], hints[:, 1:]].sum(axis=1)
        routes.append(_improved(cost, hints[lengths.argmin()], turn_ends))
    return np.array(routes)


def _tour(cost: Array, parameters: pywrapcp.DefaultRoutingSearchParameters) -> NDArray[np.int64]:
    """The closed tour that the solver finds from city 0; TimeoutError if it finds none in time."""
    whole = np.rint(cost * (FINENESS / cost.max())).astype(np.int64)
    manager = pywrapcp.RoutingIndexManager(len(cost), 1, 0)
    routing = pywrapcp.RoutingModel(manager)
    callback = routing.RegisterTransitMatrix(whole.tolist())
    routing.SetArcCostEvaluatorOfAllVehicles(callback)
    solution = routing.SolveWithParameters(parameters)
    if solution is None:
        raise TimeoutError
    tour, index = [], routing.Start(0)
    while not routing.IsEnd(index):
        tour.append(manager.IndexToNode(index))
        index = solution.Value(routing.NextVar(index))
    return np.array(tour)


def _improved(cost: Array, hint: NDArray[np.int64], ends: float) -> NDArray[np.int64]:
    """A route improved by guided local search until a time by time.perf_counter()."""
    n = len(cost)
    manager = pywrapcp.RoutingIndexManager(n, 1, [0], [n - 1])
    routing = pywrapcp.RoutingModel(manager)
    whole = np.rint(cost * (FINENESS / cost.max())).astype(np.int64)
    callback = routing.RegisterTransitMatrix(whole.tolist())
    routing.SetArcCostEvaluatorOfAllVehicles(callback)
    parameters = pywrapcp.DefaultRoutingSearchParameters()
    heuristics = routing_enums_pb2.LocalSearchMetaheuristic
    parameters.local_search_metaheuristic = heuristics.GUIDED_LOCAL_SEARCH
    left = max(_LEAST, ends - time.perf_counter())
    parameters.time_limit.FromMicroseconds(int(1e6 * left))
    routing.CloseModelWithParameters(parameters)
    assignment = routing.ReadAssignmentFromRoutes([hint[1:-1].tolist()], True)
    solution = routing.SolveFromAssignmentWithParameters(assignment, parameters)
    if solution is None:  # no time was left
        return hint
    route, index = [], routing.Start(0)
    while not routing.IsEnd(index):
        route.append(manager.IndexToNode(index))
        index = solution.Value(routing.NextVar(index))
    return np.array([*route, manager.IndexToNode(index)])
