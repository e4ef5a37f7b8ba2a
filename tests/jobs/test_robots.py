"""Robots that share a map: their plans against brute force, a check of their own, and one robot."""

import json
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from service.errors import Refusal
from service.jobs.task_runner import TaskRunner
from service.kinds.parsing import parse_task
from service.requests.limits import Limits
from service.requests.task import TaskSource
from tests.helpers.robot_plans import best_plans, check_answer
from tests.helpers.sampled import third
from tests.helpers.serving import ACTORS

LIMITS = Limits(body_bytes=10**6, cities=60, cells=900, preferences=20, size=50, seconds=30.0)
RUNNER = TaskRunner({actor.info.name: actor for actor in ACTORS}, LIMITS)


def answer_to(request: dict[str, Any], runner: TaskRunner = RUNNER) -> dict[str, Any]:
    """Return the answer that a worker gives, without HTTP."""
    source = TaskSource("coverage", json.dumps(request).encode())
    task = parse_task(source, runner.limits, runner.infos)
    document = runner.run(task, lambda: False, lambda *_: None)
    answer: dict[str, Any] = json.loads(document.json(id=""))
    return answer


def random_request(seed: int, places: int, robots: int = 2) -> dict[str, Any]:
    """Return a request on a map with a wall that leaves ways round; robots may share starts."""
    random = np.random.default_rng(seed)
    grid = np.zeros((5, 7), dtype=np.int64)
    grid[2, 1:6] = random.random(5) < 0.7
    free = random.permutation(np.argwhere(grid == 0))[:places]
    starts = random.integers(0, places, robots).tolist()
    request = {
        "grid": grid.tolist(),
        "cell_size": 0.5,
        "places": free.tolist(),
        "paths": True,
        "robots": [{"id": f"robot-{i}", "start": start} for i, start in enumerate(starts)],
        "time_limit": 1.0,
    }
    if seed % 2:
        request["closed"] = False
        for robot in request["robots"]:
            if random.random() < 0.5:
                robot["end"] = int(random.integers(places))
    return request


@pytest.mark.parametrize("seed", range(third(12)))
def test_of_two_robots_every_plan_is_compared(seed: int) -> None:
    request = random_request(seed, places=5)
    answer = answer_to(request)
    check_answer(request, answer)
    found = [plan["lengths"] for plan in answer["front"]]
    np.testing.assert_allclose(found, best_plans(request))


def test_many_robots_are_planned_by_the_search_and_by_the_network_alone() -> None:
    request = random_request(4, places=20, robots=3)
    cut = answer_to({**request, "time_limit": 0})  # first: it compiles what the search needs
    check_answer(request, cut)
    assert cut["actor"]["name"] == "pa-one-matrix"
    check_answer(request, answer_to({**request, "time_limit": 2}))


def test_without_a_network_many_robots_need_time() -> None:
    request = random_request(4, places=20, robots=3)
    with pytest.raises(Refusal, match="need an actor"):
        answer_to({**request, "time_limit": 0}, TaskRunner({}, LIMITS))


@pytest.mark.parametrize("closed", [True, False])
def test_one_robot_goes_the_shortest_tour_of_the_plain_front(closed: bool) -> None:
    request = random_request(2, places=7, robots=1)
    request["robots"][0]["start"] = 3
    shared = answer_to({**request, "closed": closed})
    plain = {name: value for name, value in request.items() if name != "robots"}
    plain |= {"start": 3, "closed": closed, "cost_layer": np.ones((5, 7)).tolist()}
    [plan] = shared["front"]
    assert plan["lengths"][0] == plan["lengths"][1]
    assert plan["lengths"][0] == pytest.approx(answer_to(plain)["front"][0]["lengths"][0])


def test_robots_at_one_dock_are_named_each_once() -> None:
    request = random_request(0, places=6)
    request["robots"] = [{"id": name} for name in "abc"]
    answer = answer_to(request)
    check_answer(request, answer)
    names = [[route["robot"] for route in plan["routes"]] for plan in answer["front"]]
    assert all(each == list("abc")[: len(each)] for each in names)
    assert len(names[-1]) > 1


def test_a_place_where_a_robot_ends_is_visited_though_it_stays() -> None:
    request = {
        "grid": [[0] * 6],
        "cell_size": 1,
        "places": [[0, 0], [0, 5], [0, 1]],
        "closed": False,
        "robots": [{"id": "stays", "start": 0, "end": 1}, {"id": "goes", "start": 2}],
    }
    [plan] = answer_to(request)["front"]
    assert plan["lengths"] == [4, 4]
    assert plan["routes"] == [{"robot": "goes", "tour": [2, 1], "lengths": [4, 4]}]


