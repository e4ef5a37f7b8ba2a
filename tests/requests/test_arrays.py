"""Matrices of costs in POST /front, against a live server."""

import io
import json
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from service.actor import OnnxActor
from service.instance import Instance, tour_lengths
from service.jobs.runner import load_runner
from service.settings import Settings
from tests.helpers.artifacts import by_row_sums
from tests.helpers.serving import LIMITS, Shuffler, app_of, info_of, problem, serving, workers_of

JSON = {"Content-Type": "application/json"}
COSTS = np.random.default_rng(6).random((2, 12, 12))


@pytest.fixture(scope="module")
def client() -> Iterator[httpx.Client]:
    with serving(app_of()) as address, httpx.Client(base_url=address, timeout=30) as client:
        yield client


@pytest.mark.parametrize("costs", [COSTS, COSTS + COSTS.transpose(0, 2, 1)])
def test_matrices_become_a_front(client: httpx.Client, costs: np.ndarray) -> None:
    request = {"matrices": costs.tolist(), "preferences": 20, "start": 3}
    answer = client.post("/front", json=request)
    assert answer.status_code == 200, answer.text
    body = answer.json()
    tours = np.array([item["tour"] for item in body["front"]])
    np.testing.assert_array_equal(np.sort(tours, axis=1), [range(12)] * len(tours))
    assert (tours[:, 0] == 3).all()
    instance = Instance(matrices=costs)
    lengths = np.array([item["lengths"] for item in body["front"]])
    np.testing.assert_allclose(lengths, tour_lengths(instance, tours))
    np.testing.assert_allclose(body["scale"], instance.scale)
    assert body["cities"] == 12
    assert body["actor"]["name"] == "pa-one-matrix"


def test_the_diagonal_is_disregarded(client: httpx.Client) -> None:
    odd = COSTS.copy()
    odd[:, range(12), range(12)] = [[-1], [1e308]]
    body = json.dumps({"matrices": odd.tolist(), "time_limit": 0}).replace("1e+308", "NaN")
    plain = client.post("/front", json={"matrices": COSTS.tolist(), "time_limit": 0})
    found = client.post("/front", content=body, headers=JSON)
    assert found.json()["front"] == plain.json()["front"]


@pytest.mark.parametrize("n", [1, 2])
def test_one_or_two_cities_are_a_front_of_one_tour(client: httpx.Client, n: int) -> None:
    answer = client.post("/front", json={"matrices": COSTS[:, :n, :n].tolist()})
    assert [item["tour"] for item in answer.json()["front"]] == [list(range(n))]


SQUARE = "[[0, 1, 2], [1, 0, 3], [2, 3, 0]]"

# What `matrices` may not be: the member, where it is wrong, and what is said of it.
UNPROCESSABLE = [
    ("7", "", "must be a valid array, got 7"),
    ("null", "", "must be a valid array, got null"),
    (f"[{SQUARE}]", "", "must have 2 items or more, got 1"),
    (f"[{SQUARE}, {SQUARE}, {SQUARE}]", "", "must have 2 items or fewer, got 3"),
    (f"[{SQUARE}, 7]", "/1", "must be a valid array, got 7"),
    ("[[], []]", "/0", "must have a row of numbers or more, got none"),
    (f"[{SQUARE}, [[], [], []]]", "/1", "must have a row of numbers or more, got none"),
    (f"[{SQUARE}, [[0, 1], [1, 0]]]", "/1", "must have 3 rows, as many as matrices/0, got 2"),
    (f"[[[0, 1], [1, 0], [2, 3]], {SQUARE}]", "/0", "must be square, got 3 rows of 2 numbers"),
    (f"[[[0], 7, [2]], {SQUARE}]", "/0/1", "must be a valid array, got 7"),
    (
        f"[{SQUARE}, [[0, 1, 2], [1, 0], [2, 3, 0]]]",
        "/1/1",
        "must have 3 numbers, as the first, got 2",
    ),
]
UNPROCESSABLE_COSTS = [
    ("-0.5", "must not be negative, got -0.5"),
    ("NaN", "must be a finite number, got NaN"),
    ("Infinity", "must be a finite number, got Infinity"),
    ("-Infinity", "must be a finite number, got -Infinity"),
    ("1e400", "must be a finite number, got Infinity"),
    ("1e200", "must be at most 1e+150, got 1e+200"),
    ('"4"', 'must be a valid number, got "4"'),
    ("true", "must be a valid number, got true"),
    ("null", "must be a valid number, got null"),
    ("[4]", "must be a valid number, got a list of 1"),
]


