"""POST /front with stops and objectives, against a live server: ids and names come back."""

import io
import json
import logging
import time
import uuid
from typing import Any

import httpx
import numpy as np
import pytest

from service.instance import Instance, tour_lengths
from service.roads.great_circle import great_circle_matrix
from tests.helpers.serving import problem
from tests.helpers.straight_lines import matrix_of

IDS = ["depot", *(f"order-{i}" for i in range(1, 9))]
LOCATIONS = np.random.default_rng(1).uniform((24.9, 60.15), (25.0, 60.2), (9, 2))
COSTS = np.random.default_rng(2).random((9, 9))
STOPS = [
    {"id": name, "location": location}
    for name, location in zip(IDS, LOCATIONS.tolist(), strict=True)
]
OBJECTIVES = [
    {"name": "way", "from": "great_circle"},
    {"name": "risk", "unit": "%", "matrix": COSTS.tolist()},
]
REQUEST: dict[str, Any] = {"stops": STOPS, "objectives": OBJECTIVES, "start": "order-3"}
NAMES = [{"name": "way", "unit": "m"}, {"name": "risk", "unit": "%"}]


def check(front: dict[str, Any]) -> None:
    """Check the names in an answer, and its lengths by the costs of the request."""
    assert (front["objectives"], front["stops"]) == (NAMES, STOPS)
    assert front["front"]
    tours = np.array([item["tour"] for item in front["front"]])
    assert [item["stops"] for item in front["front"]] == [[IDS[i] for i in tour] for tour in tours]
    assert {item["stops"][0] for item in front["front"]} == {"order-3"}
    instance = Instance(matrices=np.stack((great_circle_matrix(LOCATIONS), COSTS)))
    lengths = [item["lengths"] for item in front["front"]]
    np.testing.assert_allclose(lengths, tour_lengths(instance, tours))
    np.testing.assert_allclose(front["scale"], instance.scale)


def ended(client: httpx.Client, path: str) -> dict[str, Any]:
    """The front at a path, once its job has ended."""
    while (front := client.get(path).json())["status"] in ("queued", "running"):
        time.sleep(0.02)
    return front


def test_ids_names_and_units_come_back(client: httpx.Client) -> None:
    answer = client.post("/front", json=REQUEST)
    assert answer.status_code == 200, answer.text
    check(answer.json())
    assert answer.json()["timings_ms"]["costs"] > 0
    check(client.get(f"/front/{answer.json()['id']}").json())


def test_times_at_a_speed_come_back_in_seconds(client: httpx.Client) -> None:
    timed = {"name": "time", "from": "great_circle", "speed": 18}
    front = client.post("/front", json={**REQUEST, "objectives": [timed, OBJECTIVES[1]]}).json()
    assert front["objectives"] == [{"name": "time", "unit": "s"}, NAMES[1]]
    seconds = np.array(matrix_of(LOCATIONS.tolist(), 18))
    for item in front["front"]:
        tour = item["tour"]
        assert item["lengths"][0] == pytest.approx(seconds[tour, np.roll(tour, -1)].sum())
    path, headers = f"/front/{front['id']}", {"Accept": "application/geo+json"}
    line = client.get(path, headers=headers).json()["features"][0]["properties"]
    assert (line["lengths"], line["units"]) == (front["front"][0]["lengths"], ["s", "%"])


def test_a_tour_has_the_ids_of_its_stops(client: httpx.Client) -> None:
    front = client.post("/front", json=REQUEST).json()
    tour = client.get("/tour", params={"angle": 45, "front": front["id"]}).json()
    assert tour["stops"] == [IDS[city] for city in tour["tour"]]


def test_short_forms_have_no_stops_and_no_objectives(client: httpx.Client) -> None:
    answer = client.post("/front", json={"coordinates": [[0, 1, 2, 3], [1, 1, 0, 2]]}).json()
    assert not {"stops", "objectives"} & answer.keys()
    assert not {"stops"} & answer["front"][0].keys()


def test_a_job_has_its_names_from_the_start_and_its_costs_at_the_end(client: httpx.Client) -> None:
    accepted = client.post("/front", json=REQUEST, headers={"Prefer": "respond-async"})
    assert accepted.status_code == 202
    path = accepted.headers["location"]
    first = client.get(path).json()
    assert (first["objectives"], first["stops"]) == (NAMES, STOPS)
    with client.stream("GET", f"{path}/events") as events:
        text = "".join(events.iter_text())
    assert '"status":"done"' in text
    check(ended(client, path))


def test_a_repeat_is_answered_with_the_first_front(client: httpx.Client) -> None:
    key = {"Idempotency-Key": uuid.uuid4().hex}
    first = client.post("/front", json=REQUEST, headers=key).json()
    check(first)
    assert client.post("/front", json=REQUEST, headers=key).json() == first
    other = client.post("/front", json={**REQUEST, "start": "depot"}, headers=key)
    problem(other, 422, "idempotency-mismatch")


