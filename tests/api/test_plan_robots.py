"""POST /coverage with robots against a live server: plans with paths, jobs, and refusals."""

import json
import time
from typing import Any

import httpx
import pytest
from paretour import RobotFront

from service.api.schemas import documented
from tests.api.test_plan_coverage import GRID, PLACES, png
from tests.helpers.robot_plans import check_answer
from tests.helpers.serving import problem
from tests.helpers.several_plans import with_several_plans

ROBOTS = [{"id": "left", "start": 0}, {"id": "right", "start": 2}]
REQUEST = {"grid": GRID, "cell_size": 0.5, "places": PLACES, "robots": ROBOTS, "paths": True}


@pytest.fixture(scope="module")
def answer(client: httpx.Client) -> dict[str, Any]:
    def ask() -> dict[str, Any]:
        response = client.post("/coverage", json=REQUEST)
        assert response.status_code == 200, response.text
        return dict(response.json())

    return with_several_plans(ask)


def test_robots_share_the_places_of_a_map(answer: dict[str, Any]) -> None:
    check_answer(REQUEST, answer)
    assert answer["objectives"] == [
        {"name": "total distance", "unit": "m", "over": "sum"},
        {"name": "longest route", "unit": "m", "over": "max"},
    ]
    assert (answer["cities"], answer["places"]) == (5, PLACES)
    assert {"survey", "improvement", "paths", "total"} <= answer["timings_ms"].keys()
    documented(RobotFront).model_validate(answer)


def test_paths_come_only_where_they_are_asked_for(client: httpx.Client) -> None:
    front = client.post("/coverage", json={**REQUEST, "paths": False}).json()["front"]
    routes = [route for plan in front for route in plan["routes"]]
    assert all(route.keys() == {"robot", "tour", "lengths"} for route in routes)


def test_a_front_for_robots_is_stored_and_has_no_tours(
    client: httpx.Client, answer: dict[str, Any]
) -> None:
    assert client.get(f"/front/{answer['id']}").json() == answer
    query = {"knee": "", "front": answer["id"]}
    problem(client.get("/tour", params=query), 404, "no-tours")
    refused = client.post(f"/front/{answer['id']}/replan", json={"done": [0]})
    assert "several robots" in problem(refused, 409, "not-replannable")["detail"]
    headers = {"Accept": "application/geo+json"}
    problem(client.get(f"/front/{answer['id']}", headers=headers), 406, "no-locations")


def test_a_job_for_robots_on_a_picture_is_followed_to_its_end(
    client: httpx.Client, answer: dict[str, Any]
) -> None:
    request = {name: value for name, value in REQUEST.items() if name != "grid"}
    files = {"request": (None, json.dumps(request)), "map": ("map.png", png(GRID), "image/png")}
    accepted = client.post("/coverage", files=files, headers={"Prefer": "respond-async"})
    assert accepted.status_code == 202
    path = accepted.headers["Location"]
    while (front := client.get(path).json())["status"] in ("queued", "running"):
        assert front["objectives"] == answer["objectives"]
        time.sleep(0.01)
    assert (front["status"], front["places"]) == ("done", answer["places"])
    check_answer(REQUEST, front)  # another short search may find other plans


def test_robots_that_the_map_has_no_place_for_are_named(client: httpx.Client) -> None:
    robots = [{"id": "left"}, {"id": "right", "start": 7}]
    refused = client.post("/coverage", json={**REQUEST, "robots": robots})
    [fault] = problem(refused, 422, "invalid-request")["errors"]
    assert fault["pointer"] == "/robots/1/start"
