"""Long bodies over real HTTP: read beside the event loop, with the answers that short ones get."""

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

from tests.helpers.serving import Running, problem, running

# Some tenths of a second of work for whoever reads it.
WRONG = json.dumps({f"member {i}": i for i in range(100_000)}).encode()


@pytest.fixture(scope="module")
def service() -> Iterator[Running]:
    with running({"PARETOUR_WORKERS": "1"}) as service:
        yield service


def post(url: str, body: bytes) -> httpx.Response:
    headers = {"Content-Type": "application/json"}
    return httpx.post(f"{url}/front", content=body, headers=headers, timeout=60)


def matrices(n: int) -> dict[str, Any]:
    costs = np.random.default_rng(0).random((2, n, n))
    return {"matrices": costs.tolist(), "preferences": 2, "time_limit": 0}


def readers(service: Running) -> list[int]:
    """The processes in which long bodies are read."""
    parent = service.process.pid
    children = Path(f"/proc/{parent}/task/{parent}/children").read_text().split()
    named = {int(pid): Path(f"/proc/{pid}/cmdline").read_bytes() for pid in children}
    return [pid for pid, command in named.items() if b"anyio.to_process" in command]


def until_done(answer: Future[httpx.Response], url: str) -> int:
    """How often the service said that it lives before the answer came."""
    times = 0
    with httpx.Client(base_url=url, timeout=60) as client:
        while not answer.done():
            times += client.get("/health/live").status_code == 200
            time.sleep(0.002)
    return times


def test_a_long_body_is_planned(service: Running) -> None:
    body = json.dumps(matrices(100)).encode()
    assert len(body) > 300_000
    answer = post(service.url, body)
    assert answer.status_code == 200, answer.text
    assert answer.json()["cities"] == 100


def test_what_is_wrong_with_a_long_body_is_said_as_of_a_short_one(service: Running) -> None:
    wrong = matrices(100)
    wrong["matrices"][1][7][3] = -1.5
    document = problem(post(service.url, json.dumps(wrong).encode()), 422, "invalid-request")
    [fault] = document["errors"]
    assert fault["pointer"] == "/matrices/1/7/3"
    assert fault["detail"] == "matrices/1/7/3 must not be negative, got -1.5"
    cities = json.dumps({"coordinates": [[0, 0, 0, 0]] * 40_000}).encode()
    document = problem(post(service.url, cities), 413, "too-many-cities")
    assert (document["limit"], document["actual"]) == (1000, 40_000)


def test_the_service_goes_on_answering_while_it_reads_a_long_body(service: Running) -> None:
    with ThreadPoolExecutor(1) as pool:
        post(service.url, json.dumps(matrices(100)).encode())  # by now there is a reader
        answer = pool.submit(post, service.url, WRONG)
        assert until_done(answer, service.url) > 10
    problem(answer.result(), 422, "invalid-request")


def test_a_reader_that_is_killed_is_replaced_and_the_body_read_again(service: Running) -> None:
    with ThreadPoolExecutor(1) as pool:
        post(service.url, json.dumps(matrices(100)).encode())
        [reader] = readers(service)
        answer = pool.submit(post, service.url, WRONG)
        time.sleep(0.2)
        os.kill(reader, signal.SIGKILL)
        problem(answer.result(), 422, "invalid-request")
    assert reader not in readers(service)
