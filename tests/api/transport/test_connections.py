"""Connections that are many, silent, slow or endless, against live servers and raw sockets."""

import errno
import json
import resource
import socket
import time
from asyncio.selector_events import _SelectorSocketTransport
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from select import select
from urllib.parse import urlsplit

import httpx
import pytest

from service.api.app import Edge
from service.api.transport import protocol
from service.api.transport.connections import ConnectionLimits
from tests.helpers.processes import serve_process
from tests.helpers.serving import app_of, serving

JSON = "Content-Type: application/json\r\n"
HEAD = f"POST /front HTTP/1.1\r\nHost: x\r\n{JSON}Content-Length: 100\r\n"
STALLED = f"{HEAD}\r\n[".encode()
CHUNK = b"10000\r\n" + b" " * 2**16 + b"\r\n"


def connected(url: str, source: str = "127.0.0.1") -> socket.socket:
    address = urlsplit(url)
    return socket.create_connection(
        (address.hostname, address.port), timeout=60, source_address=(source, 0)
    )


def stall(connection: socket.socket) -> None:
    """Begin a body and do not go on, once the server has begun to read it."""
    connection.sendall(f"{HEAD}Expect: 100-continue\r\n\r\n".encode())
    assert connection.recv(2**16).startswith(b"HTTP/1.1 100")
    connection.sendall(b"[")


def received(connection: socket.socket) -> tuple[int, dict[str, str], bytes]:
    """Read until the server closes, and return the status, headers and body."""
    content = b""
    while chunk := connection.recv(2**16):
        content += chunk
    head, _, body = content.partition(b"\r\n\r\n")
    first, *lines = head.decode().split("\r\n")
    headers = dict(line.lower().split(": ", 1) for line in lines)
    return int(first.split()[1]), headers, body


def problem_in(connection: socket.socket, status: int, code: str) -> None:
    came, headers, body = received(connection)
    document = json.loads(body)
    assert (came, document["code"], document["status"]) == (status, code, status)
    assert headers["content-type"] == "application/problem+json"
    assert headers["x-request-id"] == document["request_id"]
    assert headers["connection"] == "close"


def is_closed(connection: socket.socket) -> bool:
    """Return whether the server has closed a connection on which it had nothing to say."""
    connection.settimeout(30)
    try:
        return connection.recv(1) == b""
    except ConnectionResetError:
        return True


def sent_until_closed(connection: socket.socket, chunk: bytes, pause: float = 0) -> int:
    """Send a chunk again and again, and return how many bytes the server took: 256 MB at most."""
    sent = 0
    with suppress(ConnectionError):
        while sent < (2**28 if pause == 0 else 200 * len(chunk)):
            connection.sendall(chunk)
            sent += len(chunk)
            time.sleep(pause)
    return sent


def read_to_the_end(connection: socket.socket) -> int:
    """Return how many bytes the server sent until it closed the connection."""
    came = 0
    with suppress(ConnectionError):
        while chunk := connection.recv(2**16):
            came += len(chunk)
    return came


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    with serving(app_of(), warm=False) as address:
        yield address


@pytest.fixture(scope="module")
def impatient() -> Iterator[str]:
    limits = ConnectionLimits(head_seconds=1.0)
    with serving(app_of(), warm=False, connections=limits) as address:
        yield address


@contextmanager
def many_descriptors() -> Iterator[None]:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, 4096), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def test_a_crowd_of_idle_connections_is_gone_soon_and_others_are_answered_meanwhile(
    quick_actors: dict[str, str],
) -> None:
    settings = {"PARETOUR_HEAD_SECONDS": "3", "PARETOUR_WORKERS": "1", **quick_actors}
    with (
        many_descriptors(),
        serve_process(settings, descriptors=1024) as service,
        ExitStack() as open_ones,
    ):
        crowd = [open_ones.enter_context(connected(service.url)) for _ in range(1100)]
        began = time.monotonic()
        while time.monotonic() < began + 1:
            assert httpx.get(f"{service.url}/health/live", timeout=300).status_code == 200
        for idle in crowd:
            assert is_closed(idle)
    assert b"out of system resource" not in service.log
    assert service.log.count(b"make way") <= 10


