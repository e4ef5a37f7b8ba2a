"""Whatever a body says, the answer is one that the OpenAPI document promises."""

import gzip
import json
import re
import socket
import struct
import time
import zlib
from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from typing import Any

import httpx
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from service.api.app import Edge
from tests.helpers.sampled import tenth, third
from tests.helpers.serving import LIMITS, app_of, problem, serving

JSON = {"Content-Type": "application/json"}
PLAN: dict[str, Any] = {"preferences": [0, 45, 90], "time_limit": 0, "size": 3, "start": 1}
VALID: dict[str, Any] = {
    **PLAN,
    "coordinates": [[0, 0, 1, 3], [2, 5, 0, 0], [4, 1, 2, 2], [3, 3, 5, 1]],
    "reference_point": [50, 50],
    "initial_tours": [[0, 1, 2, 3]],
    "actor": "pa-one",
    "seed": 1,
}
MATRIX = [[0, 2, 3], [4, 0, 1], [5, 2, 0]]
GRID = {**PLAN, "cell_size": 0.5, "robot_radius": 0.3, "grid": [[0, 0, 1, 0]] * 4, "paths": True}
PLACES = [[0, 0], [2, 1], [3, 0]]
POSE = {"position": {"x": 1, "y": 2}, "orientation": {"z": 0, "w": 1}}
MESSAGE = {
    "info": {"resolution": 0.5, "width": 4, "height": 2, "origin": POSE},
    "data": [0, 0, 100, -1, 0, 0, 0, 0],
}
BY_MESSAGE = {name: GRID[name] for name in GRID if name not in ("grid", "cell_size", "start")}
# Requests of every kind, and where they go.
REQUESTS: list[tuple[str, dict[str, Any]]] = [
    ("/front", VALID),
    ("/front", {**PLAN, "matrices": [MATRIX, MATRIX]}),
    ("/coverage", {**GRID, "places": PLACES, "second_matrix": MATRIX}),
    ("/coverage", {**GRID, "places": PLACES, "cost_layer": [[1, 2, 3, 4]] * 4}),
    ("/coverage", {**GRID, "places": PLACES, "second_coordinates": [[0, 1], [2, 3], [4, 4]]}),
    (
        "/coverage",
        {
            **GRID,
            "places": PLACES,
            "second_matrix": MATRIX,
            "robot_speed": 0.5,
            "departure": {"earliest": 0, "latest": 9},
            "over_the_day": [[[0, 1], [2, 1.5]], []],
        },
    ),
    (
        "/coverage",
        {
            **BY_MESSAGE,
            "occupancy_grid": MESSAGE,
            "spacing": 0.5,
            "cost_layer": [[1, 0, 1, 2]] * 2,
            "start_pose": [1.1, 2.1, 0],
            "obstacle_from": 65,
            "unknown": "blocked",
        },
    ),
    ("/coverage", {**GRID, "spacing": 0.5, "start": 0, "cost_layer": [[1, 0, 1, 2]] * 4}),
]
MEMBERS = [(path, body, member) for path, body in REQUESTS for member in sorted(body)]
# JSON as it is written, because some of it no encoder would write.
HOSTILE = [
    *("null", "true", '""', '"\\ud800"', '"\\u0000"', '"1"', "[]", "[[]]", "{}", '{"": []}'),
    *("0", "-0.0", "-1", "1e308", "-1e308", "1e309", "5e-324", "1e-400", "1.5", "NaN", "Infinity"),
    *("9007199254740993", "2147483648", "1" + 400 * "0", "1" + 5000 * "0", "0." + 5000 * "1"),
    "[" * 100 + "]" * 100,
    '{"a":' * 100 + "1" + "}" * 100,
    "[" + "0," * 5000 + "0]",
    '"' + "x" * 20_000 + '"',
]

ANY_JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=5) | st.dictionaries(st.text(max_size=9), inner),
    max_leaves=20,
)
OFTEN = settings(max_examples=third(100), deadline=None, suppress_health_check=list(HealthCheck))
MORE_OFTEN = settings(OFTEN, max_examples=tenth(400))
PATHS = st.sampled_from(sorted({path for path, _ in REQUESTS}))
Statuses = dict[str, set[str]]
Broken = tuple[str, dict[str, Any], str]


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    limits = replace(LIMITS, body_bytes=12 * 2**20)
    with serving(app_of(limits=limits)) as address:
        yield address


