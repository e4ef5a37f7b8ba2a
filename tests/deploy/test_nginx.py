"""nginx as service/deploy configures it, run before a service: what it bounds and passes on."""

import asyncio
import re
import threading
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any
from urllib.parse import urljoin

import httpx
import pytest
from paretour import Client

from service.api.app import Edge
from service.api.auth import Access, Rates
from service.settings import Settings
from tests.api.transport.test_connections import connected, received
from tests.api.transport.test_protocol import GONE, Waiting, serving_asgi
from tests.guide.pages import GUIDE, blocks
from tests.helpers.nginx import CONFIGURATION, nginx_before
from tests.helpers.ports import free_port
from tests.helpers.serving import app_of, problem, serving

_LINK = re.compile(r'(?:href|src)="([^"]+)"')
HEAD = b"POST /front HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
CITIES = {"coordinates": [[0, 0, 0, 0], [1, 0, 0, 1], [0, 1, 1, 1]]}


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    edge = Edge(access=Access(rates=Rates("500/hour")))
    with (
        serving(app_of(edge=edge)) as service,
        nginx_before(service, tmp_path_factory.mktemp("nginx")) as address,
    ):
        yield address


def refusal_of(answer: httpx.Response, status: int, code: str) -> dict[str, Any]:
    document = answer.json()
    assert answer.headers["content-type"] == "application/problem+json"
    assert (answer.status_code, document["status"], document["code"]) == (status, status, code)
    assert document["type"] == f"/guide/errors#{code}"
    return document


def test_a_front_is_planned_through_it(url: str) -> None:
    answer = httpx.post(f"{url}/front", json=CITIES, timeout=300)
    assert answer.status_code == 200
    assert answer.json()["front"]
    problem(httpx.post(f"{url}/front", json={}, timeout=300), 422, "invalid-request")


def test_a_client_cannot_call_itself_by_another_address(tmp_path: Path) -> None:
    edge = Edge(access=Access(rates=Rates("2/day")))
    with serving(app_of(edge=edge), warm=False) as service, nginx_before(service, tmp_path) as url:
        statuses = [
            httpx.get(f"{url}/actors", headers={"X-Forwarded-For": f"192.0.2.{last}"}).status_code
            for last in range(3)
        ]
    assert statuses == [200, 200, 429]


def test_it_takes_bodies_as_long_as_the_service_and_refuses_longer_ones(url: str) -> None:
    most = Settings().max_body_bytes
    headers = {"Content-Type": "application/json"}
    longer = httpx.post(f"{url}/front", content=b" " * (most + 1), headers=headers, timeout=300)
    assert refusal_of(longer, 413, "body-too-long")["limit"] == most
    passed_on = httpx.post(f"{url}/front", content=b" " * most, headers=headers, timeout=300)
    assert problem(passed_on, 413, "body-too-long")["limit"] != most


def test_a_crowd_at_one_address_is_refused_and_others_are_answered(tmp_path: Path) -> None:
    app = Waiting()
    with serving_asgi(app) as service, nginx_before(service, tmp_path) as url, ExitStack() as stack:
        request = HEAD + b"Connection: close\r\nContent-Length: 2\r\n\r\n{}"
        crowd = [stack.enter_context(connected(url, "127.0.0.2")) for _ in range(60)]
        for each in crowd:
            each.sendall(request)
        other = stack.enter_context(connected(url, "127.0.0.3"))
        other.sendall(request)
        refused = [each for each in crowd[50:] if received(each)[0] == 503]
        app.released.set()
        statuses = {received(each)[0] for each in (*crowd[:50], other)}
    assert (len(refused), statuses) == (10, {200})


def test_a_stalled_upload_does_not_reach_the_service(tmp_path: Path) -> None:
    app = Waiting()
    app.released.set()
    with serving_asgi(app) as service, nginx_before(service, tmp_path) as url, ExitStack() as stack:
        stalled, whole = (stack.enter_context(connected(url)) for _ in range(2))
        stalled.sendall(HEAD + b"Connection: close\r\nContent-Length: 3\r\n\r\n{")
        whole.sendall(HEAD + b"Connection: close\r\nContent-Length: 2\r\n\r\n{}")
        assert received(whole)[0] == 200
        calls = app.calls
        stalled.sendall(b" }")
        assert received(stalled)[0] == 200
        assert app.calls == calls + 1