def test_a_slow_head_is_refused_in_time_however_steadily_it_drips(impatient: str) -> None:
    with connected(impatient) as connection:
        for letter in b"GET /health/live HTTP/1.1\r\nX-Slow: " + b"x" * 1000:
            connection.sendall(bytes([letter]))
            answered, _, _ = select([connection], [], [], 0.05)
            if answered:
                break
        problem_in(connection, 408, "head-too-slow")


def test_a_connection_that_was_answered_may_not_be_slow_with_its_next_head(impatient: str) -> None:
    with connected(impatient) as connection:
        connection.sendall(b"GET /health/live HTTP/1.1\r\nHost: x\r\n\r\n")
        assert connection.recv(2**16).startswith(b"HTTP/1.1 200")
        connection.sendall(b"GET /health")
        problem_in(connection, 408, "head-too-slow")


def test_where_all_connections_are_busy_a_new_one_is_told_so() -> None:
    limits = ConnectionLimits(connections=3)
    with ExitStack() as stack:
        url = stack.enter_context(serving(app_of(), warm=False, connections=limits))
        for _ in range(3):
            stall(stack.enter_context(connected(url)))
        for _ in range(40):
            refused = httpx.get(f"{url}/actors")
            assert refused.status_code == 503
            assert refused.json()["code"] == "too-many-connections"
            assert refused.headers["retry-after"] == "1"
        with connected(url) as connection:
            problem_in(connection, 503, "too-many-connections")


def test_the_connection_that_is_idle_longest_makes_way() -> None:
    limits = ConnectionLimits(connections=2)
    with serving(app_of(), warm=False, connections=limits) as url, ExitStack() as stack:
        first = stack.enter_context(connected(url))
        busy = stack.enter_context(connected(url))
        stall(busy)
        assert httpx.get(f"{url}/actors").status_code == 200
        assert is_closed(first)
        busy.sendall(b" " * 98 + b"]")
        assert busy.recv(2**16).startswith(b"HTTP/1.1 422")


def answered(connection: socket.socket, request: bytes = b"GET /actors") -> int:
    connection.sendall(request + b" HTTP/1.1\r\nHost: x\r\n\r\n")
    return int(connection.recv(2**16).split()[1])


def status_at(url: str, source: str) -> int:
    with connected(url, source) as connection:
        return answered(connection)


def test_one_address_cannot_take_the_connections_of_others() -> None:
    limits = ConnectionLimits(connections=8, share=0.25)
    with serving(app_of(), warm=False, connections=limits) as url, ExitStack() as stack:
        crowd = [stack.enter_context(connected(url, "127.0.0.2")) for _ in range(2)]
        for busy in crowd:
            stall(busy)
        for _ in range(40):
            with connected(url, "127.0.0.2") as more:
                problem_in(more, 503, "too-many-connections")
        with connected(url, "127.0.0.3") as other:
            assert answered(other) == 200
        crowd[0].close()
        ends = time.monotonic() + 30  # for the server to notice
        while status_at(url, "127.0.0.2") != 200:
            assert time.monotonic() < ends


def test_of_an_address_with_its_share_the_connection_idle_longest_makes_way() -> None:
    limits = ConnectionLimits(connections=8, share=0.25)
    with serving(app_of(), warm=False, connections=limits) as url, ExitStack() as stack:
        of_another = stack.enter_context(connected(url, "127.0.0.3"))
        first, second = (stack.enter_context(connected(url, "127.0.0.2")) for _ in range(2))
        with connected(url, "127.0.0.2") as third:
            assert answered(third) == 200
        assert is_closed(first)
        assert answered(second) == 200
        assert answered(of_another) == 200


