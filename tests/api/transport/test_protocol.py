"""Connections that send much at once, or no more at all, against live servers and raw sockets."""

import asyncio
import json
import select
import socket
import threading
import time
from collections.abc import Callable, Iterator, MutableMapping
from contextlib import ExitStack, contextmanager
from typing import Any

import httpx
import pytest

from service.api.transport import protocol
from service.api.transport.connections import ConnectionLimits, Connections
from service.api.transport.http_parser import StrictParser
from service.api.transport.listener import bound_sockets
from service.server import make_server
from tests.api.transport.test_connections import connected, read_to_the_end, sent_until_closed
from tests.helpers.serving import app_of, serving

HEALTH = b"GET /health/live HTTP/1.1\r\nHost: x\r\n\r\n"
POST = b"POST /nowhere HTTP/1.1\r\nHost: x\r\n"
TINY_CHUNK = b"1\r\n \r\n"
GONE, RELEASED = "gone", "released"


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    patient = ConnectionLimits(head_seconds=120)  # a crowd takes this long on a busy machine
    with serving(app_of(), warm=False, connections=patient) as address:
        yield address


def everything(connection: socket.socket) -> bytes:
    return b"".join(iter(lambda: connection.recv(2**16), b""))


def read_until(connection: socket.socket, end: bytes) -> None:
    content = b""
    while end not in content:
        chunk = connection.recv(2**16)
        assert chunk
        content += chunk


def test_others_are_answered_before_a_crowd_of_tiny_chunks_is_parsed(url: str) -> None:
    with ExitStack() as stack:
        crowd = [stack.enter_context(connected(url, "127.0.0.2")) for _ in range(8)]
        for each in crowd:
            each.sendall(POST + b"Transfer-Encoding: chunked\r\n\r\n")
            read_until(each, b'"request_id"')
        for each in crowd:
            each.sendall(40_000 * TINY_CHUNK + b"0\r\n\r\n" + HEALTH)
        assert httpx.get(f"{url}/health/live", timeout=300).status_code == 200
        answered, _, _ = select.select(crowd, [], [], 0)  # once all its chunks are parsed
        assert len(answered) < len(crowd)
        for each in crowd:
            each.settimeout(120)
            read_until(each, b'{"status":"live"}')


def test_others_are_answered_before_a_crowd_of_requests_is(url: str) -> None:
    with ExitStack() as stack:
        crowd = [stack.enter_context(connected(url, "127.0.0.2")) for _ in range(30)]
        for each in crowd:
            each.sendall(200 * HEALTH)
        with connected(url, "127.0.0.3") as honest:
            honest.sendall(HEALTH)
            read_until(honest, b'{"status":"live"}')
        readable, _, _ = select.select(crowd, [], [], 0)
        answers = sum(each.recv(2**24).count(b"HTTP/1.1 200") for each in readable)
        assert answers < 30 * 200 / 2


