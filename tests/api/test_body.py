"""Bodies over real HTTP: types, lengths and parts; long ones parsed in a process of their own."""

import io
import json
import os
import signal
import time
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from tests.helpers.processes import ServeProcess, serve_process
from tests.helpers.serving import LIMITS, problem

JSON = {"Content-Type": "application/json"}
CITIES = np.random.default_rng(5).random((12, 4)).tolist()

# Reading it takes some tenths of a second.
WRONG = b'{"matrices":[[[' + 4_000_000 * b"0," + b"0]],[[0]]]}"


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


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-32"])
def test_a_byte_order_mark_is_taken_as_in_files(client: httpx.Client, encoding: str) -> None:
    body = json.dumps({"coordinates": CITIES, "time_limit": 0}).encode(encoding)
    assert client.post("/front", content=body, headers=JSON).status_code == 200
    stops = [{"id": "a", "location": [24.9, 60.1]}, {"id": "b", "location": [24.8, 60.2]}]
    parts = {"file": ("a.json", json.dumps(stops).encode(encoding))}
    chosen = {"columns": (None, "[]".encode(encoding))}
    assert client.post("/files", files={**parts, **chosen}).status_code == 200
    matrices = io.BytesIO()
    np.save(matrices, np.ones((2, 3, 3)))
    request = {"request": (None, '{"time_limit": 0}'.encode(encoding))}
    upload = {"matrices": ("m.npy", matrices.getvalue())}
    assert client.post("/front", files={**request, **upload}).status_code == 200


def test_a_body_that_is_not_what_its_mark_says_is_malformed(client: httpx.Client) -> None:
    answer = client.post("/front", content=b"\xff\xfe[\x00\x00", headers=JSON)
    problem(answer, 400, "malformed-json")


def test_a_body_that_says_it_is_too_long_is_413(client: httpx.Client) -> None:
    body = b" " * (LIMITS.body_bytes + 1)
    document = problem(client.post("/front", content=body, headers=JSON), 413, "body-too-long")
    assert (document["limit"], document["actual"]) == (LIMITS.body_bytes, LIMITS.body_bytes + 1)


def test_a_body_that_turns_out_too_long_is_413(client: httpx.Client) -> None:
    chunks = (b" " * 1000 for _ in range(LIMITS.body_bytes // 1000 + 1))
    document = problem(client.post("/front", content=chunks, headers=JSON), 413, "body-too-long")
    assert document["limit"] == LIMITS.body_bytes


def test_a_body_that_is_not_json_is_400(client: httpx.Client) -> None:
    answer = client.post("/front", content=b"{", headers=JSON)
    assert "EOF" in problem(answer, 400, "malformed-json")["detail"]


def test_matrices_may_come_as_a_part_of_their_own(client: httpx.Client) -> None:
    costs = np.random.default_rng(6).random((2, 12, 12))
    stream = io.BytesIO()
    np.save(stream, costs)
    request = {"time_limit": 0, "preferences": 5, "start": 2}
    parts = {"request": (None, json.dumps(request)), "matrices": ("costs.npy", stream.getvalue())}
    found = client.post("/front", files=parts)
    assert found.status_code == 200, found.text
    expected = client.post("/front", json={"matrices": costs.tolist(), **request})
    assert found.json()["front"] == expected.json()["front"]


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
        ("multipart/form-data", multipart("request"), 400, "a boundary of 1 to 70 bytes, got 0"),
        (f"{MULTIPART[:-1]}{71 * 'x'}", multipart("request"), 400, "of 1 to 70 bytes, got 71"),
        (MULTIPART, "preamble\r\n" + multipart("request"), 400, "must begin with its boundary"),
        (MULTIPART, "--x \r\n", 400, "a line break must follow each boundary"),
        (MULTIPART, f"--x\r\n{5000 * ' '}", 400, "headers of at most 4096 bytes"),
        (MULTIPART, "--x\r\n" + 5000 * "a: b\r\n", 400, "headers of at most 4096 bytes"),
        (MULTIPART, "--x\r\nno: name\r\n\r\n\r\n--x--", 422, "once each, got ''"),
    ],
)
def test_parts_that_are_not_as_they_should_be_are_named(
    client: httpx.Client, kind: str, body: str, status: int, sentence: str
) -> None:
    answer = client.post("/front", content=body, headers={"Content-Type": kind})
    code = "malformed-multipart" if status == 400 else "invalid-parts"
    assert sentence in problem(answer, status, code)["detail"]


@pytest.fixture(scope="module")
def service(quick_actors: dict[str, str]) -> Iterator[ServeProcess]:
    with serve_process({"PARETOUR_WORKERS": "1", **quick_actors}) as service:
        yield service


def post(url: str, body: bytes) -> httpx.Response:
    return httpx.post(f"{url}/front", content=body, headers=JSON, timeout=300)


def matrices(n: int) -> dict[str, Any]:
    costs = np.random.default_rng(0).random((2, n, n))
    return {"matrices": costs.tolist(), "preferences": 2, "time_limit": 0}


def readers(service: ServeProcess) -> list[int]:
    """The processes in which long bodies are read."""
    parent = service.process.pid
    children = Path(f"/proc/{parent}/task/{parent}/children").read_text().split()
    named = {int(pid): Path(f"/proc/{pid}/cmdline").read_bytes() for pid in children}
    return [pid for pid, command in named.items() if b"anyio.to_process" in command]


def until_done(answer: Future[httpx.Response], url: str) -> int:
    """How often the service said that it lives before the answer came."""
    times = 0
    with httpx.Client(base_url=url, timeout=300) as client:
        while not answer.done():
            times += client.get("/health/live").status_code == 200
            time.sleep(0.002)
    return times


def test_a_long_body_is_planned(service: ServeProcess) -> None:
    body = json.dumps(matrices(100)).encode()
    assert len(body) > 300_000
    answer = post(service.url, body)
    assert answer.status_code == 200, answer.text
    assert answer.json()["cities"] == 100


def test_what_is_wrong_with_a_long_body_is_said_as_of_a_short_one(service: ServeProcess) -> None:
    wrong = matrices(100)
    wrong["matrices"][1][7][3] = -1.5
    document = problem(post(service.url, json.dumps(wrong).encode()), 422, "invalid-request")
    [fault] = document["errors"]
    assert fault["pointer"] == "/matrices/1/7/3"
    assert fault["detail"] == "matrices/1/7/3 must not be negative, got -1.5"
    cities = json.dumps({"coordinates": [[0, 0, 0, 0]] * 40_000}).encode()
    document = problem(post(service.url, cities), 413, "too-many-cities")
    assert (document["limit"], document["actual"]) == (10_000, 40_000)


def test_the_service_goes_on_answering_while_it_reads_a_long_body(service: ServeProcess) -> None:
    with ThreadPoolExecutor(1) as pool:
        post(service.url, json.dumps(matrices(100)).encode())  # by now there is a reader
        answer = pool.submit(post, service.url, WRONG)
        assert until_done(answer, service.url) > 10
    problem(answer.result(), 422, "invalid-request")


def test_a_reader_that_is_killed_is_replaced_and_the_body_read_again(service: ServeProcess) -> None:
    with ThreadPoolExecutor(1) as pool:
        post(service.url, json.dumps(matrices(100)).encode())
        [reader] = readers(service)
        answer = pool.submit(post, service.url, WRONG)
        time.sleep(0.2)
        os.kill(reader, signal.SIGKILL)
        problem(answer.result(), 422, "invalid-request")
    assert reader not in readers(service)
