"""Forbidden legs in fleets of more stops than can be enumerated: all objectives, all ways in."""

from itertools import pairwise
from typing import Any

import httpx
import numpy as np
import pytest

N = 12
A, B = ({"name": name, "matrix": name} for name in ("a", "b"))
MEASURES = ("vehicles", "unassigned", "imbalance", "load_distance")
OBJECTIVES = {
    "total against longest": [A, {**A, "name": "longest", "over": "max"}],
    "longest against total": [{**A, "over": "max"}, {**A, "name": "total"}],
    "the same twice": [A, {**A, "name": "again"}],
    "two sums": [A, B],
    "three": [A, B, {**B, "name": "longest", "over": "max"}],
    **{measure: [A, {"name": "c", "measure": measure}] for measure in MEASURES},
}


def costs_with_no_way(n: int) -> dict[str, Any]:
    rng = np.random.default_rng(n)
    costs = rng.integers(1, 30, (2, n, n)).astype(object)
    costs[rng.random((2, n, n)) < 0.15] = None
    costs[:, 0] = costs[:, :, 0] = 30  # a way leads to and from the depot,
    costs[0, 1, 0] = costs[1, 0, 2] = costs[:, 3, 0] = costs[:, 0, 3] = None  # but for some
    costs[0, 3, 4] = costs[0, 4, 3] = costs[1, 3, 4] = costs[1, 4, 3] = 5
    return dict(zip("ab", costs.tolist(), strict=True))


def request_of(objectives: list[dict[str, Any]], time_limit: float) -> dict[str, Any]:
    matrices = costs_with_no_way(N)
    order: dict[str, Any] = {"demand": [1]}
    if any(each.get("measure") == "unassigned" for each in objectives):
        order["prize"] = 40
    return {
        "stops": [{"id": str(i), **(order if i else {})} for i in range(N)],
        "vehicles": [{"id": "van", "count": 3, "start": 0, "end": 0, "capacity": [N]}],
        "objectives": [
            {**each, "matrix": matrices[each["matrix"]]} if "matrix" in each else each
            for each in objectives
        ],
        "time_limit": time_limit,
    }


def check(request: dict[str, Any], answer: httpx.Response) -> None:
    """Check that plans take no leg that is forbidden in any objective."""
    check_routes(answer, [each["matrix"] for each in request["objectives"] if "matrix" in each])


def check_routes(answer: httpx.Response, matrices: list[Any]) -> None:
    assert answer.status_code == 200, answer.text
    for plan in answer.json()["front"]:
        for route in plan["routes"]:
            for a, b in pairwise(map(int, route.get("stops") or route["tour"])):
                assert all(matrix[a][b] is not None for matrix in matrices)


@pytest.mark.parametrize("time_limit", [0, 0.05])
@pytest.mark.parametrize("name", OBJECTIVES)
def test_no_plan_takes_a_forbidden_leg(client: httpx.Client, name: str, time_limit: float) -> None:
    request = request_of(OBJECTIVES[name], time_limit)
    check(request, client.post("/fleet", json=request))


@pytest.mark.parametrize("time_limit", [0, 0.05])
@pytest.mark.parametrize("name", ["total against longest", "two sums"])
def test_no_replanned_plan_does(client: httpx.Client, name: str, time_limit: float) -> None:
    request = request_of(OBJECTIVES[name], 0.05)
    front = client.post("/fleet", json=request).json()
    changes = {"remove": ["5"], "time_limit": time_limit}
    check(request, client.post(f"/front/{front['id']}/replan", json=changes))


@pytest.mark.parametrize("time_limit", [0, 0.05])
@pytest.mark.parametrize("over", ["sum", "max"])
def test_robots_take_no_forbidden_leg(client: httpx.Client, over: str, time_limit: float) -> None:
    places = [[row, column] for row in (0, 2, 4) for column in range(4)]
    matrix = costs_with_no_way(len(places))["a"]
    request = {
        "grid": [[0] * 5] * 5,
        "cell_size": 1.0,
        "places": places,
        "second_matrix": matrix,
        "robots": [{"id": name, "start": 0} for name in ("left", "right")],
        "over": ["sum", over],
        "time_limit": time_limit,
    }
    check_routes(client.post("/coverage", json=request), [matrix])