def test_poses_are_places_of_their_own_that_need_no_visit() -> None:
    request = {
        "grid": [[0] * 6],
        "cell_size": 1,
        "origin": [0, 0, 0],
        "places": [[0, 2]],
        "closed": False,
        "paths": True,
        "robots": [{"id": "a", "start_pose": [0.5, 0.5], "end_pose": [3.5, 0.5]}],
    }
    answer = answer_to(request)
    assert answer["places"] == [[0, 2], [0, 0], [0, 3]]
    [plan] = answer["front"]
    assert (plan["lengths"], plan["routes"][0]["tour"]) == ([3, 3], [1, 0, 2])
    assert plan["routes"][0]["path"]["points"] == [[x + 0.5, 0.5] for x in range(4)]


def test_both_objectives_may_be_sums_of_different_costs() -> None:
    request = random_request(6, places=5)
    costs = np.random.default_rng(0).integers(1, 9, (5, 5)).tolist()
    answer = answer_to({**request, "second_matrix": costs, "over": ["sum", "sum"]})
    assert [each["name"] for each in answer["objectives"]] == ["total distance", "total cost"]
    for plan in answer["front"]:
        lengths = np.array([route["lengths"] for route in plan["routes"]])
        np.testing.assert_allclose(plan["lengths"], lengths.sum(axis=0))
        for route in plan["routes"]:
            tour = route["tour"]
            second = sum(costs[a][b] for a, b in pairwise(tour))
            assert route["lengths"][1] == second


def test_paths_of_too_many_cells_are_refused_with_the_plans_that_fit() -> None:
    request = random_request(2, places=5)
    plans = answer_to(request)["front"]
    cells = [sum(len(route["path"]["cells"]) for route in plan["routes"]) for plan in plans]
    assert len(plans) > 1
    runner = replace(RUNNER, limits=replace(LIMITS, path_cells=sum(cells) - 1))
    with pytest.raises(Refusal, match="ask for a size of") as raised:
        answer_to(request, runner)
    assert (raised.value.code, raised.value.actual) == ("paths-too-long", sum(cells))


def test_robots_share_no_more_places_than_a_fleet_has_stops() -> None:
    request = random_request(2, places=5)
    runner = replace(RUNNER, limits=replace(LIMITS, fleet_stops=4))
    with pytest.raises(Refusal, match="at most 4 rows, got 5"):
        answer_to(request, runner)
    spaced = {**request, "spacing": 0.5}
    del spaced["places"]
    with pytest.raises(Refusal, match="at most 4 places"):
        answer_to(spaced, runner)


@pytest.mark.parametrize(
    ("change", "pointer", "sentence"),
    [
        ({"robots": []}, "/robots", "must have 1 item or more"),
        ({"robots": [{"id": "a"}] * 101}, "/robots", "must have 100 items or fewer, got 101"),
        ({"robots": [{"id": "a"}, {"id": "a"}]}, "/robots/1/id", "must not be that of robots/0"),
        ({"robots": [{"start": 0}]}, "/robots/0/id", "is required"),
        ({"robots": [{"id": "a", "count": 2}]}, "/robots/0/count", "is not a field"),
        ({"robots": [{"id": "a", "start": 9}]}, "/robots/0/start", "must be a place, 0 to 4"),
        ({"robots": [{"id": "a", "end": 1}]}, "/robots/0/end", "with closed false"),
        (
            {"closed": False, "robots": [{"id": "a", "end": 5}]},
            "/robots/0/end",
            "must be a place, 0 to 4, got 5",
        ),
        (
            {"origin": [0, 0, 0], "robots": [{"id": "a", "start": 0, "start_pose": [1, 1]}]},
            "/robots/0/start_pose",
            "or start must be left out",
        ),
        (
            {"robots": [{"id": "a", "start_pose": [1, 1]}]},
            "/robots/0/start_pose",
            "must be in the frame of a map with an origin",
        ),
        (
            {"origin": [0, 0, 0], "robots": [{"id": "a", "start_pose": [99, 1]}]},
            "/robots/0/start_pose",
            "must be a cell of the grid of 5 x 7 cells",
        ),
        ({"start": 0}, "/start", "must be left out with robots"),
        ({"initial_tours": [[0, 1, 2, 3, 4]]}, "/initial_tours", "must be left out with robots"),
        ({"arrivals": True}, "/arrivals", "must be left out with robots"),
        ({"actor": "pa-one-matrix"}, "/actor", "must be left out with robots"),
        ({"over": ["max", "max"]}, "/over/1", "must be sum, as over/0 is max"),
        ({"robots": None, "over": ["sum", "max"]}, "/over", "is for several robots"),
        (
            {"grid": [[0, 0, 1, 0, 0, 0, 0]] * 5, "places": [[0, 0], [0, 6]]},
            "/places/1",
            "must be reachable from places/0",
        ),
    ],
)
def test_what_robots_cannot_do_is_named(
    change: dict[str, Any], pointer: str, sentence: str
) -> None:
    request = random_request(2, places=5)
    request["robots"] = [{"id": "a"}, {"id": "b", "start": 1}]
    request |= change
    request = {name: value for name, value in request.items() if value is not None}
    with pytest.raises(Refusal, match=sentence) as raised:
        answer_to(request)
    assert [fault.pointer for fault in raised.value.errors] == [pointer]
