"""Fronts and tours as GeoJSON, by the rules of RFC 7946, and as text, against a live server."""

from io import StringIO
from typing import Any

import httpx
import moocore
import numpy as np
import pytest
from paretour.kinds import parse_any

from tests.helpers.serving import problem

ACCEPT = {"Accept": "application/geo+json"}
LOCATIONS = [[24.94, 60.17], [24.95, 60.18], [24.97, 60.16], [24.93, 60.15], [24.96, 60.19]]
STOPS = [{"id": f"s{k}", "location": location} for k, location in enumerate(LOCATIONS)]
RISK = np.random.default_rng(3).random((5, 5)).tolist()
OBJECTIVES = [
    {"name": "way", "from": "great_circle"},
    {"name": "risk", "unit": "%", "matrix": RISK},
]
REQUEST: dict[str, Any] = {"stops": STOPS, "objectives": OBJECTIVES, "time_limit": 0.1}


def check(collection: dict[str, Any], tours: list[dict[str, Any]]) -> None:
    """Check that a FeatureCollection holds these tours of a front, then its stops."""
    assert collection["type"] == "FeatureCollection"
    lines, points = collection["features"][: len(tours)], collection["features"][len(tours) :]
    for feature, tour in zip(lines, tours, strict=True):
        cities = [*tour["tour"], tour["tour"][0]]
        assert feature["type"] == "Feature"
        assert feature["geometry"] == {
            "type": "LineString",
            "coordinates": [LOCATIONS[city] for city in cities],
        }
        expected = {name: tour[name] for name in ("angle", "balance", "lengths", "stops")}
        named = {"front": collection["id"], "names": ["way", "risk"], "units": ["m", "%"]}
        assert feature["properties"] == {**named, **expected}
    assert [point["id"] for point in points] == [stop["id"] for stop in STOPS]
    assert [point["geometry"] for point in points] == [
        {"type": "Point", "coordinates": location} for location in LOCATIONS
    ]


@pytest.mark.parametrize(
    ("path", "request_"),
    [
        ("/front", REQUEST),
        ("/front", {"coordinates": [[0, 1, 2, 3], [3, 1, 0, 2], [5, 5, 1, 7]], "time_limit": 0}),
        (
            "/fleet",
            {**REQUEST, "vehicles": [{"id": "van", "count": 2, "start": 0, "end": 0}]},
        ),
    ],
)
def test_a_front_is_given_as_text_that_moocore_reads(
    client: httpx.Client, path: str, request_: dict[str, Any]
) -> None:
    client.post(path, json=request_).raise_for_status()
    stored = client.get("/front").json()["fronts"][0]["id"]
    front = client.get(f"/front/{stored}").json()
    text = client.get(f"/front/{stored}", headers={"Accept": "text/plain"})
    assert text.headers["content-type"] == "text/plain; charset=utf-8"
    assert text.text == parse_any(front).to_moocore()
    points = moocore.read_datasets(StringIO(text.text))[:, :-1]
    assert points.tolist() == [each["lengths"] for each in front["front"]]
    again = client.post(path, json=request_, headers={"Accept": "text/plain"})
    assert again.headers["content-type"] == text.headers["content-type"]
    assert moocore.read_datasets(StringIO(again.text)).shape[1] == 3


def test_a_library_that_accepts_text_as_well_gets_json(client: httpx.Client) -> None:
    headers = {"Accept": "application/json, text/plain, */*"}
    assert client.post("/front", json=REQUEST, headers=headers).json()["front"]
    refused = client.get("/front/x", headers={"Accept": "text/plain"})
    problem(refused, 404, "unknown-front")


def test_a_front_and_its_tours_are_given_as_geojson(client: httpx.Client) -> None:
    answer = client.post("/front", json=REQUEST, headers=ACCEPT)
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/geo+json")
    assert answer.headers["vary"] == "Accept"
    path = f"/front/{answer.json()['id']}"
    front = client.get(path).json()
    check(answer.json(), front["front"])
    assert client.get(path, headers=ACCEPT).json() == answer.json()
    tour = client.get("/tour?balance=1", headers=ACCEPT)
    assert tour.headers["content-type"] == "application/geo+json"
    check(tour.json(), front["front"][-1:])


def test_arrivals_are_properties_too(client: httpx.Client) -> None:
    answer = client.post("/front", json=REQUEST | {"arrivals": True}, headers=ACCEPT).json()
    first = answer["features"][0]
    assert len(first["properties"]["arrivals"]) == len(first["geometry"]["coordinates"]) == 6


@pytest.mark.parametrize(
    ("accept", "given"),
    [
        ("application/geo+json, */*", "application/geo+json"),
        ("application/json;q=0.5, Application/GEO+JSON;q=0.9", "application/geo+json"),
        ("application/json, application/geo+json;q=0.9", "application/json"),
        ("application/geo+json;q=0", "application/json"),
        ("application/geo+json;q=much", "application/json"),
        ("*/*", "application/json"),
        (";;,q=,", "application/json"),
    ],
)
def test_what_is_accepted_most_is_given(client: httpx.Client, accept: str, given: str) -> None:
    client.post("/front", json=REQUEST)
    answer = client.get("/tour?knee", headers={"Accept": accept})
    assert (answer.status_code, answer.headers["content-type"]) == (200, given)


@pytest.mark.parametrize(
    ("body", "came"),
    [
        ({"coordinates": [[0, 0, 0, 0], [1, 2, 3, 4]]}, "a front of cities without stops"),
        (
            {
                "stops": [{"id": "a"}, {"id": "b", "location": [1, 2]}, {"id": "c"}],
                "objectives": [
                    {"name": name, "coordinates": [[0, 0], [1, 1], [2, 5]]} for name in "xy"
                ],
            },
            "none of stop 'a' and 1 more",
        ),
    ],
)
def test_stops_without_a_location_are_refused(
    client: httpx.Client, body: dict[str, Any], came: str
) -> None:
    planned = client.post("/front", json=body).json()["id"]
    for answer in (
        client.post("/front", json=body, headers=ACCEPT),
        client.get(f"/front/{planned}", headers=ACCEPT),
        client.get(f"/tour?knee&front={planned}", headers=ACCEPT),
    ):
        assert came in problem(answer, 406, "no-locations")["detail"]


def test_one_stop_is_a_line_back_to_itself(client: httpx.Client) -> None:
    objectives = [{"name": name, "from": "great_circle"} for name in ("way", "again")]
    request = {"stops": STOPS[:1], "objectives": objectives}
    [line, point] = client.post("/front", json=request, headers=ACCEPT).json()["features"]
    assert line["geometry"]["coordinates"] == [LOCATIONS[0]] * 2
    assert point["geometry"]["coordinates"] == LOCATIONS[0]