@pytest.mark.parametrize(
    ("proxies", "status"),
    [("127.0.0.2", 200), ("127.0.0.0/28", 200), ("*", 200), ("10.0.0.1", 503)],
)
def test_a_trusted_proxy_may_take_all_connections(proxies: str, status: int) -> None:
    limits = ConnectionLimits(connections=8, share=0.25, proxies=proxies)
    with serving(app_of(), warm=False, connections=limits) as url, ExitStack() as stack:
        for _ in range(2):
            stall(stack.enter_context(connected(url, "127.0.0.2")))
        with connected(url, "127.0.0.2") as third:
            assert answered(third) == status


def test_the_share_of_an_address_is_one_connection_at_least() -> None:
    assert ConnectionLimits(connections=3, share=0.01).of_address == 1
    assert ConnectionLimits(connections=1000).of_address == 250


@pytest.mark.parametrize("close", [True, False], ids=["close", "keep-alive"])
def test_a_refusal_arrives_though_twenty_megabytes_are_sent_all_the_same(
    url: str, close: bool
) -> None:
    end = "Connection: close\r\n" if close else ""
    head = f"POST /front HTTP/1.1\r\nHost: x\r\n{JSON}{end}Content-Length: {20 * 2**20}\r\n\r\n"
    with connected(url) as connection:
        connection.sendall(head.encode())
        for _ in range(20):
            connection.sendall(b" " * 2**20)
        connection.shutdown(socket.SHUT_WR)
        status, _, body = received(connection)
    assert (status, json.loads(body)["code"]) == (413, "body-too-long")


@pytest.mark.parametrize("chunked", [False, True])
def test_httpx_gets_the_refusal_of_a_body_of_twenty_megabytes(url: str, chunked: bool) -> None:
    body = b" " * (20 * 2**20)
    headers = {"Content-Type": "application/json", "Connection": "close"}
    for _ in range(3):
        content = (body[at : at + 2**16] for at in range(0, len(body), 2**16))
        answer = httpx.post(f"{url}/front", content=content if chunked else body, headers=headers)
        assert (answer.status_code, answer.json()["code"]) == (413, "body-too-long")


