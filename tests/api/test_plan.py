"""POST /front against a live server: fronts, and what the engine says where there is none."""

import json
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path

import httpx
import numpy as np
import pytest

from service.actor import OnnxActor
from service.api.app import Edge
from service.instance import Instance, step_lengths, tour_lengths
from service.jobs.task_runner import load_runner
from service.server import Ending, build
from service.settings import Settings
from tests.helpers.actors import Shuffler
from tests.helpers.artifacts import by_row_sums
from tests.helpers.jobs import first_found
from tests.helpers.serving import (
    LIMITS,
    app_of,
    events_of,
    problem,
    runner_of,
    serving,
    workers_of,
)

CITIES = np.random.default_rng(5).random((12, 4)).tolist()
MANY_CITIES = np.random.default_rng(0).random((300, 4)).tolist()
COSTS = np.random.default_rng(6).random((2, 12, 12))
PATIENT = replace(LIMITS, seconds=600.0, cities=300)


@pytest.mark.parametrize(
    ("member", "given", "actor"),
    [
        ("coordinates", np.array(CITIES), "pa-one"),
        ("matrices", COSTS, "pa-one-matrix"),
        ("matrices", COSTS + COSTS.transpose(0, 2, 1), "pa-one-matrix"),
    ],
    ids=["coordinates", "matrices", "symmetric matrices"],
)
def test_cities_become_a_front(
    client: httpx.Client, member: str, given: np.ndarray, actor: str
) -> None:
    answer = client.post("/front", json={member: given.tolist(), "preferences": 20, "start": 3})
    assert answer.status_code == 200, answer.text
    body = answer.json()
    tours = np.array([item["tour"] for item in body["front"]])
    np.testing.assert_array_equal(np.sort(tours, axis=1), [range(12)] * len(tours))
    assert (tours[:, 0] == 3).all()
    instance = Instance(**{member: given})
    lengths = np.array([item["lengths"] for item in body["front"]])
    np.testing.assert_allclose(lengths, tour_lengths(instance, tours))
    assert (np.diff(lengths[:, 0]) > 0).all()
    assert (np.diff(lengths[:, 1]) < 0).all()
    assert body["cities"] == 12
    assert body["points"] >= len(tours)
    assert 0 < body["hypervolume"] < 1
    np.testing.assert_allclose(body["scale"], instance.scale)
    np.testing.assert_allclose(body["reference_point"], 12 * instance.scale)
    assert body["actor"] == {"name": actor, "digest": "0" * 64}
    phases = {"queue", "construction", "improvement", "selection", "bound", "total"}
    assert set(body["timings_ms"]) == phases
    assert body["terminated"] in ("converged", "time_limit")


@pytest.mark.parametrize("member", ["coordinates", "matrices"])
def test_arrivals_are_both_lengths_up_to_each_stop(client: httpx.Client, member: str) -> None:
    given = np.array(CITIES) if member == "coordinates" else COSTS
    request = {member: given.tolist(), "arrivals": True, "size": 5}
    front = client.post("/front", json=request).json()
    instance = Instance(**{member: given})
    for item in front["front"]:
        arrivals = np.array(item["arrivals"])
        way = np.array([*item["tour"], item["tour"][0]])
        assert arrivals.shape == (13, 2)
        np.testing.assert_array_equal(arrivals[0], 0)
        steps = step_lengths(instance, way[:-1], way[1:])
        np.testing.assert_allclose(np.diff(arrivals, axis=0), steps)
        np.testing.assert_allclose(arrivals[-1], item["lengths"])
    tour = client.get("/tour", params={"balance": 0, "front": front["id"]}).json()
    assert tour["arrivals"] == front["front"][0]["arrivals"]


def test_size_and_angles_and_reference_point_are_heeded(client: httpx.Client) -> None:
    request = {
        "coordinates": CITIES,
        "preferences": [0, 12.5, 90],
        "size": 1,
        "reference_point": [30, 40],
        "seed": 7,
        "actor": "pa-one",
        "time_limit": 0,
    }
    body = client.post("/front", json=request).json()
    assert len(body["front"]) == 1
    assert body["reference_point"] == [30, 40]


@pytest.mark.parametrize("n", [1, 2])
def test_one_or_two_cities_are_a_front_of_one_tour(client: httpx.Client, n: int) -> None:
    for cities in ({"coordinates": CITIES[:n]}, {"matrices": COSTS[:, :n, :n].tolist()}):
        answer = client.post("/front", json=cities)
        assert [item["tour"] for item in answer.json()["front"]] == [list(range(n))]


def test_coincident_cities_are_fine(client: httpx.Client) -> None:
    answer = client.post("/front", json={"coordinates": [[1, 2, 3, 4]] * 5})
    assert answer.json()["front"][0]["lengths"] == [0, 0]


