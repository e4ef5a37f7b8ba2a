"""Request ids, security headers and the request log, against a live server."""

import asyncio
import socket
import time
from collections.abc import Iterator
from urllib.parse import urlsplit

import httpx
import pytest
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.api.app import Edge
from service.api.metrics import Metrics
from service.api.middleware import AnsweredRequest, SecurityHeadersMiddleware
from tests.helpers.actors import Broken
from tests.helpers.serving import app_of, problem, serving

FRONT = {"coordinates": [[0, 0, 1, 3], [2, 5, 0, 0], [4, 1, 2, 2]], "time_limit": 0}


@pytest.fixture(scope="module")
def client() -> Iterator[httpx.Client]:
    with serving(app_of(), warm=False) as address, httpx.Client(base_url=address) as client:
        yield client


@pytest.mark.parametrize(("given", "kept"), [("job-17.a_B", True), ("x" * 65, False), ("é", False)])
def test_the_callers_own_request_id_is_kept_where_it_is_plain(
    client: httpx.Client, given: str, kept: bool
) -> None:
    answer = client.get("/health/live", headers={"X-Request-ID": given.encode()})
    assert (answer.headers["x-request-id"] == given) is kept


def test_browsers_are_told_to_load_nothing_from_elsewhere(client: httpx.Client) -> None:
    for path in ("/", "/health/live", "/nowhere"):
        headers = client.get(path).headers
        assert headers["content-security-policy"].startswith("default-src 'none'")
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["x-frame-options"] == "DENY"


def test_headers_that_an_answer_has_already_are_replaced() -> None:
    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        await Response(headers={"X-Frame-Options": "SAMEORIGIN"})(scope, receive, send)

    sent: list[Message] = []
    asyncio.run(_answer(SecurityHeadersMiddleware(app), sent))
    frames = [value for name, value in sent[0]["headers"] if name == b"x-frame-options"]
    assert frames == [b"DENY"]


async def _answer(app: ASGIApp, sent: list[Message]) -> None:
    async def send(message: Message) -> None:
        sent.append(message)

    async def receive() -> Message:
        return {"type": "http.request"}

    await app({"type": "http"}, receive, send)


def test_a_bug_is_500_and_tells_the_caller_nothing_but_its_request(
    caplog: pytest.LogCaptureFixture,
) -> None:
    with serving(app_of(Broken())) as url:
        answer = httpx.post(f"{url}/front", json=FRONT)
    document = problem(answer, 500, "internal-error")
    assert "no tour" not in answer.text
    assert document["request_id"] in caplog.text
    assert "no tour of 3 cities" in caplog.text


class Observed(Metrics):
    """Metrics that keep what they are told."""

    def __init__(self) -> None:
        super().__init__()
        self.requests: list[AnsweredRequest] = []

    def answered(self, answered: AnsweredRequest) -> None:
        self.requests.append(answered)


def test_a_client_that_goes_away_before_its_body_has_ended_is_not_a_fault(
    caplog: pytest.LogCaptureFixture,
) -> None:
    observed = Observed()
    with serving(app_of(edge=Edge(metrics=observed)), warm=False) as url:
        address = urlsplit(url)
        with socket.create_connection((address.hostname, address.port)) as connection:
            head = "POST /front HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
            connection.sendall(f"{head}Content-Length: 100\r\n\r\n[".encode())
        deadline = time.monotonic() + 10
        while not observed.requests and time.monotonic() < deadline:
            time.sleep(0.01)
    [request] = observed.requests
    assert (request.method, request.path, request.status) == ("POST", "/front", 499)
    assert not [record for record in caplog.records if record.exc_info]
