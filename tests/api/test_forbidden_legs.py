"""Forbidden legs in every kind of plan against a live server, and the refusals without a tour."""

import io
import json
from itertools import pairwise
from typing import Any

import httpx
import numpy as np
import pytest

from service.instance import Instance, tour_lengths
from service.pareto import nondominated
from tests.helpers.instances import every_tour
from tests.helpers.sampled import third
from tests.helpers.serving import problem

N = 7
IDS = ["depot", *(f"order-{i}" for i in range(1, N))]


def costs_with_no_way(seed: int, share: float = 0.3) -> np.ndarray:
    """Costs, some of them infinite in one objective, and an arbitrary diagonal."""
    rng = np.random.default_rng(seed)
    costs = rng.integers(1, 20, (2, N, N)).astype(float)
    costs[rng.random((2, N, N)) < share / 2] = np.inf
    costs[:, np.arange(N), np.arange(N)] = [[np.inf], [-1.0]]
    return costs


def as_json(costs: np.ndarray) -> Any:
    return np.where(np.isinf(costs), None, costs).tolist()


def exact_front(costs: np.ndarray, **ends: Any) -> list[list[float]]:
    instance = Instance(matrices=np.abs(costs), **ends)
    lengths = tour_lengths(instance, every_tour(instance))
    return lengths[nondominated(lengths)].tolist()


def check(answer: httpx.Response, expected: list[list[float]]) -> None:
    """Check a front against the exact one; without one, against a refusal that names stops."""
    assert b"Infinity" not in answer.content
    assert b"NaN" not in answer.content
    if not expected:
        document = problem(answer, 422, "no-plan")
        assert "ways" in document["detail"] or "a way must" in document["detail"]
        return
    assert answer.status_code == 200, answer.text
    assert [tour["lengths"] for tour in answer.json()["front"]] == expected


def npy(costs: np.ndarray) -> bytes:
    content = io.BytesIO()
    np.save(content, costs)
    return content.getvalue()


def objectives(costs: np.ndarray) -> list[dict[str, Any]]:
    return [{"name": f"cost {m}", "matrix": as_json(each)} for m, each in enumerate(costs)]


@pytest.mark.parametrize("seed", range(third(12)))
@pytest.mark.parametrize("form", ["matrices", "stops", "file"])
@pytest.mark.parametrize("closed", [True, False])
def test_a_front_is_the_exact_one_without_the_forbidden_legs(
    client: httpx.Client, seed: int, form: str, closed: bool
) -> None:
    costs = costs_with_no_way(seed, 0.3 + 0.05 * seed)
    request: dict[str, Any] = {"closed": closed, "time_limit": 0.2, "arrivals": True}
    if form == "file":
        part = {"request": json.dumps(request).encode(), "matrices": npy(costs)}
        answer = client.post("/front", files={k: (k, v) for k, v in part.items()})
    elif form == "stops":
        stops = [{"id": name} for name in IDS]
        both = {"stops": stops, "objectives": objectives(costs)}
        answer = client.post("/front", json={**request, **both})
    else:
        answer = client.post("/front", json={**request, "matrices": as_json(costs)})
    check(answer, exact_front(costs, **({} if closed else {"closed": False, "start": 0})))


def test_what_is_plainly_impossible_is_refused_at_once_and_named(client: httpx.Client) -> None:
    costs = np.ones((2, N, N))
    costs[1, 3] = np.inf
    request = {"stops": [{"id": name} for name in IDS], "objectives": objectives(costs)}
    headers = {"Prefer": "respond-async"}
    refused = problem(client.post("/front", json=request, headers=headers), 422, "no-plan")
    sentence = "a way must lead from stop 'order-3' to another stop, and none does"
    assert refused["detail"] == sentence
    fault = {"detail": sentence, "pointer": "/stops/3", "code": "no-plan"}
    assert refused["errors"] == [fault]


def test_a_job_that_finds_no_tour_fails_with_the_reason(client: httpx.Client) -> None:
    spider = np.full((2, 7, 7), np.inf)  # three legs of two cities; a route can have two of them
    for origin, destination in ((0, 1), (1, 2), (0, 3), (3, 4), (0, 5), (5, 6)):
        spider[:, origin, destination] = spider[:, destination, origin] = 1.0
    request = {"matrices": as_json(spider), "closed": False, "start": None, "time_limit": 0.2}
    accepted = client.post("/front", json=request, headers={"Prefer": "respond-async"})
    assert accepted.status_code == 202
    events = client.get(f"/front/{accepted.json()['id']}/events").text
    front = client.get(f"/front/{accepted.json()['id']}").json()
    assert (front["status"], front["problem"]["code"]) == ("failed", "no-plan")
    assert front["problem"]["detail"] == (
        "no tour without a forbidden leg exists: all were tried; the fewest ways lead to and from"
        " cities 2, 4 and 6"
    )
    assert '"status":"failed"' in events


def test_the_network_alone_never_takes_a_forbidden_leg(client: httpx.Client) -> None:
    ring = np.full((2, 30, 30), np.inf)
    ring[:, np.arange(30), np.arange(1, 31) % 30] = 1.0
    request = {"matrices": as_json(ring), "time_limit": 0}
    answer = client.post("/front", json=request)
    if answer.status_code != 200:
        assert "a time_limit above 0" in problem(answer, 422, "no-plan")["detail"]
        return
    assert [tour["lengths"] for tour in answer.json()["front"]] == [[30, 30]]


def test_a_forbidden_leg_of_an_initial_tour_is_not_kept(client: httpx.Client) -> None:
    costs = np.full((2, N, N), 2.0)
    costs[:, 0, 1] = np.inf
    request = {"matrices": as_json(costs), "initial_tours": [list(range(N))], "time_limit": 0.2}
    check(client.post("/front", json=request), [[2.0 * N, 2.0 * N]])


