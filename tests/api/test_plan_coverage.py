"""POST /coverage against a live server."""

import io
import json
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from paretour.plans import parse_robots
from paretour.values import parse_front
from PIL import Image

from service.api.app import Edge
from tests.helpers.actors import Shuffler
from tests.helpers.jobs import first_found
from tests.helpers.serving import LIMITS, app_of, problem, runner_of, serving, workers_of

GRID = [
    [0, 0, 0, 0, 0, 0],
    [0, 0, 0, 0, 0, 0],
    [1, 1, 1, 1, 0, 0],
    [0, 0, 0, 0, 0, 0],
    [0, 0, 0, 0, 0, 0],
]
WALLED = [[0, 0, 1, 0], [0, 0, 1, 0]]
PLACES = [[0, 0], [4, 0], [4, 5], [0, 5], [3, 2]]
POINTS = [[0, 0], [3, 4], [5, 5], [1, 0], [2, 2]]
TASK = {"grid": GRID, "cell_size": 0.5, "places": PLACES, "second_coordinates": POINTS}
LATER = {"Prefer": "respond-async"}


def changed(**members: Any) -> dict[str, Any]:
    """The task with other members, and without those that are None."""
    return {name: value for name, value in {**TASK, **members}.items() if value is not None}


def test_a_reference_point_that_plainly_no_tour_comes_below_is_refused(
    client: httpx.Client,
) -> None:
    answer = client.post("/coverage", json=changed(reference_point=[100, 5]))
    document = problem(answer, 422, "invalid-request")
    assert document["errors"][0]["pointer"] == "/reference_point/1"
    answer = client.post("/coverage", json=changed(reference_point=[100, 10.1]))
    assert answer.json()["hypervolume"] == 0


def test_places_on_a_map_become_a_front_with_paths(client: httpx.Client) -> None:
    answer = client.post("/coverage", json=changed(paths=True, start=2, size=10))
    assert answer.status_code == 200, answer.text
    body = answer.json()
    assert body["places"] == PLACES
    assert body["cities"] == 5
    assert body["actor"]["name"] == "pa-one-matrix"
    assert {"survey", "construction", "improvement", "paths"} < set(body["timings_ms"])
    for item in body["front"]:
        assert sorted(item["tour"]) == [0, 1, 2, 3, 4]
        assert item["tour"][0] == 2
        cells = np.array(item["path"]["cells"])
        assert cells[0].tolist() == cells[-1].tolist() == PLACES[2]
        assert {tuple(place) for place in PLACES} <= set(map(tuple, cells.tolist()))
        assert not np.array(GRID)[tuple(cells.T)].any()
        walked = 0.5 * np.hypot(*np.diff(cells, axis=0).T).sum()
        assert walked == pytest.approx(item["path"]["metres"]) == pytest.approx(item["lengths"][0])
        points = np.array(POINTS)[item["tour"]]
        steps = np.roll(points, -1, axis=0) - points
        assert np.hypot(*steps.T).sum() == pytest.approx(item["lengths"][1])


CLOSED_OFF = {
    "cells": 4,
    "square_metres": 1.0,
    "regions": [
        {"cells": 3, "cell": [3, 0], "box": [[2, 0], [3, 1]]},
        {"cells": 1, "cell": [0, 5], "box": [[0, 5], [0, 5]]},
    ],
}
WITH_ROOMS = [
    [0, 0, 0, 0, 1, 0],
    [1, 1, 1, 0, 1, 1],
    [1, 0, 1, 0, 0, 0],
    [0, 0, 1, 0, 0, 0],
]