def test_events_are_passed_on_as_they_come(tmp_path: Path) -> None:
    released = threading.Event()

    async def stream(scope: Any, _: Any, send: Any) -> None:
        headers = [(b"x-accel-buffering", b"no")] if "events" in scope["path"] else []
        await send({"type": "http.response.start", "status": 200, "headers": headers})
        if headers:
            await send({"type": "http.response.body", "body": b": hello\n\n", "more_body": True})
            while not released.is_set():
                await asyncio.sleep(0.01)
        await send({"type": "http.response.body", "body": b""})

    with (
        serving_asgi(stream) as service,
        nginx_before(service, tmp_path) as url,
        httpx.stream("GET", f"{url}/front/x/events", timeout=300) as events,
    ):
        parts = events.iter_raw()
        assert next(parts) == b": hello\n\n"
        released.set()
        assert b"".join(parts) == b""


def test_the_work_for_a_client_that_goes_away_stops(tmp_path: Path) -> None:
    app = Waiting()
    with serving_asgi(app) as service, nginx_before(service, tmp_path) as url:
        with connected(url) as connection:
            connection.sendall(HEAD + b"Content-Length: 2\r\n\r\n{}")
            assert app.began.wait(60)
        assert app.ended.wait(60)
    assert app.saw == GONE


def test_where_the_service_is_away_or_the_rate_is_exceeded_it_says_so_itself(
    tmp_path: Path,
) -> None:
    with (
        nginx_before(f"http://127.0.0.1:{free_port()}", tmp_path) as url,
        httpx.Client(base_url=url, timeout=300) as client,
    ):
        answers = [client.get("/actors")]
        while answers[-1].status_code == 503 and len(answers) < 5000:
            answers.append(client.get("/actors"))
    away, too_often = answers[0], answers[-1]
    assert refusal_of(away, 503, "shutting-down")["request_id"]
    assert refusal_of(too_often, 429, "rate-limited")["request_id"]
    assert away.headers["retry-after"] == too_often.headers["retry-after"] == "1"


def test_a_client_cannot_say_that_the_service_is_elsewhere(url: str) -> None:
    problem(httpx.get(f"{url}/none", headers={"X-Forwarded-Prefix": "/a"}), 404, "no-such-path")


def test_under_a_sub_path_everything_is_found_there(tmp_path: Path) -> None:
    [block] = [each for each in blocks(GUIDE / "run-it-in-production.md") if "/tours" in each.text]
    lines = (
        "location / {",
        "proxy_pass http://paretour;",
        'proxy_set_header X-Forwarded-Prefix "";',
    )
    changed = dict(zip(lines, map(str.strip, block.text.splitlines()), strict=True))
    with (
        serving(app_of()) as service,
        nginx_before(service, tmp_path, changed) as site,
        httpx.Client(base_url=site, follow_redirects=True, timeout=300) as client,
    ):
        for path in ("", "docs", "guide", "guide/errors"):
            page = client.get(f"/tours/{path}")
            targets = {urljoin(str(page.url), link) for link in _LINK.findall(page.text)}
            inside = {target for target in targets if target.startswith(site)}
            assert inside
            for target in inside:
                assert target.startswith(f"{site}/tours/")
                assert client.get(target).status_code == 200, target
        refused = problem(client.get("/tours/none"), 404, "no-such-path", "/tours")
        assert client.get(refused["type"]).status_code == 200
        accepted = client.post("/tours/front", json=CITIES, headers={"Prefer": "respond-async"})
        assert client.get(accepted.headers["location"]).status_code == 200
        with Client(f"{site}/tours") as planner:
            assert [each.id for each in planner.fronts()] == [accepted.json()["id"]]


def test_its_limits_are_those_of_the_settings() -> None:
    text = CONFIGURATION.read_text()
    settings = Settings()
    assert f"client_max_body_size {settings.max_body_bytes // 2**20}m;" in text
    assert f'"limit":{settings.max_body_bytes},' in text
    assert f"client_header_timeout {settings.head_seconds:g}s;" in text
    assert settings.request_seconds < 120
    assert "proxy_read_timeout 120s;" in text