@pytest.mark.parametrize(
    ("matrices", "pointer", "sentence"),
    [
        *UNPROCESSABLE,
        *(
            (f"[{SQUARE}, [[0, 1, 2], [1, 0, {cost}], [2, 3, 0]]]", "/1/1/2", sentence)
            for cost, sentence in UNPROCESSABLE_COSTS
        ),
    ],
)
def test_what_is_not_two_matrices_of_costs_is_named(
    client: httpx.Client, matrices: str, pointer: str, sentence: str
) -> None:
    answer = client.post("/front", content=f'{{"matrices": {matrices}}}', headers=JSON)
    document = problem(answer, 422, "invalid-request")
    assert document["errors"][0]["pointer"] == f"/matrices{pointer}"
    assert document["detail"] == f"matrices{pointer} {sentence}"


def test_too_many_cities_are_413(client: httpx.Client) -> None:
    n = LIMITS.cities + 1
    answer = client.post("/front", json={"matrices": [[[1] * n] * n] * 2})
    document = problem(answer, 413, "too-many-cities")
    assert (document["limit"], document["actual"]) == (LIMITS.cities, n)
    assert document["detail"] == f"matrices must have at most {LIMITS.cities} rows, got {n}"


def test_an_actor_that_reads_no_matrices_is_named(client: httpx.Client) -> None:
    answer = client.post("/front", json={"matrices": COSTS.tolist(), "actor": "pa-one"})
    document = problem(answer, 422, "unfit-actor")
    assert document["errors"][0]["pointer"] == "/actor"
    assert "one of pa-one-matrix; pa-one reads coordinates alone" in document["detail"]


def test_an_actor_of_matrices_serves_coordinates_where_it_is_asked_to(client: httpx.Client) -> None:
    request = {"coordinates": np.eye(4).tolist(), "actor": "pa-one-matrix"}
    assert client.post("/front", json=request).json()["actor"]["name"] == "pa-one-matrix"


def test_matrices_have_no_symmetries(client: httpx.Client) -> None:
    answer = client.post("/front", json={"matrices": COSTS.tolist(), "augment": 8})
    document = problem(answer, 422, "invalid-request")
    assert document["errors"][0]["pointer"] == "/augment"
    assert "must be 1 for matrices" in document["detail"]


def test_where_no_actor_reads_matrices_they_are_refused() -> None:
    with serving(app_of(Shuffler())) as url:
        request = {"matrices": COSTS.tolist()}
        document = problem(httpx.post(f"{url}/front", json=request), 422, "no-actor")
        assert document["detail"] == "matrices need an actor that reads them, and none is loaded"
        answer = httpx.post(f"{url}/front", json={**request, "actor": "pa-one"})
        assert "there is none" in problem(answer, 422, "unfit-actor")["detail"]


def test_where_the_default_is_not_loaded_another_that_reads_matrices_serves() -> None:
    with serving(app_of(Shuffler(info=info_of("own", "matrices")))) as url:
        for instance in ({"matrices": COSTS.tolist()}, {"coordinates": np.eye(4).tolist()}):
            answer = httpx.post(f"{url}/front", json={**instance, "time_limit": 0})
            assert answer.json()["actor"]["name"] == "own"


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
    with serving(app_of(limits=Settings().limits)) as url:
        request = {"matrices": costs.tolist(), "preferences": 1, "time_limit": 0}
        answer = httpx.post(f"{url}/front", json=request, timeout=60)
    assert answer.json()["cities"] == 500


def npy(matrices: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, matrices)
    return stream.getvalue()


def post_parts(client: httpx.Client, content: bytes, /, **request: Any) -> httpx.Response:
    parts = {"request": (None, json.dumps(request)), "matrices": ("costs.npy", content)}
    return client.post("/front", files=parts)


