"""The budget of all bodies under way: what is over it is refused, and all is given back."""

import asyncio
import re
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing
from dataclasses import replace
from pathlib import Path

import httpx
import pytest
from starlette.responses import Response
from starlette.types import Message

from service.api.app import Edge
from service.api.body_budget import BodyBudget
from service.errors import Refusal
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from service.kinds.front_document import joined
from tests.helpers.actors import Shuffler
from tests.helpers.scripted_runner import document
from tests.helpers.serving import app_of, problem, serving
from tests.helpers.stores import record

BUDGET = 800_000
JSON = {"Content-Type": "application/json"}
REQUEST = b'{"coordinates":[[0,0,0,0],[1,2,3,4],[5,5,2,1]],"time_limit":0}'


def test_an_allowance_gives_its_bytes_back() -> None:
    budget = BodyBudget(BUDGET, share=0.5)
    with budget.open() as allowance:
        allowance.add(bytes(1000))
        allowance.add(bytes(1000))
        assert 2000 <= budget.used <= 2200
    assert budget.used == 0


def test_a_part_is_left_to_small_bodies() -> None:
    budget = BodyBudget(BUDGET, share=0.5)
    with budget.open() as long, budget.open() as small:
        long.add(bytes(600_000))
        with pytest.raises(Refusal, match="must fit into 800000 bytes"):
            long.add(bytes(150_000))
        small.add(bytes(100_000))
        with pytest.raises(Refusal):
            small.reserve(150_000)
    assert budget.used == 0


def test_a_body_takes_its_declared_length_before_it_comes() -> None:
    budget = BodyBudget(BUDGET, share=0.5)
    with budget.open("one") as early, budget.open("another") as late:
        early.reserve(500_000)
        with pytest.raises(Refusal):
            late.reserve(300_000)
        early.add(bytes(400_000))
        assert budget.used == 500_000
    assert budget.used == 0


def test_long_bodies_of_one_client_take_no_more_than_its_share() -> None:
    budget = BodyBudget(BUDGET, share=0.5)
    with budget.open("one") as first, budget.open("one") as second, budget.open("other") as other:
        first.reserve(300_000)
        with pytest.raises(Refusal, match="bodies"):
            second.reserve(150_000)
        second.reserve(100_000)
        other.reserve(300_000)
    with budget.open("one") as alone:
        alone.reserve(600_000)


def test_many_small_chunks_are_counted_as_what_they_take() -> None:
    budget = BodyBudget(BUDGET, share=0.5)
    with budget.open() as allowance:
        for _ in range(1000):
            allowance.add(b"x")
        assert budget.used > 30_000


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    edge = Edge(bodies_bytes=BUDGET, body_seconds=60)
    with serving(app_of(edge=edge)) as address:
        yield address


def stalled(url: str, length: int) -> socket.socket:
    """A connection on which all of a body but its last byte has been sent."""
    host, port = re.findall(r"//(.*):(\d+)", url)[0]
    connection = socket.create_connection((host, int(port)), timeout=60)
    head = "POST /front HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
    head += f"Content-Length: {length}\r\n\r\n"
    connection.sendall(head.encode() + bytes(length - 1))
    return connection


def test_stalled_uploads_take_no_more_than_the_budget(url: str) -> None:
    with ExitStack() as connections:
        for _ in range(20):
            connections.enter_context(stalled(url, 90_000))
        deadline = time.monotonic() + 60
        refused = None
        while refused is None and time.monotonic() < deadline:
            answer = httpx.post(f"{url}/front", content=95_000 * b" " + REQUEST, headers=JSON)
            refused = answer if answer.status_code == 503 else None
        assert refused is not None
        problem(refused, 503, "bodies-full")
        assert refused.headers["retry-after"] == "1"
    while httpx.post(f"{url}/front", content=95_000 * b" " + REQUEST, headers=JSON).is_error:
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_small_bodies_pass_while_long_ones_stall(url: str) -> None:
    with ExitStack() as connections:
        for _ in range(8):
            connections.enter_context(stalled(url, 80_000))
        answer = httpx.post(f"{url}/front", content=REQUEST, headers=JSON, timeout=300)
        assert answer.status_code == 200, answer.text