@pytest.fixture(scope="module")
def impatient() -> Iterator[str]:
    with serving(app_of(edge=Edge(body_seconds=0.5))) as address:
        yield address


@pytest.fixture(scope="module")
def client(url: str) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=url, timeout=300) as client:
        yield client


@pytest.fixture(scope="module")
def promised(client: httpx.Client) -> dict[str, set[str]]:
    """The statuses that the answer to a POST may have, by its path."""
    document = client.get("/openapi.json").json()
    paths = {path for path, _ in REQUESTS}
    return {path: set(document["paths"][path]["post"]["responses"]) for path in paths}


def check(answer: httpx.Response, promised: dict[str, set[str]]) -> None:
    assert str(answer.status_code) in promised[answer.url.path], answer.text
    assert answer.status_code < 500, answer.text
    assert "Traceback" not in answer.text
    if answer.status_code != 200:
        problem(answer, answer.status_code, answer.json()["code"])
        assert len(answer.content) < 20_000
    else:
        assert answer.json()["front"]


@pytest.mark.parametrize(("path", "body"), REQUESTS)
def test_what_is_broken_below_is_whole(client: httpx.Client, path: str, body: Any) -> None:
    answer = client.post(path, json=body)
    assert answer.status_code == 200, answer.text


@OFTEN
@given(path=PATHS, body=ANY_JSON)
def test_any_json(client: httpx.Client, promised: Statuses, path: str, body: object) -> None:
    check(client.post(path, content=json.dumps(body), headers=JSON), promised)


@OFTEN
@given(path=PATHS, body=st.binary(max_size=200))
def test_any_bytes(client: httpx.Client, promised: Statuses, path: str, body: bytes) -> None:
    check(client.post(path, content=body, headers=JSON), promised)


@MORE_OFTEN
@given(broken=st.sampled_from(MEMBERS), hostile=st.sampled_from(HOSTILE), depth=st.integers(0, 2))
def test_a_request_with_one_thing_wrong(
    client: httpx.Client, promised: Statuses, broken: Broken, hostile: str, depth: int
) -> None:
    """A member, or the last thing inside it, or inside that, is what no client would say."""
    path, request, member = broken
    body = json.dumps({**request, member: _replaced(request[member], depth)})
    body = body.replace('"HERE"', hostile, 1)
    check(client.post(path, content=body.encode(), headers=JSON), promised)


def _replaced(value: Any, depth: int) -> Any:
    if depth and isinstance(value, dict):
        *_, last = value
        return {**value, last: _replaced(value[last], depth - 1)}
    if depth == 0 or not isinstance(value, list):
        return "HERE"
    return [*value[:-1], _replaced(value[-1], depth - 1)]


@OFTEN
@given(broken=st.sampled_from(MEMBERS), anything=ANY_JSON)
def test_any_json_in_the_place_of_a_member(
    client: httpx.Client, promised: Statuses, broken: Broken, anything: object
) -> None:
    path, request, member = broken
    body = json.dumps({**request, member: anything})
    check(client.post(path, content=body, headers=JSON), promised)


def test_a_map_with_nothing_wrong_is_planned(client: httpx.Client) -> None:
    answer = client.post("/coverage", files=with_map(map_of(6, 8)))
    assert answer.status_code == 200, answer.text


@OFTEN
@given(data=st.data())
def test_a_map_with_a_few_bytes_wrong(
    client: httpx.Client, promised: Statuses, data: st.DataObject
) -> None:
    image = bytearray(map_of(6, 8))
    for _ in range(data.draw(st.integers(1, 3))):
        image[data.draw(st.integers(0, len(image) - 1))] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(image)))
    image = image[:cut] if data.draw(st.booleans()) else image
    check(client.post("/coverage", files=with_map(bytes(image))), promised)


@pytest.mark.parametrize(("rows", "columns"), [(2**31 - 1, 2**31 - 1), (1, 2**31 - 1), (0, 0)])
def test_a_map_that_lies_about_its_size(
    client: httpx.Client, promised: Statuses, rows: int, columns: int
) -> None:
    image = bytearray(map_of(6, 8))
    image[16:24] = struct.pack(">II", columns, rows)
    image[29:33] = struct.pack(">I", zlib.crc32(image[12:29]))
    check(client.post("/coverage", files=with_map(bytes(image))), promised)