BARE = [{"name": "time", "unit": "s"}, {"name": "risk"}]


def posted_with_file(client: httpx.Client, *matrices: np.ndarray) -> httpx.Response:
    """The answer to stops under two objectives, whose matrices come in a file."""
    file = io.BytesIO()
    np.save(file, np.stack(matrices))
    request = json.dumps({"stops": STOPS, "objectives": BARE})
    parts = {"request": (None, request), "matrices": ("costs.npy", file.getvalue())}
    return client.post("/front", files=parts)


def test_matrices_come_as_a_file_beside_stops(client: httpx.Client) -> None:
    answer = posted_with_file(client, COSTS, COSTS.T)
    assert answer.status_code == 200, answer.text
    assert answer.json()["objectives"] == [BARE[0], {"name": "risk", "unit": None}]


@pytest.mark.parametrize("count", [1, 3])
def test_a_file_must_have_a_matrix_for_each_objective(client: httpx.Client, count: int) -> None:
    refused = problem(posted_with_file(client, *[COSTS] * count), 422, "invalid-request")
    assert refused["errors"][0]["pointer"] == "/matrices"


def test_costs_that_only_the_worker_finds_wrong_are_refused(client: httpx.Client) -> None:
    costs = COSTS.copy()
    costs[0, 1], costs[1, 0] = 5e-324, 1e150
    risk = {"name": "risk", "matrix": costs.tolist()}
    answer = client.post("/front", json={**REQUEST, "objectives": [OBJECTIVES[0], risk]})
    [fault] = problem(answer, 422, "invalid-instance")["errors"]
    assert fault["code"] == "costs-too-far-apart"
    assert fault["values"] == {"least": 5e-324, "greatest": 1e150}


def test_initial_tours_of_long_ids_are_parsed_too(client: httpx.Client) -> None:
    stops = [{"id": f"{'x' * 90}{i}", "location": [i / 10, i / 20]} for i in range(50)]
    way = [OBJECTIVES[0], {"name": "east", "coordinates": [[i, 0] for i in range(50)]}]
    tours = [[stop["id"] for stop in stops]] * 10
    answer = client.post("/front", json={"stops": stops, "objectives": way, "initial_tours": tours})
    assert answer.status_code == 200, answer.text


def test_nothing_of_the_stops_is_logged(
    client: httpx.Client, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.DEBUG):
        client.post("/front", json=REQUEST)
        client.post("/front", json={**REQUEST, "start": "order-99"})
    logged = "\n".join(f"{record.getMessage()} {vars(record)}" for record in caplog.records)
    assert "/front" in logged
    assert "order-" not in logged
    assert not [place for place in LOCATIONS.ravel() if str(place)[:10] in logged]


def test_an_open_route_leads_from_one_id_to_another(client: httpx.Client) -> None:
    request = {**REQUEST, "closed": False, "end": "depot", "bound": True}
    front = client.post("/front", json=request).json()
    assert front["closed"] is False
    assert {(item["stops"][0], item["stops"][-1]) for item in front["front"]} == {
        ("order-3", "depot")
    }
    matrices = np.stack((great_circle_matrix(LOCATIONS), COSTS))
    instance = Instance(matrices=matrices, closed=False, start=3, end=0)
    tours = np.array([item["tour"] for item in front["front"]])
    lengths = [item["lengths"] for item in front["front"]]
    np.testing.assert_allclose(lengths, tour_lengths(instance, tours))
    assert front["hypervolume"] <= front["hypervolume_bound"] * (1 + 1e-9)


def test_an_open_route_may_start_and_end_anywhere(client: httpx.Client) -> None:
    free = client.post("/front", json={**REQUEST, "closed": False, "start": None}).json()
    fixed = client.post("/front", json={**REQUEST, "closed": False}).json()
    closed = client.post("/front", json=REQUEST).json()
    assert "closed" not in closed
    assert closed["hypervolume"] < fixed["hypervolume"] < free["hypervolume"]
    assert len({item["stops"][0] for item in free["front"]}) > 1


@pytest.mark.parametrize(
    ("members", "detail"),
    [
        ({"end": "depot"}, "end is for open routes, with closed false, got 0"),
        ({"closed": False, "end": "order-3"}, "end must not be the start"),
        ({"closed": False, "end": "order-33"}, "end must be the id of a stop"),
        ({"closed": False, "end": 9}, "end must be a city, 0 to 8, got 9"),
        ({"closed": "no"}, "closed must be a valid boolean"),
        ({"closed": 1}, "closed must be a valid boolean"),
    ],
)
def test_ends_that_no_route_can_have_are_named(
    client: httpx.Client, members: dict[str, Any], detail: str
) -> None:
    refused = problem(client.post("/front", json={**REQUEST, **members}), 422, "invalid-request")
    assert refused["detail"].startswith(detail)