@pytest.mark.parametrize("headers", [{}, {"Idempotency-Key": "k"}])
def test_the_body_of_a_job_counts_until_the_job_has_ended(
    headers: dict[str, str], tmp_path: Path
) -> None:
    actor = Shuffler(gate=tmp_path / "gate")
    edge = Edge(bodies_bytes=150_000)
    long = 90_000 * b" " + REQUEST
    with (
        serving(app_of(actor, edge=edge)) as url,
        httpx.Client(base_url=url, timeout=300) as client,
    ):
        later = {**JSON, "Prefer": "respond-async", **headers}
        accepted = client.post("/front", content=long, headers=later)
        assert accepted.status_code == 202
        refused = client.post("/front", content=long, headers={**JSON, "Prefer": "respond-async"})
        problem(refused, 503, "bodies-full")
        # A repeat holds nothing of its own.
        if headers:
            assert client.post("/front", content=REQUEST, headers=later).status_code == 422
        actor.open()
        while client.get(accepted.headers["location"]).json()["status"] != "done":
            time.sleep(0.02)
        again = client.post("/front", content=long, headers=JSON)
        assert again.status_code == 200


def test_an_answer_gives_its_bytes_back_once_it_is_sent_or_has_failed() -> None:
    budget = BodyBudget(BUDGET, share=0.5, answers=True)
    sent: list[Message] = []

    async def send(message: Message) -> None:
        assert budget.used == 600_000
        sent.append(message)

    async def test() -> None:
        with budget.open("one", 600_000) as allowance:
            response = allowance.until_sent(Response(bytes(600_000)))
        await response({"type": "http"}, None, send)  # type: ignore[arg-type]

    asyncio.run(test())
    assert budget.used == 0
    assert sum(len(message.get("body", b"")) for message in sent) == 600_000
    assert [message.get("more_body") for message in sent] == [None, True, True, False]
    with pytest.raises(KeyError), budget.open("one", 600_000):
        raise KeyError
    assert budget.used == 0


def test_long_answers_have_room_beside_others_or_alone() -> None:
    budget = BodyBudget(BUDGET, share=0.5, answers=True)
    with budget.open("one", 2 * BUDGET), budget.open("other", 1000):
        with pytest.raises(Refusal, match="must fit into 800000 bytes"):
            budget.open("other", 200_000)
        with budget.open("other", 200_000, always=True):
            assert budget.used == 2 * BUDGET + 200_000
    with budget.open("one", 300_000):
        with pytest.raises(Refusal):
            budget.open("one", 200_000)
        with budget.open("other", 200_000):
            assert budget.used == 500_000
    assert budget.used == 0


def test_short_answers_pass_beside_any_number_of_long_ones() -> None:
    budget = BodyBudget(BUDGET, share=0.5, answers=True)
    with budget.open("one", BUDGET), ExitStack() as short:
        for _ in range(20):
            short.enter_context(budget.open("other", 130_000))
        assert budget.used == BUDGET


def test_a_body_that_is_handed_over_is_given_back_by_its_new_holder() -> None:
    budget = BodyBudget(BUDGET, share=0.5)
    with budget.open("one", 200_000) as allowance:
        other = allowance.hand_over()
    assert budget.used == 200_000
    with other:
        pass
    assert budget.used == 0


def test_answers_that_nobody_reads_take_no_more_than_the_budget() -> None:
    tour = b'{"balance":0.5,"lengths":[1.0,1.0],"tour":[0],"more":"%b"}' % (b"x" * 20_000_000)
    tours, ends = joined([tour])
    front = replace(document("converged"), tours=tours, ends=ends)
    store = SqliteStore(IN_MEMORY, entries=9, max_age=60)
    asyncio.run(store.put(record("long", caller="anonymous", front=front)))
    edge = Edge(bodies_bytes=30_000_000)
    with serving(app_of(store=store, edge=edge)) as url, closing(socket.socket()) as unread:
        unread.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        unread.connect(("127.0.0.1", int(url.rpartition(":")[2])))
        unread.sendall(b"GET /front/long HTTP/1.1\r\nHost: x\r\n\r\n")
        assert unread.recv(5) == b"HTTP/"
        refused = httpx.get(f"{url}/front/long")
        assert problem(refused, 503, "bodies-full")["limit"] == 30_000_000
        assert refused.headers["Retry-After"]
        short = httpx.post(f"{url}/front", content=REQUEST, headers=JSON)
        assert short.status_code == 200
        unread.close()
        deadline = time.monotonic() + 60
        while (again := httpx.get(f"{url}/front/long")).status_code == 503:
            assert time.monotonic() < deadline
        assert again.content.endswith(tour + b"]}")
