"""The HTTP contract, against a live server."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from service.instance import Instance, tour_lengths
from service.jobs.front_document import encode_front
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from service.planner import Front
from service.server import build
from service.settings import Settings
from tests.helpers.serving import (
    LIMITS,
    Broken,
    Shuffler,
    app_of,
    problem,
    runner_of,
    serving,
    workers_of,
)

CITIES = np.random.default_rng(5).random((12, 4)).tolist()
ROOT = Path(__file__).parents[2]
JSON = {"Content-Type": "application/json"}


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    with serving(app_of()) as address:
        yield address


@pytest.fixture(scope="module")
def client(url: str) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=url, timeout=30) as client:
        yield client


def test_cities_become_a_front(client: httpx.Client) -> None:
    answer = client.post("/front", json={"coordinates": CITIES, "preferences": 20, "start": 3})
    assert answer.status_code == 200
    body = answer.json()
    tours = np.array([item["tour"] for item in body["front"]])
    np.testing.assert_array_equal(np.sort(tours, axis=1), [range(12)] * len(tours))
    assert (tours[:, 0] == 3).all()
    instance = Instance(coordinates=np.array(CITIES))
    lengths = np.array([item["lengths"] for item in body["front"]])
    np.testing.assert_allclose(lengths, tour_lengths(instance, tours))
    assert (np.diff(lengths[:, 0]) > 0).all()
    assert (np.diff(lengths[:, 1]) < 0).all()
    assert body["cities"] == 12
    assert body["points"] >= len(tours)
    assert 0 < body["hypervolume"] < 1
    np.testing.assert_allclose(body["scale"], instance.scale)
    np.testing.assert_allclose(body["reference_point"], 12 * instance.scale)
    assert body["actor"] == {"name": "pa-one", "digest": "0" * 64}
    assert {"queue", "construction", "improvement", "selection", "bound", "total"} == set(
        body["timings_ms"]
    )
    assert body["terminated"] in ("converged", "time_limit")


def test_a_front_can_be_asked_for_again(client: httpx.Client) -> None:
    answer = client.post("/front", json={"coordinates": CITIES}).json()
    again = client.get(f"/front/{answer['id']}")
    assert (again.status_code, again.json()) == (200, answer)


def test_the_tour_at_an_angle_is_the_nearest_of_the_front(client: httpx.Client) -> None:
    front = client.post("/front", json={"coordinates": CITIES}).json()
    other = client.post("/front", json={"coordinates": CITIES[:4]}).json()
    nearest = min(front["front"], key=lambda item: abs(item["angle"] - 30))
    asked = client.get("/tour", params={"angle": 30, "front": front["id"]})
    assert asked.json() == {"front": front["id"], **nearest}
    for angle in (0, 90):
        end = client.get("/tour", params={"angle": angle, "front": front["id"]}).json()
        assert end == {"front": front["id"], **front["front"][-1 if angle == 0 else 0]}
    latest = client.get("/tour", params={"angle": 30})
    assert latest.json()["front"] == other["id"]


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
    answer = client.post("/front", json={"coordinates": CITIES[:n]})
    assert answer.status_code == 200
    assert [item["tour"] for item in answer.json()["front"]] == [list(range(n))]


def test_a_whole_number_may_be_written_with_a_point(client: httpx.Client) -> None:
    body = json.dumps({"coordinates": CITIES, "preferences": 3.0, "start": 2.0})
    assert client.post("/front", content=body, headers=JSON).status_code == 200


def test_coincident_cities_are_fine(client: httpx.Client) -> None:
    answer = client.post("/front", json={"coordinates": [[1, 2, 3, 4]] * 5})
    assert answer.json()["front"][0]["lengths"] == [0, 0]


@pytest.mark.parametrize("magnitude", [1e-300, 1e150])
def test_any_unit_will_do(client: httpx.Client, magnitude: float) -> None:
    cities = (magnitude * (np.array(CITIES) - 0.5)).tolist()
    answer = client.post("/front", json={"coordinates": cities})
    assert 0 < answer.json()["hypervolume"] < 1


# Bodies that are JSON and no front request: the body, where it is wrong, and what is said of it.
UNPROCESSABLE = [
    ("[]", "", "the body must be an object, got a list of 0"),
    ("null", "", "the body must be an object, got null"),
    ("{}", "/coordinates", "either coordinates or matrices are required, got neither"),
    (
        '{"coordinates": [[1, 2, 3, 4]], "matrices": [[[0]], [[0]]]}',
        "/coordinates",
        "either coordinates or matrices are required, got both",
    ),
    ('{"coordinates": []}', "/coordinates", "coordinates must have 1 items or more, got 0"),
    (
        '{"coordinates": [[1, 2, 3, 4], [1, 2, 3]]}',
        "/coordinates/1",
        "coordinates/1 must have 4 items or more, got 3",
    ),
    (
        '{"coordinates": [[1, 2, 3, 4, 5]]}',
        "/coordinates/0",
        "coordinates/0 must have 4 items or fewer, got 5",
    ),
    ('{"coordinates": [7]}', "/coordinates/0", "coordinates/0 must be a valid array, got 7"),
    ('{"coordinates": "x"}', "/coordinates", 'coordinates must be a valid array, got "x"'),
]
CITY = '{"coordinates": [[1, 2, 3, 4]], '
UNPROCESSABLE_NUMBERS = [
    ("NaN", "must be a finite number, got NaN"),
    ("Infinity", "must be a finite number, got Infinity"),
    ("-Infinity", "must be a finite number, got -Infinity"),
    ("1e400", "must be a finite number, got Infinity"),
    ("1" + 400 * "0", "must be a finite number, got an integer of more than 40 digits"),
    ("1e200", "must be at most 1e+150, got 1e+200"),
    ('"4"', 'must be a valid number, got "4"'),
    ("true", "must be a valid number, got true"),
    ("null", "must be a valid number, got null"),
    ("[4]", "must be a valid number, got a list of 1"),
    ("{}", "must be a valid number, got an object"),
]
UNPROCESSABLE_MEMBERS = [
    ('"preferences": 0', "/preferences", "preferences must be at least 1, got 0"),
    ('"preferences": []', "/preferences", "preferences must have 1 items or more, got 0"),
    ('"preferences": [0, -1]', "/preferences/1", "preferences/1 must be at least 0, got -1"),
    ('"preferences": [90.5]', "/preferences/0", "preferences/0 must be at most 90, got 90.5"),
    ('"preferences": [NaN]', "/preferences/0", "preferences/0 must be a finite number, got NaN"),
    ('"preferences": true', "/preferences", "preferences must be a valid integer, got true"),
    ('"preferences": "9"', "/preferences", 'preferences must be a valid integer, got "9"'),
    ('"preferences": 1.5', "/preferences", "preferences must be a valid integer, got 1.5"),
    ('"time_limit": -1', "/time_limit", "time_limit must be at least 0, got -1"),
    ('"time_limit": NaN', "/time_limit", "time_limit must be a finite number, got NaN"),
    ('"size": 0', "/size", "size must be at least 1, got 0"),
    ('"size": 1e10', "/size", "size must be at most 2147483647, got 10000000000"),
    ('"start": 1', "/start", "start must be a city, 0 to 0, got 1"),
    ('"start": -1', "/start", "start must be at least 0, got -1"),
    ('"reference_point": [1]', "/reference_point", "must have 2 items or more, got 1"),
    ('"reference_point": [0, 1]', "/reference_point/0", "must be at least 1e-150, got 0"),
    ('"reference_point": null', "/reference_point", "must be a valid array, got null"),
    ('"actor": 1', "/actor", "actor must be a valid string, got 1"),
    ('"augment": 0', "/augment", "augment must be at least 1, got 0"),
    ('"augment": 9', "/augment", "augment must be at most 8, got 9"),
    ('"seed": -1', "/seed", "seed must be at least 0, got -1"),
    ('"cities": 1', "/cities", "cities is not a field that this request has"),
    ('"a/b~c": 1', "/a~1b~0c", "is not a field that this request has"),
]


@pytest.mark.parametrize(
    ("body", "pointer", "sentence"),
    [
        *UNPROCESSABLE,
        *(
            (f'{{"coordinates": [[1, 2, {number}, 4]]}}', "/coordinates/0/2", sentence)
            for number, sentence in UNPROCESSABLE_NUMBERS
        ),
        *((f"{CITY}{member}}}", *rest) for member, *rest in UNPROCESSABLE_MEMBERS),
    ],
)
def test_what_is_json_and_no_front_request_is_named(
    client: httpx.Client, body: str, pointer: str, sentence: str
) -> None:
    document = problem(client.post("/front", content=body, headers=JSON), 422, "invalid-request")
    assert document["errors"][0]["pointer"] == pointer
    assert sentence in document["errors"][0]["detail"]
    assert document["detail"] == document["errors"][0]["detail"]


def test_a_request_that_is_wrong_in_two_places_is_told_of_both(client: httpx.Client) -> None:
    wrong = {"coordinates": CITIES, "size": 0, "starts": 1}
    document = problem(client.post("/front", json=wrong), 422, "invalid-request")
    assert [fault["pointer"] for fault in document["errors"]] == ["/size", "/starts"]
    assert document["detail"].endswith("(and 1 more)")


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        (b"", "EOF"),
        (b"{", "EOF"),
        (b'{"coordinates": [[1, 2, 3, 4]]', "EOF"),
        (b'{"coordinates": [[01, 2, 3, 4]]}', "invalid number"),
        (b"{'coordinates': 1}", "key must be a string"),
        (b'{"actor": "\xff"}', "invalid unicode"),
        (b'{"actor": "\\ud800"}', "hex escape"),
        (b"[" * 50_000, "recursion limit exceeded"),
        (b'{"size": 1' + b"0" * 5000 + b"}", "number out of range"),
    ],
)
def test_what_is_not_json_is_400(client: httpx.Client, body: bytes, sentence: str) -> None:
    answer = client.post("/front", content=body, headers=JSON)
    assert sentence in problem(answer, 400, "malformed-json")["detail"]


@pytest.mark.parametrize("kind", [None, "text/plain", "application/x-www-form-urlencoded", ""])
def test_a_body_of_another_type_is_415(client: httpx.Client, kind: str | None) -> None:
    headers = {} if kind is None else {"Content-Type": kind}
    answer = client.post("/front", content=json.dumps({"coordinates": CITIES}), headers=headers)
    assert "must be application/json" in problem(answer, 415, "not-json")["detail"]


def test_a_compressed_body_is_415(client: httpx.Client) -> None:
    answer = client.post("/front", content=b"{}", headers={**JSON, "Content-Encoding": "gzip"})
    assert "got gzip" in problem(answer, 415, "not-plain")["detail"]


def test_the_type_may_name_its_charset(client: httpx.Client) -> None:
    headers = {"Content-Type": "Application/JSON; charset=utf-8"}
    body = json.dumps({"coordinates": CITIES})
    assert client.post("/front", content=body, headers=headers).status_code == 200


def test_a_body_that_says_it_is_too_long_is_413(client: httpx.Client) -> None:
    body = b" " * (LIMITS.body_bytes + 1)
    document = problem(client.post("/front", content=body, headers=JSON), 413, "body-too-long")
    assert (document["limit"], document["actual"]) == (LIMITS.body_bytes, LIMITS.body_bytes + 1)


def test_a_body_that_turns_out_too_long_is_413(client: httpx.Client) -> None:
    chunks = (b" " * 1000 for _ in range(LIMITS.body_bytes // 1000 + 1))
    document = problem(client.post("/front", content=chunks, headers=JSON), 413, "body-too-long")
    assert document["limit"] == LIMITS.body_bytes


def test_too_many_cities_are_413(client: httpx.Client) -> None:
    answer = client.post("/front", json={"coordinates": [[0, 0, 0, 0]] * (LIMITS.cities + 1)})
    document = problem(answer, 413, "too-many-cities")
    assert (document["limit"], document["actual"]) == (LIMITS.cities, LIMITS.cities + 1)
    assert document["detail"] == "coordinates must have at most 50 rows, got 51"


@pytest.mark.parametrize(
    ("member", "value", "limit"),
    [
        ("preferences", LIMITS.preferences + 1, LIMITS.preferences),
        ("preferences", [45] * (LIMITS.preferences + 1), LIMITS.preferences),
        ("size", LIMITS.size + 1, LIMITS.size),
        ("time_limit", LIMITS.seconds + 1, LIMITS.seconds),
        ("initial_tours", [list(range(len(CITIES)))] * (LIMITS.size + 1), LIMITS.size),
    ],
)
def test_more_than_a_limit_names_the_limit(
    client: httpx.Client, member: str, value: Any, limit: int
) -> None:
    answer = client.post("/front", json={"coordinates": CITIES, member: value})
    document = problem(answer, 422, "over-limit")
    assert (document["limit"], document["actual"]) == (limit, limit + 1)
    assert document["errors"][0]["pointer"] == f"/{member}"


@pytest.mark.parametrize(
    "tour", [[0], [*range(1, len(CITIES)), 1], [*range(1, len(CITIES)), len(CITIES)]]
)
def test_an_initial_tour_that_is_no_tour_is_named(client: httpx.Client, tour: list[int]) -> None:
    tours = [list(range(len(CITIES))), tour]
    answer = client.post("/front", json={"coordinates": CITIES, "initial_tours": tours})
    document = problem(answer, 422, "invalid-request")
    assert document["errors"][0]["pointer"] == "/initial_tours/1"
    assert "must visit each city" in document["detail"]


def test_the_front_dominates_or_equals_the_initial_tours(client: httpx.Client) -> None:
    points = client.post("/front", json={"coordinates": CITIES, "time_limit": 0.1}).json()["front"]
    tours = [item["tour"] for item in points]
    for time_limit in (0, 0.01):
        request = {"coordinates": CITIES, "initial_tours": tours, "time_limit": time_limit}
        found = client.post("/front", json=request).json()["front"]
        for point in points:
            assert any(
                item["lengths"][0] <= point["lengths"][0] + 1e-9
                and item["lengths"][1] <= point["lengths"][1] + 1e-9
                for item in found
            )


def test_time_makes_the_front_better_and_no_front_passes_the_bound(client: httpx.Client) -> None:
    request = {"coordinates": CITIES, "bound": True}
    before, after = (
        client.post("/front", json={**request, "time_limit": limit}).json() for limit in (0, 0.2)
    )
    assert before["terminated"] == "converged"
    assert before["hypervolume"] < after["hypervolume"] <= after["hypervolume_bound"] + 1e-12


def test_before_the_search_is_compiled_only_the_network_answers(tmp_path: Path) -> None:
    workers = workers_of(runner_of(warm=tmp_path / "warm"))
    app = app_of(workers=workers)
    with serving(app, warm=False) as address, httpx.Client(base_url=address) as client:
        request = {"coordinates": CITIES, "time_limit": 0}
        assert client.post("/front", json=request, timeout=30).status_code == 200
        for refused in (
            client.get("/health/ready"),
            client.post("/front", json={**request, "time_limit": 0.1}),
            client.post("/front", json={**request, "preferences": 9, "size": 3}),
        ):
            problem(refused, 503, "warming-up")
            assert int(refused.headers["Retry-After"]) > 0
        (tmp_path / "warm").touch()
        while client.get("/health/ready").status_code == 503:
            pass
        answer = client.post("/front", json={**request, "time_limit": 0.1}, timeout=30)
        assert answer.status_code == 200


def test_a_client_that_goes_away_frees_its_worker() -> None:
    limits = replace(LIMITS, seconds=600.0, cities=300)
    workers = workers_of(runner_of(limits=limits), queue=0, seconds=700)
    with serving(app_of(workers=workers, limits=limits)) as address:
        cities = np.random.default_rng(0).random((300, 4)).tolist()
        with pytest.raises(httpx.ReadTimeout):
            httpx.post(
                f"{address}/front", json={"coordinates": cities, "time_limit": 600}, timeout=1
            )
        request = {"coordinates": CITIES, "time_limit": 0}
        while httpx.post(f"{address}/front", json=request).status_code == 503:
            pass
        assert httpx.get(f"{address}/tour?angle=45").json()["tour"]


def test_a_request_that_takes_too_long_is_answered_with_what_was_found() -> None:
    limits = replace(LIMITS, seconds=600.0, cities=300)
    workers = workers_of(runner_of(limits=limits), seconds=1)
    with serving(app_of(workers=workers, limits=limits)) as address:
        cities = np.random.default_rng(0).random((300, 4)).tolist()
        request = {"coordinates": cities, "time_limit": 600}
        answer = httpx.post(f"{address}/front", json=request, timeout=60)
        assert (answer.status_code, answer.json()["terminated"]) == (200, "time_limit")
        assert answer.json()["front"]


def test_a_request_that_takes_too_long_for_any_front_is_504(tmp_path: Path) -> None:
    actor = Shuffler(tmp_path / "gate")
    workers = workers_of(runner_of(actor), seconds=0.5)
    with serving(app_of(workers=workers)) as address:
        answer = httpx.post(f"{address}/front", json={"coordinates": CITIES}, timeout=60)
        problem(answer, 504, "overdue")


def test_an_actor_that_is_not_loaded_is_named(client: httpx.Client) -> None:
    answer = client.post("/front", json={"coordinates": CITIES, "actor": "pa-two"})
    document = problem(answer, 422, "unknown-actor")
    assert document["detail"] == "actor must be one of pa-one, pa-one-matrix, got 'pa-two'"


@pytest.mark.parametrize(
    ("query", "parameter", "sentence"),
    [
        ("", "angle", "angle is required"),
        ("angle=-1", "angle", 'angle must be at least 0, got "-1"'),
        ("angle=90.1", "angle", 'angle must be at most 90, got "90.1"'),
        ("angle=nan", "angle", 'angle must be a finite number, got "nan"'),
        ("angle=steep", "angle", "angle must be a valid number, unable to parse"),
        ("angle=1&fronts=2", "fronts", "fronts is not a field that this request has"),
    ],
)
def test_a_wrong_query_is_named(
    client: httpx.Client, query: str, parameter: str, sentence: str
) -> None:
    document = problem(client.get(f"/tour?{query}"), 422, "invalid-request")
    assert document["errors"][0]["parameter"] == parameter
    assert document["detail"].startswith(sentence)


@pytest.mark.parametrize("path", ["/front/nowhere", "/tour?angle=30&front=nowhere"])
def test_an_unknown_front_is_404(client: httpx.Client, path: str) -> None:
    assert "'nowhere'" in problem(client.get(path), 404, "unknown-front")["detail"]


def test_a_tour_before_any_front_is_404() -> None:
    with serving(app_of()) as url:
        problem(httpx.get(f"{url}/tour?angle=30"), 404, "no-front")


def test_a_front_that_has_made_way_is_410() -> None:
    with serving(app_of(store=SqliteStore(IN_MEMORY, entries=1, max_age=60))) as url:
        first, _ = (httpx.post(f"{url}/front", json={"coordinates": CITIES}) for _ in range(2))
        key = first.json()["id"]
        problem(httpx.get(f"{url}/front/{key}"), 410, "front-expired")
        problem(httpx.get(f"{url}/tour?angle=3&front={key}"), 410, "front-expired")


def test_a_front_that_is_too_old_is_410() -> None:
    with serving(app_of(store=SqliteStore(IN_MEMORY, entries=1, max_age=1e-9))) as url:
        httpx.post(f"{url}/front", json={"coordinates": CITIES})
        problem(httpx.get(f"{url}/tour?angle=3"), 410, "front-expired")


def test_a_path_that_is_not_there_is_404(client: httpx.Client) -> None:
    assert "/fronts" in problem(client.get("/fronts"), 404, "no-such-path")["detail"]


def test_a_method_that_a_path_has_not_is_405(client: httpx.Client) -> None:
    answer = client.put("/front")
    assert "with POST, got PUT" in problem(answer, 405, "method-not-allowed")["detail"]
    assert answer.headers["allow"] == "POST"


def test_a_bug_is_500_and_tells_the_caller_nothing_but_its_request(
    caplog: pytest.LogCaptureFixture,
) -> None:
    with serving(app_of(Broken())) as url:
        answer = httpx.post(f"{url}/front", json={"coordinates": CITIES})
        document = problem(answer, 500, "internal-error")
        assert "no tour" not in answer.text
        assert document["request_id"] in caplog.text
        assert "no tour of 12 cities" in caplog.text


@pytest.mark.parametrize(("given", "kept"), [("job-17.a_B", True), ("x" * 65, False), ("é", False)])
def test_the_callers_own_request_id_is_kept_where_it_is_plain(
    client: httpx.Client, given: str, kept: bool
) -> None:
    answer = client.get("/health/live", headers={"X-Request-ID": given.encode()})
    assert (answer.headers["x-request-id"] == given) is kept


def test_a_full_queue_is_503_and_health_answers_all_the_while(tmp_path: Path) -> None:
    actor = Shuffler(tmp_path / "gate")
    workers = workers_of(runner_of(actor), queue=1)
    with serving(app_of(workers=workers)) as url, ThreadPoolExecutor() as clients:

        def post() -> httpx.Response:
            return httpx.post(f"{url}/front", json={"coordinates": CITIES}, timeout=30)

        waiting = [clients.submit(post) for _ in range(3)]
        try:
            refused = next(each for each in _finished(waiting))
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


def _finished(waiting: list[Any]) -> Iterator[httpx.Response]:
    deadline = time.monotonic() + 10
    while time.monotonic() < deadline:
        yield from (each.result() for each in waiting if each.done())
        time.sleep(0.01)


def test_what_is_under_way_for_too_long_at_the_end_is_refused(tmp_path: Path) -> None:
    actor = Shuffler(tmp_path / "gate")
    with ThreadPoolExecutor() as clients:
        with serving(app_of(actor), drain=1) as url:
            body = {"coordinates": CITIES}
            asked = clients.submit(httpx.post, f"{url}/front", json=body, timeout=30)
            while not actor.started:
                time.sleep(0.01)
        problem(asked.result(), 503, "shutting-down")


def test_the_actors_are_named(client: httpx.Client) -> None:
    actors = client.get("/actors").json()["actors"]
    assert [(actor["name"], actor["inputs"], actor["sizes"]) for actor in actors] == [
        ("pa-one", "coordinates", [20, 60]),
        ("pa-one-matrix", "matrices", [20, 60]),
    ]


def test_the_documentation_is_served(client: httpx.Client) -> None:
    assert client.get("/docs").headers["content-type"].startswith("text/html")
    limits = client.get("/openapi.json").json()["paths"]["/front"]["post"]["requestBody"]
    schema = limits["content"]["application/json"]["schema"]
    assert schema["properties"]["coordinates"]["maxItems"] == LIMITS.cities


def test_a_hundred_tours_of_a_thousand_cities_serialise_in_50_ms() -> None:
    rng = np.random.default_rng(0)
    front = Front(
        tours=np.array([rng.permutation(1000) for _ in range(100)]),
        points=np.sort(rng.random((100, 2)), axis=0) * [1, -1] + [0, 2],
        found=100,
        scale=np.ones(2),
        reference_point=np.array([1000.0, 1000.0]),
        terminated="converged",
        timings={"construction": 1.0},
    )
    best = min(_seconds(front) for _ in range(5))
    assert best < 0.05


def _seconds(front: Front) -> float:
    began = time.perf_counter()
    encode_front(front, {}).json(id="id")
    return time.perf_counter() - began


def test_the_released_actors_plan_over_http() -> None:
    steps = np.random.default_rng(3).random((2, 9, 9)).tolist()
    with serving(build(Settings(workers=1)), warm=False) as url:
        released = httpx.get(f"{url}/actors").json()["actors"]
        digests = {facts["name"]: facts["digest"] for facts in released}
        for given, name in (
            ({"coordinates": CITIES}, "pa-one"),
            ({"matrices": steps}, "pa-one-matrix"),
            ({"coordinates": CITIES, "actor": "pa-at"}, "pa-at"),
        ):
            request = {**given, "preferences": 20, "time_limit": 0}
            body = httpx.post(f"{url}/front", json=request, timeout=30).json()
            assert body["actor"] == {"name": name, "digest": digests[name]}
            assert len(body["front"]) > 1


def test_schemathesis_finds_nothing(url: str, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "schemathesis.cli", "run", f"{url}/openapi.json"]
    options = ["--no-color", "--generation-deterministic", "--max-examples=20"]
    hooks = {"SCHEMATHESIS_HOOKS": "tests.helpers.schemathesis_hooks", "PYTHONPATH": str(ROOT)}
    found = subprocess.run(
        [*command, *options],
        cwd=tmp_path,
        env={**os.environ, **hooks},
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 0, found.stdout
    assert "10 selected / 10 total" in found.stdout
