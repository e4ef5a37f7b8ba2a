"""The application as a whole: who may call from where, and the actors that it has."""

import httpx

from service.api.app import Edge
from tests.helpers.serving import app_of, serving

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


def test_no_page_of_another_origin_may_call_unless_it_is_allowed() -> None:
    with serving(app_of(), warm=False) as url:
        answer = httpx.get(f"{url}/actors", headers={"Origin": FLEET})
    assert answer.status_code == 200
    assert "access-control-allow-origin" not in answer.headers