def test_a_client_that_resets_a_refused_connection_leaves_no_error_in_the_log(
    url: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def find_it_gone(_: object) -> None:
        raise OSError(errno.ENOTCONN, "Transport endpoint is not connected")

    # As where the reset comes between the answer and the end of what is sent.
    monkeypatch.setattr(_SelectorSocketTransport, "write_eof", find_it_gone)
    with connected(url) as connection:
        connection.sendall(STALLED.replace(b"100", b"20000000"))
        read_to_the_end(connection)
    assert httpx.get(f"{url}/actors").status_code == 200
    assert "Traceback" not in caplog.text


@pytest.mark.parametrize("close", [True, False], ids=["close", "keep-alive"])
def test_a_client_that_sends_for_ever_is_cut_off(url: str, close: bool) -> None:
    end = "Connection: close\r\n" if close else ""
    head = f"POST /front HTTP/1.1\r\nHost: x\r\n{JSON}{end}Transfer-Encoding: chunked\r\n\r\n"
    with connected(url) as connection:
        connection.sendall(head.encode())
        assert sent_until_closed(connection, CHUNK) < 2**28


@pytest.mark.parametrize("close", [True, False], ids=["close", "keep-alive"])
def test_a_client_that_drips_for_ever_is_cut_off(
    impatient: str, close: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(protocol, "_LINGER_SECONDS", 0.5)
    end = "Connection: close\r\n" if close else ""
    head = f"POST /nowhere HTTP/1.1\r\nHost: x\r\n{end}Transfer-Encoding: chunked\r\n\r\n"
    with connected(impatient) as connection:
        connection.sendall(head.encode())
        assert sent_until_closed(connection, b"1\r\nx\r\n", pause=0.05) < 100 * 6


def test_a_body_that_comes_too_slowly_is_told_so_before_the_connection_is_closed() -> None:
    edge = Edge(body_seconds=0.3)
    with serving(app_of(edge=edge), warm=False) as url, connected(url) as connection:
        connection.sendall(STALLED)
        time.sleep(0.5)
        connection.sendall(b" ")
        problem_in(connection, 408, "body-too-slow")


@pytest.mark.parametrize(
    ("request_", "status"),
    [
        ("POST /front HTTP/1.1\r\nHost: x\r\nContent-Length: 4\r\nTransfer-Encoding: chunked", 400),
        ("HEAD / HTTP/1.1\r\nHost: x\r\nContent-Length: 4\r\nTransfer-Encoding: chunked", 400),
        ("POST /front HTTP/1.0\r\nTransfer-Encoding: chunked", 400),
        ("POST /front HTTP/1.1\r\nHost: x\r\nContent-Length: 4\r\nContent-Length: 5", 400),
        ("POST /front HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: gzip", 501),
        ("GET / HTTP/1.1", 400),
        ("GET / HTTP/1.1\r\nHost: x\r\nX-Long: " + "x" * 2**17, 431),
        ("hello", 400),
    ],
    ids=["both", "both, head", "1.0", "two lengths", "coding", "no host", "long", "no http"],
)
def test_a_request_whose_end_is_in_doubt_is_refused_and_the_connection_closed(
    url: str, request_: str, status: int
) -> None:
    smuggled = b"0\r\n\r\nGET /health/live HTTP/1.1\r\nHost: x\r\n\r\n"
    with connected(url) as connection:
        connection.sendall(request_.encode() + b"\r\n\r\n" + smuggled)
        connection.shutdown(socket.SHUT_WR)
        came, headers, body = received(connection)
    assert (came, headers["connection"]) == (status, "close")
    if request_.startswith("HEAD"):
        assert body == b""
    else:
        assert json.loads(body)["code"] == "malformed-http"


def test_a_broken_chunk_ends_the_request_without_an_error_in_the_log(
    url: str, caplog: pytest.LogCaptureFixture
) -> None:
    head = f"POST /front HTTP/1.1\r\nHost: x\r\n{JSON}Transfer-Encoding: chunked\r\n\r\n"
    with connected(url) as connection:
        connection.sendall(head.encode())
        time.sleep(0.1)
        connection.sendall(b"no number\r\n")
        connection.shutdown(socket.SHUT_WR)
        problem_in(connection, 400, "malformed-http")
    assert not [record for record in caplog.records if record.exc_info]


def test_a_client_that_does_not_read_its_answer_is_cut_off(
    url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(protocol, "_STALL_SECONDS", 0.5)
    path = "/docs/vendor/swagger-ui/swagger-ui-bundle.js"
    ask = f"GET {path} HTTP/1.1\r\nHost: x\r\n\r\n".encode()
    with connected(url) as connection:
        connection.sendall(ask * 20)
        time.sleep(2)
        assert read_to_the_end(connection) < 15 * 2**20


def test_an_upgrade_leaves_no_warning_in_the_log(
    url: str, caplog: pytest.LogCaptureFixture
) -> None:
    headers = {"Connection": "Upgrade", "Upgrade": "websocket"}
    assert httpx.get(f"{url}/actors", headers=headers).status_code == 200
    assert "pgrade" not in caplog.text


def test_requests_that_come_together_are_answered_one_after_another(url: str) -> None:
    request = b"GET /health/live HTTP/1.1\r\nHost: x\r\n"
    with connected(url) as connection:
        connection.sendall(request + b"\r\n" + request + b"Connection: close\r\n\r\n")
        content = b"".join(iter(lambda: connection.recv(2**16), b""))
    assert content.count(b"HTTP/1.1 200") == content.count(b'{"status":"live"}') == 2
    assert content.endswith(b'{"status":"live"}')