@pytest.mark.parametrize(
    "members",
    [
        {"places": [[0, 0], [3, 5]], "second_matrix": [[0, 1], [1, 0]]},
        {"spacing": 1.0, "cost_layer": np.ones((4, 6)).tolist()},
        {"places": [[0, 0], [3, 5], [2, 3]], "robots": [{"id": "a"}, {"id": "b"}]},
    ],
)
def test_rooms_that_are_closed_off_are_uncovered(
    client: httpx.Client, members: dict[str, Any]
) -> None:
    task = {"grid": WITH_ROOMS, "cell_size": 0.5, **members}
    answer = client.post("/coverage", json=task).json()
    assert answer["uncovered"] == CLOSED_OFF
    assert client.get(f"/front/{answer['id']}").json()["uncovered"] == CLOSED_OFF
    parse = parse_robots if "robots" in members else parse_front
    found = parse(answer).uncovered
    assert found is not None
    assert (found.cells, found.square_metres) == (4, 1.0)
    assert [(each.cells, each.cell, each.box) for each in found.regions] == [
        (3, (3, 0), ((2, 0), (3, 1))),
        (1, (0, 5), ((0, 5), (0, 5))),
    ]


def test_where_every_free_cell_is_in_reach_nothing_is_uncovered(client: httpx.Client) -> None:
    answer = client.post("/coverage", json=TASK).json()
    assert answer["uncovered"] == {"cells": 0, "square_metres": 0.0, "regions": []}


def test_a_front_of_places_can_be_asked_for_again(client: httpx.Client) -> None:
    answer = client.post("/coverage", json=changed(paths=True)).json()
    assert client.get(f"/front/{answer['id']}").json() == answer
    tour = client.get("/tour", params={"angle": 45, "front": answer["id"]}).json()
    assert tour["path"]["metres"] == pytest.approx(tour["lengths"][0])


def test_paths_come_only_where_they_are_asked_for(client: httpx.Client) -> None:
    answer = client.post("/coverage", json=TASK).json()
    assert all(set(item) == {"angle", "balance", "lengths", "tour"} for item in answer["front"])


@pytest.mark.parametrize(
    "second",
    [
        {"second_matrix": np.random.default_rng(0).random((5, 5)).tolist()},
        {"cost_layer": np.random.default_rng(0).random((5, 6)).tolist()},
    ],
)
def test_the_second_objective_comes_in_three_ways(
    client: httpx.Client, second: dict[str, Any]
) -> None:
    answer = client.post("/coverage", json=changed(second_coordinates=None, **second))
    assert answer.status_code == 200, answer.text
    assert answer.json()["hypervolume"] > 0


def test_places_are_laid_out_by_spacing(client: httpx.Client) -> None:
    layer = {"second_coordinates": None, "cost_layer": np.ones((5, 6)).tolist()}
    answer = client.post("/coverage", json=changed(places=None, spacing=1.5, **layer))
    assert answer.json()["places"] == [[1, 1], [1, 4], [4, 1], [4, 4]]


def test_one_place_is_a_front_of_one_tour(client: httpx.Client) -> None:
    task = changed(places=PLACES[:1], second_coordinates=[[1, 2]], paths=True)
    [item] = client.post("/coverage", json=task).json()["front"]
    assert item["path"] == {"cells": [[0, 0]], "metres": 0, "visits": [[0, 0], [0, 0]]}


