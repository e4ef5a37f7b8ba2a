"""POST /coverage with detours over HTTP: paths between places give up metres for cost."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations
from typing import Any

import httpx
import moocore
import numpy as np
import pytest

from tests.api.test_cost_layers import costs_of, layers
from tests.coverage.test_shortest_paths import by_scipy
from tests.helpers.serving import LIMITS, app_of, problem, serving

ROWS = COLUMNS = 9
CELL = 0.5
PLACES = [[0, 4], [8, 4], [4, 0], [4, 8], [7, 7]]


def layer(seed: int) -> np.ndarray:
    """Costs with dear cells among cheap ones, so that going round may pay."""
    rng = np.random.default_rng(seed)
    return rng.choice([0.1, 1.0, 20.0], (ROWS, COLUMNS), p=[0.5, 0.3, 0.2])


def task(seed: int = 1, **members: Any) -> dict[str, Any]:
    grid = np.random.default_rng(seed + 100).random((ROWS, COLUMNS)) < 0.1
    grid[tuple(np.array(PLACES).T)] = False
    grid[:, 4], grid[4] = False, False
    grid[4:, 7] = False
    given = {"cost_layer": layer(seed).tolist()} if "cost_layers" not in members else {}
    return {
        "grid": grid.astype(int).tolist(),
        "cell_size": CELL,
        "places": PLACES,
        "detours": True,
        "paths": True,
        "time_limit": 5.0,
        **given,
        **members,
    }


@pytest.fixture(scope="module")
def client() -> Iterator[httpx.Client]:
    limits = replace(LIMITS, cells=2000, cities=200, size=100, seconds=10.0)
    with (
        serving(app_of(limits=limits)) as address,
        httpx.Client(base_url=address, timeout=300) as client,
    ):
        yield client


def plan(client: httpx.Client, request: dict[str, Any], path: str = "/coverage") -> dict[str, Any]:
    answer = client.post(path, json=request)
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def lengths_of(answer: dict[str, Any]) -> np.ndarray:
    return np.array([item["lengths"] for item in answer["front"]])


def check_paths(answer: dict[str, Any], request: dict[str, Any]) -> None:
    """Each path visits the places in the order of its tour, and is as long as its tour."""
    blocked = np.array(request["grid"]) > 0
    by_layer = [item["layer"] for item in request.get("cost_layers", ())] or [request["cost_layer"]]
    for item in answer["front"]:
        cells = item["path"]["cells"]
        metres = [CELL * float(np.hypot(*np.diff(np.array(cells), axis=0).T).sum())]
        assert item["path"]["metres"] == pytest.approx(metres[0])
        costs = [costs_of(cells, each) for each in by_layer]
        assert item["lengths"] == pytest.approx([*metres, *costs])
        assert not blocked[tuple(np.array(cells).T)].any()
        assert np.abs(np.diff(np.array(cells), axis=0)).max(initial=1) == 1
        way = [answer["places"][place] for place in item["tour"]]
        way += way[:1] if answer.get("closed") is None and len(way) > 1 else []
        following = iter(cells)
        assert all(cell in following for cell in way)


@pytest.mark.parametrize("seed", range(4))
def test_the_cheapest_tour_and_those_of_every_weight_are_in_the_front(
    client: httpx.Client, seed: int
) -> None:
    request = task(seed)
    answer = plan(client, request)
    assert answer["terminated"] == "converged"
    check_paths(answer, request)
    free = np.array(request["grid"]) == 0
    numbers = np.array(PLACES) @ [COLUMNS, 1]
    found = lengths_of(answer)
    # Under each weight the best tour takes the best path of each leg; five weights of ours give
    # nearly all of these paths.
    for weight, above in ((0.0, 1e-9), (0.3, 0.02), (1.0, 0.02), (3.0, 0.02), (1e4, 1e-3)):
        costs = CELL * by_scipy(free, layer(seed), weight)[np.ix_(numbers, numbers)]
        tours = [(0, *rest, 0) for rest in permutations(range(1, len(PLACES)))]
        least = min(costs[tour[:-1], tour[1:]].sum() for tour in tours)
        ours = (found @ [1.0, weight]).min()
        assert least * (1 - 1e-9) <= ours <= least * (1 + above)


@pytest.mark.parametrize("seed", range(4))
def test_no_tour_by_shortest_paths_beats_the_front(client: httpx.Client, seed: int) -> None:
    with_detours = plan(client, task(seed))
    without = plan(client, task(seed, detours=False))
    point = with_detours["reference_point"]
    assert point == without["reference_point"]
    both = [moocore.hypervolume(lengths_of(each), ref=point) for each in (with_detours, without)]
    assert both[0] > both[1]
    assert with_detours["hypervolume"] == pytest.approx(both[0] / np.prod(point))
    for lengths in lengths_of(without):
        below = lengths_of(with_detours) <= lengths * (1 + 1e-9)
        assert below.all(axis=1).any()


@pytest.mark.parametrize("count", [2, 3])
def test_paths_give_up_metres_for_each_of_several_layers(client: httpx.Client, count: int) -> None:
    rng = np.random.default_rng(count)
    named = [
        {"name": item["name"], "layer": rng.choice([0.1, 20.0], (ROWS, COLUMNS)).tolist()}
        for item in layers(count)
    ]
    request = task(cost_layers=named)
    answer = plan(client, request)
    check_paths(answer, request)
    shortest = lengths_of(plan(client, task(cost_layers=named, detours=False)))
    assert (lengths_of(answer).min(axis=0)[1:] < shortest.min(axis=0)[1:]).all()
    point = answer["reference_point"]
    better, worse = (
        moocore.hypervolume(each, ref=point) for each in (lengths_of(answer), shortest)
    )
    assert better > worse


@pytest.mark.parametrize(
    "members",
    [
        {"time_limit": 0},
        {"time_limit": 0.01},
        {"time_limit": 0, "preferences": 7},
        {"closed": False, "start": 1},
        {"closed": False, "start": 1, "end": 3, "size": 2},
        {"places": PLACES[:1]},
        {"places": PLACES[:2]},
        {"cost_layer": np.zeros((ROWS, COLUMNS)).tolist()},
        {"cost_layer": np.ones((ROWS, COLUMNS)).tolist()},
        {"cost_layer": np.where(layer(1) > 1, 1e12, 1e-12).tolist()},
    ],
)
def test_every_option_has_paths_that_are_as_long_as_they_say(
    client: httpx.Client, members: dict[str, Any]
) -> None:
    request = task(arrivals=True, **members)
    answer = plan(client, request)
    check_paths(answer, request)
    assert len(answer["front"]) <= members.get("size", 100)
    for item in answer["front"]:
        assert item["arrivals"][-1] == pytest.approx(item["lengths"])


def test_a_front_with_detours_is_replanned_with_detours(client: httpx.Client) -> None:
    request = task(3)
    front = plan(client, request)
    tour = front["front"][0]["tour"]
    dear = layer(3)
    dear[:, 4] = 30.0
    changes = {"done": tour[:2], "cost_layer": dear.tolist(), "paths": True, "time_limit": 1.0}
    rest = plan(client, changes, f"/front/{front['id']}/replan")
    check_paths(rest, {**request, "cost_layer": dear.tolist()})
    assert {item["kept"] for item in rest["front"]} <= {0.0, 1 / 3, 2 / 3, 1.0}
    refused = client.post(f"/front/{front['id']}/replan", json={**changes, "bound": True})
    problem(refused, 422, "invalid-request")


@pytest.mark.parametrize(
    ("members", "pointer"),
    [
        ({"bound": True}, "/bound"),
        ({"cost_layer": None, "second_coordinates": [[0, 0]] * 5}, "/detours"),
        ({"robots": [{"id": "a"}, {"id": "b"}]}, "/detours"),
        ({"detours": 1}, "/detours"),
    ],
)
def test_what_has_no_detours_is_refused(
    client: httpx.Client, members: dict[str, Any], pointer: str
) -> None:
    request = {name: value for name, value in task(**members).items() if value is not None}
    found = problem(client.post("/coverage", json=request), 422, "invalid-request")
    assert pointer in [error["pointer"] for error in found["errors"]]


def test_the_front_grows_while_it_is_searched(client: httpx.Client) -> None:
    grid = np.zeros((40, 40), int).tolist()
    rng = np.random.default_rng(2)
    places = np.unique(rng.integers(0, 40, (150, 2)), axis=0).tolist()
    request = task(grid=grid, places=places, time_limit=1.0, paths=False)
    request["cost_layer"] = rng.choice([0.1, 20.0], (40, 40)).tolist()
    accepted = client.post("/coverage", json=request, headers={"Prefer": "respond-async"})
    path = accepted.headers["location"]
    events = client.get(f"{path}/events", headers={"Accept": "text/event-stream"}).text
    assert "event: progress" in events
    found = client.get(path).json()
    assert found["terminated"] == "time_limit"
    lengths = lengths_of(found)
    assert len(lengths) == len(moocore.filter_dominated(lengths))
