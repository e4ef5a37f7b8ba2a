"""The application as a whole: who may call from where, and the actors that it has."""

import time
from pathlib import Path

import httpx

from service.api.app import Edge
from tests.helpers.serving import app_of, problem, runner_of, serving, workers_of

FLEET = "https://fleet.example"


def test_the_actors_are_named() -> None:
    with serving(app_of(), warm=False) as url:
        actors = httpx.get(f"{url}/actors").json()["actors"]
    assert [(actor["name"], actor["inputs"], actor["sizes"]) for actor in actors] == [
        ("pa-one", "coordinates", [20, 60]),
        ("pa-one-matrix", "matrices", [20, 60]),
    ]


def test_a_page_of_another_origin_may_call_where_it_is_allowed() -> None:
    asked = {"Origin": FLEET, "Access-Control-Request-Method": "POST"}
    with serving(app_of(edge=Edge(origins=[FLEET])), warm=False) as url:
        preflight = httpx.options(f"{url}/front", headers=asked)
        answer = httpx.get(f"{url}/actors", headers=asked)
        other = httpx.get(f"{url}/actors", headers={"Origin": "https://other.example"})
    assert preflight.status_code == 200
    for allowed in (preflight, answer):
        assert allowed.headers["access-control-allow-origin"] == FLEET
    assert "access-control-allow-origin" not in other.headers


def test_a_refused_preflight_is_a_problem_that_names_what_is_not_allowed() -> None:
    asked = {"Origin": "https://other.example", "Access-Control-Request-Method": "PUT"}
    with serving(app_of(edge=Edge(origins=[FLEET])), warm=False) as url:
        refused = httpx.options(f"{url}/front", headers=asked)
    assert "origin, method" in problem(refused, 400, "preflight-refused")["detail"]
    assert "Origin" in refused.headers["vary"]


def test_health_is_asked_for_without_its_body_too(tmp_path: Path) -> None:
    warm = tmp_path / "warm"
    with serving(app_of(workers=workers_of(runner_of(warm=warm))), warm=False) as url:
        for path, status in (("live", 200), ("ready", 503)):
            answer = httpx.head(f"{url}/health/{path}")
            assert (answer.status_code, answer.content) == (status, b"")
        warm.touch()
        while httpx.head(f"{url}/health/ready").status_code == 503:
            time.sleep(0.05)
        assert httpx.head(f"{url}/health/ready").status_code == 200
        refused = httpx.put(f"{url}/health/live")
        problem(refused, 405, "method-not-allowed")
        assert refused.headers["allow"] == "GET, HEAD"


def test_no_page_of_another_origin_may_call_unless_it_is_allowed() -> None:
    with serving(app_of(), warm=False) as url:
        answer = httpx.get(f"{url}/actors", headers={"Origin": FLEET})
    assert answer.status_code == 200
    assert "access-control-allow-origin" not in answer.headers