# Tasks that are well-formed and cannot be covered, which a worker finds out.
@pytest.mark.parametrize(
    ("change", "pointer", "sentence"),
    [
        ({"robot_radius": 9}, "/grid", "grid must have a free cell farther than 9 m from every"),
        ({"grid": [[1] * 6] * 5}, "/grid", "grid must have a free cell farther than 0 m from"),
        ({"places": None}, "/places", "places or spacing is required, and not both"),
        ({"spacing": 1}, "/places", "places or spacing is required, and not both"),
        (
            {"places": [[5, 0], *PLACES[1:]]},
            "/places/0",
            "places/0 must be a cell of the grid of 5 x 6 cells, got [5, 0]",
        ),
        (
            {"places": [[2, 0], *PLACES[1:]]},
            "/places/0",
            "places/0 must be a free cell, and [2, 0] is an obstacle",
        ),
        (
            {"places": [*PLACES[:4], [3, 1]], "robot_radius": 0.5},
            "/places/4",
            "places/4 must be a cell farther than 0.5 m from every obstacle, and [3, 1] is not",
        ),
        ({"second_coordinates": None}, "/second_matrix", "second_matrix or cost_layer or"),
        ({"cost_layer": [[1]]}, "/second_matrix", "is required, and only one of them"),
        ({"second_coordinates": [[0, 0]]}, "/second_coordinates", "a row for each of 5 places"),
        (
            {"second_coordinates": None, "cost_layer": [[1, 1]]},
            "/cost_layer",
            "cost_layer must be as large as grid, 5 x 6 cells, got 1 x 2 cells",
        ),
        (
            {"second_coordinates": None, "cost_layer": (-np.eye(5, 6)).tolist()},
            "/cost_layer/0/0",
            "cost_layer/0/0 must be finite and not negative, got -1",
        ),
        (
            {"second_coordinates": None, "second_matrix": [[0, 1], [1, 0]]},
            "/second_matrix",
            "second_matrix must have a row for each of 5 places, got 2",
        ),
    ],
)
def test_what_cannot_be_covered_is_named(
    client: httpx.Client, change: dict[str, Any], pointer: str, sentence: str
) -> None:
    document = problem(client.post("/coverage", json=changed(**change)), 422, "invalid-request")
    assert document["errors"][0]["pointer"] == pointer
    assert sentence in document["errors"][0]["detail"]


@pytest.mark.parametrize("number", ["NaN", "Infinity", "1e400"])
def test_a_cost_that_is_not_finite_is_named(client: httpx.Client, number: str) -> None:
    layer = {"second_coordinates": None, "grid": [[0, 0]], "cost_layer": [["!", 0]]}
    body = json.dumps(changed(places=[[0, 0], [0, 1]], **layer)).replace('"!"', number)
    headers = {"Content-Type": "application/json"}
    document = problem(
        client.post("/coverage", content=body, headers=headers), 422, "invalid-request"
    )
    assert document["errors"][0]["pointer"] == "/cost_layer/0/0"


def test_all_places_that_cannot_be_reached_are_named(client: httpx.Client) -> None:
    task = changed(grid=WALLED, places=[[0, 0], [0, 3], [1, 3]], second_coordinates=POINTS[:3])
    document = problem(client.post("/coverage", json=task), 422, "invalid-request")
    assert [fault["pointer"] for fault in document["errors"]] == ["/places/1", "/places/2"]
    assert document["detail"].endswith("(and 1 more)")


def test_a_spacing_that_lays_out_too_many_places_is_413(client: httpx.Client) -> None:
    ground = {"grid": [[0] * 30] * 30, "cost_layer": [[1] * 30] * 30, "second_coordinates": None}
    dense = client.post("/coverage", json=changed(places=None, spacing=0.5, **ground))
    document = problem(dense, 413, "too-many-cities")
    assert (document["limit"], document["actual"]) == (50, 900)
    assert document["errors"][0]["pointer"] == "/spacing"


def test_without_an_actor_of_matrices_there_is_no_coverage() -> None:
    with serving(app_of(Shuffler())) as url:
        problem(httpx.post(f"{url}/coverage", json=TASK), 422, "no-actor")


def test_before_the_ways_over_a_map_are_compiled_there_is_no_coverage(tmp_path: Path) -> None:
    warm = tmp_path / "warm"
    app = app_of(workers=workers_of(runner_of(warm=warm)), edge=Edge(request_seconds=1))
    with serving(app, warm=False) as url:
        with httpx.Client(base_url=url, timeout=300) as client:
            answer = first_found(client, changed(time_limit=0), "/coverage")
        problem(answer, 503, "warming-up")
        warm.touch()


def png(grid: Any) -> bytes:
    """A picture of a grid: black where it is 1, white where it is 0."""
    stream = io.BytesIO()
    Image.fromarray((255 * (1 - np.array(grid))).astype(np.uint8)).save(stream, "PNG")
    return stream.getvalue()


def test_a_map_may_come_as_a_png(client: httpx.Client) -> None:
    request = changed(grid=None, time_limit=0)
    files = {"request": (None, json.dumps(request)), "map": ("map.png", png(GRID), "image/png")}
    found = client.post("/coverage", files=files)
    assert found.status_code == 200, found.text
    expected = client.post("/coverage", json=changed(time_limit=0)).json()
    assert found.json()["front"] == expected["front"]


