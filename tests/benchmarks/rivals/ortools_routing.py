"""OR-Tools' routing solver under weighted sums, as the paper's rival "OR-Tools"."""

import numpy as np
from numpy.typing import NDArray
from ortools.constraint_solver import pywrapcp, routing_enums_pb2

Array = NDArray[np.float64]

FINENESS = 1_000_000  # the largest cost becomes this many whole units


def solve(cost: Array, solution_limit: int | None) -> NDArray[np.int64]:
    """A tour under costs of shape (n, n), by the cheapest arc first and local search from there.

    Without a solution limit the local search runs until no move of its neighbourhoods improves.
    """
    n = len(cost)
    whole = np.rint(cost * (FINENESS / cost.max())).astype(np.int64)
    manager = pywrapcp.RoutingIndexManager(n, 1, 0)
    routing = pywrapcp.RoutingModel(manager)
    callback = routing.RegisterTransitMatrix(whole.tolist())
    routing.SetArcCostEvaluatorOfAllVehicles(callback)
    parameters = pywrapcp.DefaultRoutingSearchParameters()
    parameters.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PATH_CHEAPEST_ARC
    if solution_limit is not None:
        parameters.solution_limit = solution_limit
    solution = routing.SolveWithParameters(parameters)
    tour, index = [], routing.Start(0)
    while not routing.IsEnd(index):
        tour.append(manager.IndexToNode(index))
        index = solution.Value(routing.NextVar(index))
    return np.array(tour)
