"""POST /coverage over the day, over HTTP, beside robots that are driven step by step here."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise, permutations
from typing import Any

import httpx
import numpy as np
import pytest
from paretour import Client, RobotFront

from service.api.schemas import documented
from tests.api.test_cost_layers import costs_of
from tests.api.test_plan_coverage import GRID, PLACES
from tests.helpers.robot_plans import best_plans, distances
from tests.helpers.serving import LIMITS, app_of, problem, serving

NOON = 43200.0
SPEED = 0.5
# Routes take some 10 to 30 seconds: people come and go on the way.
SLOWER = [[NOON, 1.0], [NOON + 5, 2.5], [NOON + 11, 0.7]]
CROWDS = [[0, 0.5], [NOON + 4, 6.0], [NOON + 9, 1.0]]
COSTS = np.random.default_rng(3).integers(1, 30, (len(PLACES), len(PLACES))).tolist()
ON_MAP = {
    "grid": GRID,
    "cell_size": 0.5,
    "places": PLACES,
    "robot_speed": SPEED,
    "time_limit": 30.0,
}
REQUEST = {
    **ON_MAP,
    "second_matrix": COSTS,
    "departure": NOON,
    "over_the_day": [SLOWER, CROWDS],
}
ROBOTS = [{"id": "left", "start": 0}, {"id": "right", "start": 2}]
RANGE = {"earliest": NOON, "latest": NOON + 10}
Point = tuple[float, ...]


@pytest.fixture(scope="module")
def client() -> Iterator[httpx.Client]:
    app = app_of(limits=replace(LIMITS, seconds=30.0))
    with serving(app) as address, httpx.Client(base_url=address, timeout=300) as client:
        yield client


def plan(client: httpx.Client, request: dict[str, Any]) -> dict[str, Any]:
    answer = client.post("/coverage", json=request)
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    assert found["terminated"] == "converged"  # long before its time is over
    return found


def refused(answer: httpx.Response, pointer: str) -> None:
    [error] = problem(answer, 422, "invalid-request")["errors"]
    assert error["pointer"] == pointer


def factor_at(factors: list[list[float]], time: float) -> float:
    known = [factor for begins, factor in factors if begins <= time]
    return known[-1] if known else factors[0][1]


def arrival(metres: float, time: float, factors: list[list[float]] = SLOWER) -> float:
    """When a robot has driven so far: part by part, at the pace of each slice of the day."""
    for ends in [begins for begins, _ in factors if begins > time]:
        driven = (ends - time) * SPEED / factor_at(factors, time)
        if driven >= metres:
            break
        metres, time = metres - driven, ends
    return time + metres / SPEED * factor_at(factors, time)


def driven(way: Sequence[int], departure: float = NOON) -> tuple[list[float], float]:
    """When a robot is at each place of a way, and what its legs cost as they begin."""
    metres = distances(ON_MAP)
    cells = [row * len(GRID[0]) + column for row, column in PLACES]
    times, costs = [departure], 0.0
    for a, b in pairwise(way):
        costs += COSTS[a][b] * factor_at(CROWDS, times[-1])
        times.append(arrival(metres[cells[a], cells[b]], times[-1]))
    return times, costs


def best_of(points: set[Point]) -> list[Point]:
    """The points that no other one dominates, in order."""
    front: list[Point] = []
    for point in sorted(points):
        if not front or point[1] < front[-1][1] - 1e-9:
            front.append(point)
    return front


@pytest.mark.parametrize("way", [{}, {"closed": False}, {"closed": False, "end": 3}])
def test_the_front_is_that_of_all_tours_driven_through_the_day(
    client: httpx.Client, way: dict[str, Any]
) -> None:
    answer = plan(client, {**REQUEST, **way})
    points = set()
    for rest in permutations(range(1, len(PLACES))):
        if way.get("end") in (None, rest[-1]):
            times, costs = driven([0, *rest] + ([] if way else [0]))
            points.add((times[-1] - NOON, costs))
    found = [tour["lengths"] for tour in answer["front"]]
    np.testing.assert_allclose(found, best_of(points))
    for tour in answer["front"]:
        times, _ = driven(tour["tour"] + ([] if way else [0]))
        np.testing.assert_allclose(tour["times"][: len(times)], times)
        assert tour["departure"] == NOON
    names = [{"name": "time", "unit": "s"}, {"name": "cost", "unit": None}]
    assert answer["objectives"] == names


def test_of_a_range_each_tour_leaves_when_it_takes_the_least_time(client: httpx.Client) -> None:
    for tour in plan(client, {**REQUEST, "departure": RANGE})["front"]:
        way = [*tour["tour"], tour["tour"][0]]
        times, costs = driven(way, tour["departure"])
        np.testing.assert_allclose(tour["lengths"], (times[-1] - times[0], costs))
        others = (driven(way, NOON + tenth / 10)[0] for tenth in range(101))
        assert tour["lengths"][0] <= min(each[-1] - each[0] for each in others) + 1e-6


def test_crowds_in_cost_layers_cost_more_when_they_are_there(client: httpx.Client) -> None:
    layer = np.random.default_rng(5).integers(0, 9, np.shape(GRID)).tolist()
    request = {**ON_MAP, "cost_layers": [{"name": "people", "layer": layer}], "departure": NOON}
    answer = plan(client, {**request, "over_the_day": [[], CROWDS], "paths": True})
    assert [each["name"] for each in answer["objectives"]] == ["time", "people"]
    for tour in answer["front"]:
        cells, at = tour["path"]["cells"], [cell for cell, _ in tour["path"]["visits"]]
        costs = [
            costs_of(cells[a : b + 1], layer) * factor_at(CROWDS, time)
            for (a, b), time in zip(pairwise(at), tour["times"], strict=False)
        ]
        np.testing.assert_allclose(tour["lengths"], (tour["path"]["metres"] / SPEED, sum(costs)))


def test_the_rest_of_a_tour_is_replanned_from_now(client: httpx.Client) -> None:
    answer = plan(client, REQUEST)
    path = f"/front/{answer['id']}/replan"
    refused(client.post(path, json={"done": [0]}), "/now")
    rest = client.post(path, json={"done": [0, 3], "now": NOON + 6, "time_limit": 30}).json()
    points = set()
    for left in permutations((1, 2, 4)):
        times, costs = driven([3, *left, 0], NOON + 6)
        points.add((times[-1] - NOON - 6, costs))
    np.testing.assert_allclose([tour["lengths"] for tour in rest["front"]], best_of(points))
    same_all_day = {name: REQUEST[name] for name in ("grid", "cell_size", "places", "time_limit")}
    answer = plan(client, {**same_all_day, "second_matrix": COSTS})
    refused(client.post(f"/front/{answer['id']}/replan", json={"done": [0], "now": 1}), "/now")


@pytest.mark.parametrize(
    "more",
    [
        {},
        {"departure": RANGE},
        {"closed": False, "robots": [{"id": "left", "end": 4}, {"id": "right", "start": 2}]},
    ],
)
def test_several_robots_drive_through_the_same_day(
    client: httpx.Client, more: dict[str, Any]
) -> None:
    request = {**REQUEST, "robots": ROBOTS, "over": ["max", "sum"], **more}
    answer = plan(client, request)
    documented(RobotFront).model_validate(answer)
    assert [each["unit"] for each in answer["objectives"]] == ["s", None]
    for each in answer["front"]:
        lengths = []
        for route in each["routes"]:
            times, costs = driven(route["tour"], route["times"][0])
            np.testing.assert_allclose(route["times"], times)
            np.testing.assert_allclose(route["lengths"], (times[-1] - times[0], costs))
            assert "departure" in more or times[0] == NOON
            assert NOON <= times[0] <= RANGE["latest"]
            lengths.append(route["lengths"])
        longest, total = np.max(lengths, axis=0)[0], np.sum(lengths, axis=0)[1]
        np.testing.assert_allclose(each["lengths"], (longest, total))


def test_robots_without_a_second_objective_trade_total_and_longest_times(
    client: httpx.Client,
) -> None:
    request = {**ON_MAP, "robots": ROBOTS, "departure": NOON, "over_the_day": [[[0, 2.0]]]}
    with Client(str(client.base_url)) as paretour:
        front = paretour.robots(**request)
    assert [each.name for each in front.objectives] == ["total time", "longest route"]
    seconds = np.array(best_plans(request)) / SPEED * 2
    np.testing.assert_allclose([each.lengths for each in front.plans], seconds)
    for route in (route for each in front.plans for route in each.routes):
        assert route.times is not None
        assert route.times[-1] - route.times[0] == pytest.approx(route.lengths[1])


@pytest.mark.parametrize(
    ("members", "pointer"),
    [
        ({"departure": None}, "/departure"),
        ({"robot_speed": None}, "/robot_speed"),
        ({"robot_speed": 0}, "/robot_speed"),
        ({"over_the_day": []}, "/over_the_day"),
        ({"over_the_day": [SLOWER]}, "/over_the_day"),
        ({"over_the_day": [[], [[10, 1], [10, 2]]]}, "/over_the_day/1/1/0"),
        ({"over_the_day": [[[0, 0.001]], []]}, "/over_the_day/0/0/1"),
        ({"departure": {"earliest": 2, "latest": 1}}, "/departure/latest"),
        ({"bound": True}, "/bound"),
        ({"robots": ROBOTS, "second_matrix": None}, "/over_the_day"),
        ({"detours": True, "second_matrix": None, "cost_layer": GRID}, "/detours"),
    ],
)
def test_what_cannot_be_is_refused(
    client: httpx.Client, members: dict[str, Any], pointer: str
) -> None:
    given = {**REQUEST, **members}
    request = {name: value for name, value in given.items() if value is not None}
    refused(client.post("/coverage", json=request), pointer)