@pytest.mark.parametrize("magnitude", [1e-300, 1e150])
def test_any_unit_will_do(client: httpx.Client, magnitude: float) -> None:
    cities = (magnitude * (np.array(CITIES) - 0.5)).tolist()
    answer = client.post("/front", json={"coordinates": cities})
    assert 0 < answer.json()["hypervolume"] < 1


def test_a_wrong_request_is_a_problem_document(client: httpx.Client) -> None:
    wrong = {"coordinates": CITIES, "size": 0, "starts": 1}
    document = problem(client.post("/front", json=wrong), 422, "invalid-request")
    assert [fault["pointer"] for fault in document["errors"]] == ["/size", "/starts"]
    assert document["detail"].endswith("(and 1 more)")
    many = {"coordinates": [[0, 0, 0, 0]] * (LIMITS.cities + 1)}
    document = problem(client.post("/front", json=many), 413, "too-many-cities")
    assert (document["limit"], document["actual"]) == (LIMITS.cities, LIMITS.cities + 1)


def test_the_front_dominates_or_equals_the_initial_tours(client: httpx.Client) -> None:
    points = client.post("/front", json={"coordinates": CITIES, "time_limit": 0.1}).json()["front"]
    tours = [item["tour"] for item in points]
    for time_limit in (0, 0.01):
        request = {"coordinates": CITIES, "initial_tours": tours, "time_limit": time_limit}
        found = client.post("/front", json=request).json()["front"]
        lengths = np.array([item["lengths"] for item in found])
        for point in points:
            assert (lengths <= np.array(point["lengths"]) + 1e-9).all(axis=1).any()


def test_time_makes_the_front_better_and_no_front_passes_the_bound(client: httpx.Client) -> None:
    request = {"coordinates": CITIES, "bound": True}
    before, after = (
        client.post("/front", json={**request, "time_limit": limit}).json() for limit in (0, 0.2)
    )
    assert before["terminated"] == "converged"
    assert before["hypervolume"] < after["hypervolume"] <= after["hypervolume_bound"] + 1e-12


def test_before_the_search_is_compiled_the_network_answers_and_the_rest_waits(
    tmp_path: Path,
) -> None:
    workers = workers_of(runner_of(warm=tmp_path / "warm"))
    app = app_of(workers=workers, edge=Edge(request_seconds=5))
    with serving(app, warm=False) as address, httpx.Client(base_url=address) as client:
        request = {"coordinates": CITIES, "time_limit": 0}
        while client.post("/front", json=request, timeout=300).status_code == 504:
            pass  # until the worker has started: each waits for it
        assert client.post("/front", json=request).status_code == 200
        while "%" not in client.get("/health/ready").json()["detail"]:
            time.sleep(0.02)  # until it has said how far it is
        for refused in (
            client.get("/health/ready"),
            client.post("/front", json={**request, "time_limit": 0.1}),
            client.post("/front", json={**request, "preferences": 9, "size": 3}),
            client.post(
                "/front", json={**request, "bound": True}, headers={"Idempotency-Key": "a"}
            ),
        ):
            document = problem(refused, 503, "warming-up")
            assert document["detail"].startswith("compiling the search: 40 %, about 20 s left")
            assert refused.headers["Retry-After"] == "20"
        later = {"Prefer": "respond-async"}
        posted = client.post("/front", json={**request, "bound": True}, headers=later)
        events = events_of(client, posted.json()["id"])
        compiling = next(data for name, data in events if name == "compiling")
        assert compiling == {"share": 0.4, "seconds_left": 20}
        (tmp_path / "warm").touch()
        assert list(events)[-1] == ("status", {"id": posted.json()["id"], "status": "done"})
        assert client.get("/health/ready").json() == {"status": "ready"}
        assert client.post("/front", json={**request, "time_limit": 0.1}).status_code == 200


def test_a_client_that_goes_away_frees_its_worker() -> None:
    workers = workers_of(runner_of(limits=PATIENT), queue=0, seconds=700)
    with serving(app_of(workers=workers, limits=PATIENT)) as address:
        request = {"coordinates": MANY_CITIES, "time_limit": 600}
        with pytest.raises(httpx.ReadTimeout):
            httpx.post(f"{address}/front", json=request, timeout=1)
        request = {"coordinates": CITIES, "time_limit": 0}
        while httpx.post(f"{address}/front", json=request).status_code == 503:
            time.sleep(0.02)
        assert httpx.get(f"{address}/tour?angle=45").json()["tour"]