@OFTEN
@given(
    body=st.binary(max_size=100),
    boundary=st.sampled_from(["", "; boundary=", "; boundary=x", '; boundary="x', "; boundary=é"]),
)
def test_any_bytes_as_parts(
    client: httpx.Client, promised: Statuses, body: bytes, boundary: str
) -> None:
    part = b'--x\r\nContent-Disposition: form-data; name="map"\r\n\r\n'
    headers = {"Content-Type": f"multipart/form-data{boundary}".encode()}
    check(client.post("/coverage", content=part + body, headers=headers), promised)


def map_of(rows: int, columns: int) -> bytes:
    """A PNG of free cells."""
    out = BytesIO()
    Image.new("L", (columns, rows), 255).save(out, "PNG")
    return out.getvalue()


def with_map(image: bytes) -> dict[str, Any]:
    _, request = REQUESTS[-1]
    rest = {name: value for name, value in request.items() if name not in ("grid", "cost_layer")}
    rest = {**rest, "second_matrix": [[0]], "spacing": 100}
    return {"map": ("map.png", image, "image/png"), "request": (None, json.dumps(rest))}


@pytest.mark.parametrize(
    "cities",
    [
        [[1e150, -1e150, 5e-324, 1e-300]] * 3,
        [[1e150, 1e150, 1e150, 1e150], [-1e150, -1e150, -1e150, -1e150], [0, 0, 0, 0]],
        [[5e-324, 0, 0, 5e-324], [0, 5e-324, 5e-324, 0], [0, 0, 0, 0]],
        [[1e150, 5e-324, 1e-150, 0], [0, 0, 1e150, 5e-324], [3, 1e-310, 2, 1]],
    ],
)
def test_extremes_of_floating_point_are_planned(client: httpx.Client, cities: Any) -> None:
    answer = client.post("/front", json={"coordinates": cities, "time_limit": 0})
    assert answer.status_code == 200
    assert 0 <= answer.json()["hypervolume"] <= 1


@pytest.mark.parametrize("opening", ["[", '{"a":', '{"coordinates":[', "[[],"])
def test_ten_megabytes_of_brackets_are_refused(client: httpx.Client, opening: str) -> None:
    body = opening * (10 * 2**20 // len(opening))
    answer = client.post("/front", content=body, headers=JSON)
    problem(answer, 413, "body-too-complex")


def test_nothing_compressed_is_opened(client: httpx.Client) -> None:
    zeros = bytes(50 * 2**20)
    zipped = gzip.compress(zeros, 1)
    bombs = {
        "gzip": zipped,
        "deflate": zlib.compress(zeros, 1),
        "gzip, gzip": gzip.compress(zipped),
        "br": b"\x0b\x02\x80",
    }
    for coding, bomb in bombs.items():
        headers = {**JSON, "Content-Encoding": coding}
        problem(client.post("/front", content=bomb, headers=headers), 415, "not-plain")


@pytest.mark.parametrize("headers", ["Content-Length: 100", "Transfer-Encoding: chunked"])
def test_a_body_that_never_ends_is_refused(impatient: str, headers: str) -> None:
    host, port = re.findall(r"//(.*):(\d+)", impatient)[0]
    request = f"POST /front HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n{headers}\r\n"
    with socket.create_connection((host, int(port)), timeout=60) as connection:
        connection.sendall(f"{request}\r\n".encode())
        answer = b""
        while chunk := connection.recv(4096):
            answer += chunk
    head, _, body = answer.partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 408 ")
    assert b"application/problem+json" in head
    assert json.loads(body)["code"] == "body-too-slow"


def test_a_body_that_trickles_is_refused_whatever_its_pace(impatient: str) -> None:
    def trickling() -> Iterator[bytes]:
        for _ in range(50):
            time.sleep(0.05)
            yield b"["

    with httpx.Client() as client:
        answer = client.post(f"{impatient}/front", content=trickling(), headers=JSON)
    problem(answer, 408, "body-too-slow")


def test_after_all_that_it_still_answers(client: httpx.Client) -> None:
    assert client.post("/front", json=VALID).status_code == 200
