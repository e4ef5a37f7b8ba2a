"""Fronts of three and four objectives over HTTP: planned, chosen from, replanned, refused."""

from dataclasses import replace
from io import BytesIO
from typing import Any

import httpx
import moocore
import numpy as np
import pytest
from paretour import Client

from service.instance import Instance, tour_lengths
from tests.helpers.serving import LIMITS, app_of, problem, serving

N = 12
several = pytest.mark.parametrize("objectives", [3, 4])


def cities(objectives: int) -> list[list[float]]:
    """Cities in a plane for each objective."""
    return np.random.default_rng(objectives).random((N, 2 * objectives)).tolist()


def matrices(objectives: int) -> np.ndarray:
    """Costs of each objective, which differ by direction."""
    return np.random.default_rng(objectives).random((objectives, N, N))


def lengths_of(answer: dict[str, Any]) -> np.ndarray:
    return np.array([tour["lengths"] for tour in answer["front"]])


def check_front(answer: dict[str, Any], objectives: int, costs: np.ndarray) -> None:
    """Check an answer against the costs, moocore, and the definitions of its members."""
    lengths = lengths_of(answer)
    assert lengths.shape[1] == objectives == len(answer["scale"])
    for tour in answer["front"]:
        order = np.array(tour["tour"])
        total = costs[:, order, np.roll(order, -1)].sum(axis=1)
        np.testing.assert_allclose(tour["lengths"], total, rtol=1e-12)
        assert {"angle", "balance"}.isdisjoint(tour)
    losses = np.array([tour["losses"] for tour in answer["front"]])
    assert losses.min() == 0
    assert losses.max() == 1
    reference_point = np.array(answer["reference_point"])
    share = moocore.hypervolume(lengths, ref=reference_point) / reference_point.prod()
    assert answer["hypervolume"] == pytest.approx(share)
    assert moocore.is_nondominated(lengths).all()
    assert answer["front"] == sorted(answer["front"], key=lambda tour: tour["lengths"])


@several
def test_coordinates(client: httpx.Client, objectives: int) -> None:
    rows = cities(objectives)
    answer = client.post("/front", json={"coordinates": rows, "bound": True}).json()
    planes = np.array(rows).reshape(N, objectives, 2).transpose(1, 0, 2)
    check_front(answer, objectives, np.linalg.norm(planes[:, :, None] - planes[:, None], axis=3))
    assert answer["hypervolume"] <= answer["hypervolume_bound"] <= 1
    assert client.get(f"/front/{answer['id']}").json() == answer


@several
def test_matrices_as_json_and_as_a_file(client: httpx.Client, objectives: int) -> None:
    costs = matrices(objectives)
    answer = client.post("/front", json={"matrices": costs.tolist(), "time_limit": 0}).json()
    check_front(answer, objectives, costs)
    content = BytesIO()
    np.save(content, costs)
    parts = {"request": b'{"time_limit": 0}', "matrices": content.getvalue()}
    again = client.post("/front", files=parts).json()
    assert again["front"] == answer["front"]


def test_stops_with_names_and_each_source(client: httpx.Client) -> None:
    rng = np.random.default_rng(0)
    stops = [
        {"id": f"#{k}", "location": [24.9 + x / 50, 60.1 + y / 50]}
        for k, (x, y) in enumerate(rng.random((N, 2)).tolist())
    ]
    objectives = [
        {"name": "way", "from": "great_circle"},
        {"name": "risk", "matrix": rng.random((N, N)).tolist()},
        {"name": "climb", "unit": "m", "coordinates": rng.random((N, 2)).tolist()},
    ]
    request = {"stops": stops, "objectives": objectives, "closed": False, "arrivals": True}
    answer = client.post("/front", json=request).json()
    names = [(each["name"], each["unit"]) for each in answer["objectives"]]
    assert names == [("way", "m"), ("risk", None), ("climb", "m")]
    for tour in answer["front"]:
        assert tour["stops"][0] == "#0"
        np.testing.assert_allclose(tour["arrivals"][-1], tour["lengths"])
    lengths = lengths_of(answer)
    most = float(np.median(lengths[:, 0]))
    query = {"front": answer["id"], "at_most": f"way:{most}", "prefer": "climb"}
    tour = client.get("/tour", params=query).json()
    assert tour["lengths"][2] == lengths[lengths[:, 0] <= most, 2].min()
    drawn = client.get(f"/front/{answer['id']}", headers={"Accept": "application/geo+json"}).json()
    first = drawn["features"][0]["properties"]
    assert (first["lengths"], first["losses"]) == (
        answer["front"][0]["lengths"],
        answer["front"][0]["losses"],
    )
    kept = client.post(f"/front/{answer['id']}/replan", json={"done": ["#0"], "remove": ["#3"]})
    rest = kept.json()
    assert kept.status_code == 200
    assert lengths_of(rest).shape[1] == len(objectives)
    assert all("#3" not in tour["stops"] and "kept" in tour for tour in rest["front"])