def test_a_request_that_takes_too_long_is_answered_with_what_was_found() -> None:
    with (
        serving(app_of(limits=PATIENT, edge=Edge(request_seconds=2))) as address,
        httpx.Client(base_url=address, timeout=300) as client,
    ):
        answer = first_found(client, {"coordinates": MANY_CITIES, "time_limit": 600})
        assert (answer.status_code, answer.json()["terminated"]) == (200, "time_limit")
        assert answer.json()["front"]


def test_a_request_that_takes_too_long_for_any_front_is_504(tmp_path: Path) -> None:
    app = app_of(Shuffler(tmp_path / "gate"), edge=Edge(request_seconds=0.5))
    with serving(app) as address:
        answer = httpx.post(f"{address}/front", json={"coordinates": CITIES}, timeout=300)
        problem(answer, 504, "overdue")


def test_a_full_queue_is_503_and_health_answers_all_the_while(tmp_path: Path) -> None:
    workers = workers_of(runner_of(Shuffler(tmp_path / "gate")), queue=1)
    with serving(app_of(workers=workers)) as url, ThreadPoolExecutor() as clients:

        def post() -> httpx.Response:
            return httpx.post(f"{url}/front", json={"coordinates": CITIES}, timeout=300)

        waiting = [clients.submit(post) for _ in range(3)]
        try:
            refused = first_done(waiting)
            problem(refused, 503, "queue-full")
            assert int(refused.headers["retry-after"]) > 0
            # A full queue is said before the body is read.
            problem(httpx.post(f"{url}/front", content="{"), 503, "queue-full")
            assert httpx.get(f"{url}/health/live").status_code == 200
            assert httpx.get(f"{url}/health/ready").status_code == 200
        finally:
            (tmp_path / "gate").touch()
        assert sorted(each.result().status_code for each in waiting) == [200, 200, 503]
        assert post().status_code == 200


def first_done(waiting: list[Future[httpx.Response]]) -> httpx.Response:
    deadline = time.monotonic() + 10
    while time.monotonic() < deadline:
        for each in waiting:
            if each.done():
                return each.result()
        time.sleep(0.01)
    raise TimeoutError("one of three requests must be refused")


def test_what_is_under_way_for_too_long_at_the_end_is_refused(tmp_path: Path) -> None:
    actor = Shuffler(tmp_path / "gate")
    with ThreadPoolExecutor() as clients:
        with serving(app_of(actor), drain=1) as url:
            body = {"coordinates": CITIES}
            asked = clients.submit(httpx.post, f"{url}/front", json=body, timeout=300)
            while not actor.started:
                time.sleep(0.01)
        problem(asked.result(), 503, "shutting-down")


def test_the_released_actors_plan_over_http() -> None:
    steps = np.random.default_rng(3).random((2, 9, 9)).tolist()
    with serving(build(Settings(workers=1), Ending()), warm=False) as url:
        released = httpx.get(f"{url}/actors").json()["actors"]
        digests = {facts["name"]: facts["digest"] for facts in released}
        for given, name in (
            ({"coordinates": CITIES}, "pa-one"),
            ({"matrices": steps}, "pa-one-matrix"),
            ({"coordinates": CITIES, "actor": "pa-at"}, "pa-at"),
        ):
            request = {**given, "preferences": 20, "time_limit": 0}
            body = httpx.post(f"{url}/front", json=request, timeout=300).json()
            assert body["actor"] == {"name": name, "digest": digests[name]}
            assert len(body["front"]) > 1


def test_a_network_of_matrices_plans_over_http(tmp_path: Path) -> None:
    actor = OnnxActor(by_row_sums(tmp_path / "sums.onnx"), threads=1)
    workers = workers_of(partial(load_runner, tmp_path, 1, LIMITS))
    with serving(app_of(actor, workers=workers)) as url:
        request = {"matrices": COSTS.tolist(), "preferences": [30], "time_limit": 0}
        answer = httpx.post(f"{url}/front", json=request).json()
    assert answer["actor"] == {"name": "sums", "digest": actor.info.digest}
    [tour] = actor.tours(Instance(matrices=COSTS), np.array([[np.cos(np.pi / 6), 0.5]]))
    assert answer["front"][0]["tour"] == np.roll(tour, -np.flatnonzero(tour == 0)).tolist()


def test_two_matrices_of_500_cities_are_within_the_default_limits() -> None:
    costs = np.random.default_rng(0).random((2, 500, 500))
    request = {"matrices": costs.tolist(), "preferences": 1, "time_limit": 0}
    body = json.dumps(request).encode()
    with serving(app_of(limits=Settings().limits)) as url:
        headers = {"Content-Type": "application/json"}
        answer = httpx.post(f"{url}/front", content=body, headers=headers, timeout=300)
    assert answer.json()["cities"] == 500