def ended(client: httpx.Client, front: str) -> dict[str, Any]:
    """The front once nothing about it will change."""
    while (body := client.get(front).json())["status"] in ("queued", "running"):
        time.sleep(0.02)
    return body


def test_a_front_of_places_may_be_found_later(client: httpx.Client) -> None:
    accepted = client.post("/coverage", json=changed(paths=True), headers=LATER)
    assert accepted.status_code == 202
    assert accepted.headers["preference-applied"] == "respond-async"
    body = ended(client, accepted.headers["location"])
    assert (body["status"], body["places"]) == ("done", PLACES)
    assert all(item["path"]["cells"] for item in body["front"])


def test_a_front_that_cannot_be_found_later_says_why(client: httpx.Client) -> None:
    task = changed(grid=WALLED, places=[[0, 0], [0, 3]], second_coordinates=POINTS[:2])
    accepted = client.post("/coverage", json=task, headers=LATER)
    body = ended(client, accepted.headers["location"])
    assert (body["status"], body["front"]) == ("failed", [])
    assert (body["problem"]["status"], body["problem"]["code"]) == (422, "invalid-request")
    assert body["problem"]["errors"][0]["pointer"] == "/places/1"


@pytest.fixture(scope="module")
def patient() -> Iterator[httpx.Client]:
    """A client of a service that allows what takes long."""
    limits = replace(LIMITS, body_bytes=2**24, cities=1000, cells=2**20, seconds=600.0)
    limits = replace(limits, survey_seconds=1.0)
    with serving(app_of(limits=limits)) as url, httpx.Client(base_url=url, timeout=300) as client:
        yield client


def test_a_survey_that_takes_long_can_be_cancelled(patient: httpx.Client) -> None:
    places = np.random.default_rng(0).integers(1000, size=(1000, 2)).tolist()
    task = {"cell_size": 1, "places": places, "second_coordinates": places}
    longest = {**task, "time_limit": 600}
    files = {"request": (None, json.dumps(longest)), "map": png(np.zeros((1000, 1000)))}
    front = patient.post("/coverage", files=files, headers=LATER).headers["location"]
    while patient.get(front).json()["status"] == "queued":
        time.sleep(0.02)
    body = patient.delete(front).json()
    assert (body["status"], body["front"]) == ("cancelled", [])


@pytest.mark.parametrize("robots", [{}, {"robots": [{"id": "one"}, {"id": "two", "start": 1}]}])
def test_a_survey_that_would_take_too_long_is_refused_early(
    patient: httpx.Client, robots: dict[str, Any]
) -> None:
    places = np.random.default_rng(0).integers(1000, size=(500, 2)).tolist()
    task = {"cell_size": 1, "places": places, "time_limit": 0, **robots}
    costs = {} if robots else {"second_coordinates": places}
    files = {"request": (None, json.dumps(task | costs)), "map": png(np.zeros((1000, 1000)))}
    began = time.monotonic()
    document = problem(patient.post("/coverage", files=files), 422, "survey-too-long")
    assert time.monotonic() - began < 30
    assert document["limit"] == 1.0
    assert "500 places over 1000000 free cells" in document["detail"]


def test_a_search_that_is_cancelled_keeps_what_it_has_found(patient: httpx.Client) -> None:
    places = np.random.default_rng(1).integers(40, size=(150, 2)).tolist()
    task = {"grid": [[0] * 40] * 40, "cell_size": 1, "places": places, "paths": True}
    task |= {"time_limit": 600, "second_coordinates": places[::-1]}
    front = patient.post("/coverage", json=task, headers=LATER).headers["location"]
    while not patient.get(front).json()["front"]:
        time.sleep(0.02)
    body = patient.delete(front).json()
    assert (body["status"], body["places"]) == ("cancelled", places)
    assert sorted(body["front"][0]["tour"]) == list(range(150))