def test_no_more_is_read_than_a_little_of_the_requests_that_wait(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    held: list[int] = []
    receive = StrictParser.receive_data

    def receive_and_count(parser: StrictParser, data: bytes) -> None:
        receive(parser, data)
        held.append(len(parser.trailing_data[0]))

    monkeypatch.setattr(StrictParser, "receive_data", receive_and_count)

    async def answer(_: Any, receive: Any, send: Any) -> None:
        await receive()
        await send({"type": "http.response.start", "status": 204, "headers": []})
        await send({"type": "http.response.body"})

    requests = 4_000 * (POST + b"Content-Length: 2\r\n\r\n{}")
    with serving_asgi(answer) as url, connected(url) as connection:
        connection.settimeout(120)
        sending = threading.Thread(target=sent_until_closed, args=[connection, requests])
        sending.start()
        answers = 0
        while answers < 2000:
            answers += connection.recv(2**16).count(b"HTTP/1.1 204")
        connection.shutdown(socket.SHUT_RDWR)
        sending.join()
    assert max(held) < 2**15


@contextmanager
def serving_asgi(app: Callable[..., Any]) -> Iterator[str]:
    """Serve an ASGI application in a thread until the block ends, and yield its address."""
    [listening] = bound_sockets("127.0.0.1", 0)
    server = make_server(app, Connections(ConnectionLimits()), 5)  # type: ignore[arg-type]
    server.config.lifespan = "off"
    thread = threading.Thread(target=server.run, args=[[listening]])
    thread.start()
    try:
        while not server.started:
            time.sleep(0.02)
        yield f"http://127.0.0.1:{listening.getsockname()[1]}"
    finally:
        server.should_exit = True
        thread.join()


class Waiting:
    """An application that answers how its wait for a release ended, and says so to the test."""

    def __init__(self) -> None:
        self.began, self.released, self.ended = (threading.Event() for _ in range(3))
        self.saw = ""
        self.calls = 0

    async def __call__(self, _: Any, receive: Any, send: Any) -> None:
        """Wait until the test releases it, or the client goes away."""
        self.calls += 1
        await receive()
        self.began.set()
        gone = asyncio.ensure_future(receive())
        while not (self.released.is_set() or gone.done()):
            await asyncio.sleep(0.005)
        self.saw = GONE if gone.done() else RELEASED
        start: MutableMapping[str, Any] = {"type": "http.response.start", "status": 200}
        await send({**start, "headers": [(b"content-length", b"8")]})
        await send({"type": "http.response.body", "body": self.saw.encode()})
        self.ended.set()


@pytest.mark.parametrize("version", [b"1.0", b"1.1"])
@pytest.mark.parametrize("seconds", [0.001, 0.02, 0.25])
def test_a_client_that_sends_no_more_gets_its_answer_as_it_is(
    monkeypatch: pytest.MonkeyPatch, version: bytes, seconds: float
) -> None:
    monkeypatch.setattr(protocol, "_HALF_CLOSED_SECONDS", seconds)
    app = Waiting()
    with serving_asgi(app) as url, connected(url) as connection:
        connection.sendall(POST.replace(b"1.1", version) + b"Content-Length: 2\r\n\r\n{}")
        connection.shutdown(socket.SHUT_WR)
        assert app.began.wait(60)
        time.sleep(40 * seconds if seconds < 0.1 else 0)  # for letters that are sent ahead
        app.released.set()
        head, _, body = everything(connection).partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 200 ")
    assert head.count(b"HTTP/1.1") == 1
    assert (body, app.saw) == (b"released", RELEASED)


def test_the_work_for_a_client_that_goes_away_stops_though_it_may_have_read_on() -> None:
    app = Waiting()
    with serving_asgi(app) as url:
        with connected(url) as connection:
            connection.sendall(POST + b"Content-Length: 2\r\n\r\n{}")
            assert app.began.wait(60)
            connection.shutdown(socket.SHUT_WR)
        assert app.ended.wait(60)
    assert app.saw == GONE


def test_a_client_that_sends_no_more_gets_all_its_answers(url: str) -> None:
    body = json.dumps({"coordinates": [[0, 0, 0, 0], [1, 0, 0, 1], [0, 1, 1, 1]]}).encode()
    front = b"POST /front HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
    front += b"Content-Length: %d\r\n\r\n" % len(body) + body
    with connected(url) as connection:
        connection.settimeout(120)
        connection.sendall(HEALTH + front + 20 * HEALTH)
        connection.shutdown(socket.SHUT_WR)
        content = everything(connection)
    assert content.count(b"HTTP/1.1 200") == 22
    assert content.endswith(b'{"status":"live"}')


@pytest.mark.parametrize("sent", [HEALTH[:-4], POST + b"Content-Length: 9\r\n\r\n{", b""])
def test_a_client_that_ends_in_the_middle_of_a_request_is_not_waited_for(
    url: str, sent: bytes
) -> None:
    with connected(url) as connection:
        connection.sendall(sent)
        connection.shutdown(socket.SHUT_WR)
        connection.settimeout(60)
        read_to_the_end(connection)