def test_directions_are_preferences(client: httpx.Client) -> None:
    request = {"coordinates": cities(3), "time_limit": 0, "size": 30}
    asked = client.post("/front", json={**request, "preferences": [[1, 1, 1], [0, 1, 2]]})
    assert asked.status_code == 200
    for preferences, sentence in {
        "[[1, 1]]": "preferences/0 must have 3 numbers, one for each objective",
        "[[0, 0, 0]]": "that are not all 0",
        "[45]": "preferences/0 must be a list of 3 numbers, one for each objective",
    }.items():
        members = {**request, "preferences": httpx.Response(200, text=preferences).json()}
        refused = problem(client.post("/front", json=members), 422, "invalid-request")
        assert sentence in refused["detail"]


@pytest.mark.parametrize(
    ("members", "pointer"),
    [
        ({"coordinates": [[0, 0, 1, 1, 2, 2], [0, 0, 1, 1]]}, "/coordinates/1"),
        ({"coordinates": [[0, 0, 1, 1, 2]]}, "/coordinates/0"),
        ({"coordinates": [[0] * 10]}, "/coordinates/0"),
        ({"matrices": [[[0]]] * 5}, "/matrices"),
        ({"coordinates": [[0] * 6], "reference_point": [1, 1]}, "/reference_point"),
        ({"coordinates": [[0] * 4], "reference_point": [1, 1, 1]}, "/reference_point"),
    ],
)
def test_what_does_not_fit_is_refused(
    client: httpx.Client, members: dict[str, Any], pointer: str
) -> None:
    refused = problem(client.post("/front", json=members), 422, "invalid-request")
    assert [each["pointer"] for each in refused["errors"]] == [pointer]


def test_fleets_take_four(client: httpx.Client) -> None:
    stops = [{"id": "a"}, {"id": "b"}]
    objectives = [{"name": str(k), "matrix": [[0, 1], [1, 0]], "over": "sum"} for k in range(5)]
    fleet = {"stops": stops, "objectives": objectives[:4], "vehicles": [{"id": "van"}]}
    assert client.post("/fleet", json=fleet).json()["front"][0]["lengths"] == [1, 1, 1, 1]
    fleet["objectives"] = objectives
    refused = problem(client.post("/fleet", json=fleet), 422, "invalid-request")
    assert refused["errors"][0]["pointer"] == "/objectives"


def test_a_job_and_the_client(client: httpx.Client) -> None:
    with Client(str(client.base_url)) as caller:
        front = caller.front(matrices=matrices(3), time_limit=0.1)
        assert front.lengths.shape[1] == 3
        assert np.isnan(front.angles).all()
        assert front.losses.max() == 1
        tour = front.choose(weights={0: 1, 2: 0.5})
        asked = caller.tour(weights={0: 1, 2: 0.5}, front=front.id)
        np.testing.assert_array_equal(asked.tour, tour.tour)
        least = float(front.lengths[:, 1].min())
        tight = front.choose(at_most={1: least}, prefer=0)
        assert tight.lengths[1] == least
        job = caller.submit(coordinates=cities(4), time_limit=0.1)
        assert job.result().lengths.shape[1] == 4


@pytest.mark.parametrize("ends", [{}, {"closed": False, "start": 3}])
def test_thousands_of_stops_are_planned(ends: dict[str, Any]) -> None:
    places = np.random.default_rng(0).random((2_500, 6)).round(4)
    limits = replace(LIMITS, cities=2_500, body_bytes=2_000_000, network_cities=N, seconds=2)
    with serving(app_of(limits=limits)) as address:
        request = {"coordinates": places.tolist(), "time_limit": 1.5, **ends}
        answer = httpx.post(f"{address}/front", json=request, timeout=300).json()
    assert answer["terminated"] == "time_limit"
    instance = Instance(coordinates=places, **ends)
    tours = np.array([each["tour"] for each in answer["front"]])
    assert (np.sort(tours, axis=1) == np.arange(2_500)).all()
    reported = [each["lengths"] for each in answer["front"]]
    np.testing.assert_allclose(reported, tour_lengths(instance, tours), rtol=1e-9)