@pytest.mark.parametrize("number", ["NaN", "Infinity"])
def test_other_numbers_that_are_not_finite_are_refused_with_what_to_write(
    client: httpx.Client, number: str
) -> None:
    body = f'{{"matrices": [[[0, 1], [{number}, 0]], [[0, 1], [1, 0]]]}}'
    answer = client.post("/front", content=body, headers={"Content-Type": "application/json"})
    document = problem(answer, 422, "invalid-request")
    assert "or null where there is no way" in document["detail"]
    assert document["errors"][0]["pointer"] == "/matrices/0/1/0"


def test_not_a_number_in_a_file_is_refused_with_what_to_write(client: httpx.Client) -> None:
    costs = np.ones((2, 3, 3))
    costs[1, 2, 0] = np.nan
    files = {"request": ("request", b"{}"), "matrices": ("matrices", npy(costs))}
    document = problem(client.post("/front", files=files), 422, "invalid-request")
    sentence = "matrices/1/2/0 must be a number, or infinity where there is no way, got NaN"
    assert document["detail"] == sentence


@pytest.mark.parametrize("seed", range(third(12)))
@pytest.mark.parametrize("form", ["matrices", "mixed"])
def test_a_replanned_front_avoids_closed_legs_and_can_be_replanned_again(
    client: httpx.Client, seed: int, form: str
) -> None:
    costs = costs_with_no_way(seed, 0.15)
    request: dict[str, Any] = {"matrices": as_json(costs)}
    if form == "mixed":  # one objective is a plane, so costs that change are not in a file
        points = np.random.default_rng(seed).integers(0, 9, (N, 2)).astype(float)
        costs[1] = np.hypot(*np.moveaxis(points[:, None] - points, -1, 0))
        plane = {"name": "plane", "coordinates": points.tolist()}
        first, _ = objectives(costs)
        request = {"stops": [{"id": name} for name in IDS], "objectives": [first, plane]}
    answer = client.post("/front", json={**request, "time_limit": 0.2})
    expected = exact_front(costs)
    if not expected:
        problem(answer, 422, "no-plan")
        return
    np.testing.assert_allclose([t["lengths"] for t in answer.json()["front"]], expected)
    front = answer.json()
    for _ in range(2):
        origin, destination = front["front"][0]["tour"][:2]
        closed = {"objective": 1, "from": origin, "to": destination, "cost": None}
        costs[:, origin, destination] = np.inf
        answer = client.post(
            f"/front/{front['id']}/replan", json={"costs": [closed], "time_limit": 0.2}
        )
        expected = exact_front(costs)
        if not expected:
            problem(answer, 422, "no-plan")
            return
        front = answer.json()
        np.testing.assert_allclose([t["lengths"] for t in front["front"]], expected)
        assert all(tour["kept"] <= 1 for tour in front["front"])


def test_stops_are_added_with_no_way_to_some(client: httpx.Client) -> None:
    costs = np.random.default_rng(3).integers(1, 20, (2, N, N)).astype(float)
    front = client.post("/front", json={"matrices": costs.tolist(), "time_limit": 0.2}).json()
    to: list[float | None] = [None, 4, None, 3, None, 5, 1, None]
    back: list[float | None] = [2, None, 7, None, 6, None, None, 3]
    item = {"id": "new", "costs": [{"to": to, "from": back}, {"to": [1] * (N + 1)}]}
    answer = client.post(f"/front/{front['id']}/replan", json={"add": [item], "time_limit": 0.2})
    extended = np.pad(costs, ((0, 0), (0, 1), (0, 1)), constant_values=1.0)
    extended[0, N] = [np.inf if cost is None else cost for cost in to]
    extended[0, :, N] = [np.inf if cost is None else cost for cost in back]
    check(answer, exact_front(extended))
    alone = {"id": "alone", "costs": [{"to": [None] * (N + 1)}, {"to": [1] * (N + 1)}]}
    answer = client.post(f"/front/{front['id']}/replan", json={"add": [alone], "time_limit": 0.2})
    document = problem(answer, 422, "no-plan")
    assert "to stop 'alone' from another stop" in document["detail"]
    assert [error["pointer"] for error in document["errors"]] == ["/add/0"] * 2


def test_places_on_a_map_may_have_no_way_under_the_second_objective(client: httpx.Client) -> None:
    matrix = np.full((4, 4), 2.0)
    matrix[0, 1] = matrix[1, 0] = np.inf
    places = [[0, 0], [0, 1], [3, 3], [4, 4]]
    request = {
        "grid": [[0] * 5] * 5,
        "cell_size": 1.0,
        "places": places,
        "second_matrix": as_json(matrix),
        "time_limit": 0.2,
        "paths": True,
    }
    answer = client.post("/coverage", json=request)
    assert answer.status_code == 200
    for item in answer.json()["front"]:
        assert item["lengths"][1] == 8
        around = [*item["tour"], item["tour"][0]]
        assert not {(0, 1), (1, 0)} & set(pairwise(around))
    replanned = client.post(
        f"/front/{answer.json()['id']}/replan", json={"done": [0], "time_limit": 0.2}
    )
    assert replanned.status_code == 200, replanned.text
    matrix[2] = np.inf
    refused = client.post("/coverage", json={**request, "second_matrix": as_json(matrix)})
    document = problem(refused, 422, "no-plan")
    assert document["detail"] == "a way must lead from place 2 to another place, and none does"
    assert document["errors"][0]["pointer"] == "/places/2"