@pytest.mark.parametrize(
    "uploaded",
    [
        COSTS,
        np.asfortranarray(COSTS),
        COSTS.astype(">f8"),
        (100 * COSTS).astype(np.int32),
        COSTS.astype(np.float32),
    ],
)
def test_matrices_may_come_as_a_file(client: httpx.Client, uploaded: np.ndarray) -> None:
    request = {"time_limit": 0, "preferences": 5, "start": 2}
    found = post_parts(client, npy(uploaded), **request)
    assert found.status_code == 200, found.text
    as_rows = uploaded.astype(np.float64).tolist()
    expected = client.post("/front", json={"matrices": as_rows, **request})
    assert found.json()["front"] == expected.json()["front"]


def _declared(header: bytes) -> bytes:
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header


HUGE = b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 1000000, 1000000)}"
NOT_PICKLED = np.array([[[None]], [[None]]], dtype=object)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"", "matrices must be a .npy file of version 1 or 2"),
        (b"PK\x03\x04 a zip", "matrices must be a .npy file of version 1 or 2"),
        (_declared(b"{'descr': __import__('os')}"), "must be a .npy file of version 1 or 2"),
        (npy(NOT_PICKLED), "must be of real numbers of at most 8 bytes, got object"),
        (npy(COSTS * 1j), "must be of real numbers of at most 8 bytes, got complex128"),
        (npy(COSTS[0]), "must have shape (2, n, n) with n at least 1, got (12, 12)"),
        (npy(COSTS[:, :3]), "must have shape (2, n, n) with n at least 1, got (2, 3, 12)"),
        (npy(COSTS[:, :0, :0]), "must have shape (2, n, n) with n at least 1, got (2, 0, 0)"),
        (npy(COSTS)[:-8], "must have 2304 bytes after its header, got 2296"),
        (npy(COSTS - 0.9), "must not be negative, got -"),
        (npy(np.where(COSTS > 0.5, np.nan, COSTS)), "must be a finite number, got NaN"),
    ],
)
def test_a_file_that_is_not_two_matrices_is_named(
    client: httpx.Client, content: bytes, sentence: str
) -> None:
    document = problem(post_parts(client, content), 422, "invalid-request")
    assert document["errors"][0]["pointer"].startswith("/matrices")
    assert sentence in document["detail"]


def test_a_file_that_declares_too_many_cities_is_refused_by_its_header(
    client: httpx.Client,
) -> None:
    document = problem(post_parts(client, _declared(HUGE)), 413, "too-many-cities")
    assert (document["limit"], document["actual"]) == (LIMITS.cities, 1_000_000)


@pytest.mark.parametrize(
    ("request_", "sentence"),
    [
        ({"matrices": COSTS.tolist()}, "matrices must come once"),
        ({"coordinates": [[0, 0, 0, 0]]}, "either coordinates or matrices are required, got both"),
    ],
)
def test_cities_may_not_come_beside_the_file(
    client: httpx.Client, request_: dict[str, Any], sentence: str
) -> None:
    answer = post_parts(client, npy(COSTS), **request_)
    assert sentence in problem(answer, 422, "invalid-request")["detail"]


MULTIPART = "multipart/form-data; boundary=x"
PART = 'Content-Disposition: form-data; name="{}"'


def multipart(*names: str, end: str = "--x--\r\n") -> str:
    return "".join(f"--x\r\n{PART.format(name)}\r\n\r\n{{}}\r\n" for name in names) + end


@pytest.mark.parametrize(
    ("kind", "body", "status", "sentence"),
    [
        (MULTIPART, multipart("request"), 422, "the part matrices is required"),
        (MULTIPART, multipart("matrices"), 422, "the part request is required"),
        (MULTIPART, multipart("request", "map"), 422, "must be request and matrices, once each"),
        (MULTIPART, multipart("request", "request"), 422, "once each, got 'request'"),
        (MULTIPART, multipart("request", "matrices", end=""), 400, "before its last boundary"),
        (MULTIPART, "{}", 400, "the body must be multipart/form-data"),
        ("multipart/form-data", multipart("request"), 400, "the body must be multipart/form-data"),
    ],
)
def test_parts_that_are_not_as_they_should_be_are_named(
    client: httpx.Client, kind: str, body: str, status: int, sentence: str
) -> None:
    answer = client.post("/front", content=body, headers={"Content-Type": kind})
    code = "malformed-multipart" if status == 400 else "invalid-parts"
    assert sentence in problem(answer, status, code)["detail"]
