"""Under a path of another site: what a proxy has taken away from it comes back in every answer."""

import json
from collections.abc import Iterator

import httpx
import pytest

from service.api.responses import problem_under
from service.api.transport.connections import ConnectionLimits
from tests.api.transport.test_connections import connected, received
from tests.helpers.actors import Broken
from tests.helpers.processes import serve_process
from tests.helpers.serving import app_of, problem, serving

BODY = {"coordinates": [[0, 0, 0, 0], [1, 0, 0, 1], [0, 1, 1, 1]], "time_limit": 0, "repairs": 0}
ASYNC = {"Prefer": "respond-async"}
TOURS = {"X-Forwarded-Prefix": "/tours"}


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    """A service whose setting says /set, before which no proxy has to stand."""
    with serving(app_of(), root_path="/set") as address:
        yield address


@pytest.mark.parametrize(
    ("headers", "root_path"),
    [
        ({}, "/set"),
        (TOURS, "/tours"),
        ({"X-Forwarded-Prefix": "/plan/tours/"}, "/plan/tours"),
        ({"X-Forwarded-Prefix": "/"}, ""),
    ],
)
def test_what_an_answer_leads_to_begins_with_the_path_that_the_proxy_took_away(
    url: str, headers: dict[str, str], root_path: str
) -> None:
    with httpx.Client(base_url=url, headers=headers, timeout=300) as client:
        location = ""
        for _ in range(2):
            accepted = client.post("/front", json=BODY, headers=ASYNC)
            location = accepted.headers["location"]
            assert location == f"{root_path}/front/{accepted.json()['id']}"
        assert client.get(location.removeprefix(root_path)).status_code == 200
        link = client.get("/front?limit=1").links["next"]["url"]
        assert link.startswith(f"{root_path}/front?limit=1&after=")
        assert client.get(link.removeprefix(root_path)).status_code == 200
        problem(client.get("/front/none"), 404, "unknown-front", root_path)
        missing = problem(client.get("/none"), 404, "no-such-path", root_path)
        assert missing["detail"].endswith(f"{root_path}/none; {root_path}/docs says what is")
        problem(client.get("/page/icon.svg", headers={"Range": "x"}), 400, "refused", root_path)


def test_the_document_names_the_path_as_its_server(url: str) -> None:
    for headers, root_path in (TOURS, "/tours"), ({}, "/set"):
        document = httpx.get(f"{url}/openapi.json", headers=headers).json()
        assert document["servers"] == [{"url": root_path}]
    with serving(app_of(), warm=False) as other:
        assert "servers" not in httpx.get(f"{other}/openapi.json").json()


def test_the_command_heeds_the_settings_of_its_path_and_of_the_proxies_it_trusts(
    quick_actors: dict[str, str],
) -> None:
    settings = {
        "PARETOUR_ROOT_PATH": "/set",
        "PARETOUR_RATE": "2/day",
        "FORWARDED_ALLOW_IPS": "192.0.2.1",
        "PARETOUR_WORKERS": "1",
        **quick_actors,
    }
    with serve_process(settings) as service:
        problem(httpx.get(f"{service.url}/none"), 404, "no-such-path", "/set")
        # The header of a proxy that is not trusted counts for nothing.
        answers = [
            httpx.get(f"{service.url}/actors", headers={"X-Forwarded-For": f"203.0.113.{last}"})
            for last in range(3)
        ]
    assert [answer.status_code for answer in answers] == [200, 200, 429]


def test_a_problem_that_an_earlier_release_stored_stays_as_it_was() -> None:
    stored = {"type": "about:blank", "code": "overdue"}
    assert problem_under("/tours", stored) == stored


def test_a_job_that_failed_says_why_at_the_path_of_who_asks() -> None:
    with (
        serving(app_of(Broken())) as address,
        httpx.Client(base_url=address, timeout=300) as client,
    ):
        planned = client.post("/front", json=BODY, headers={**TOURS, "Idempotency-Key": "a"})
        problem(planned, 500, "internal-error", "/tours")
        [listed] = client.get("/front").json()["fronts"]
        for headers, root_path in (TOURS, "/tours"), ({}, ""):
            found = client.get(f"/front/{listed['id']}", headers=headers).json()
            assert found["problem"]["type"] == f"{root_path}/guide/errors#internal-error"


def test_a_connection_that_is_refused_knows_the_setting(url: str) -> None:
    with connected(url) as connection:
        connection.sendall(b"nonsense\r\n\r\n")
        status, _, body = received(connection)
    assert (status, json.loads(body)["type"]) == (400, "/set/guide/errors#malformed-http")


def test_a_client_that_is_not_a_trusted_proxy_is_not_believed() -> None:
    limits = ConnectionLimits(proxies="192.0.2.1")
    with serving(app_of(), warm=False, connections=limits) as address:
        problem(httpx.get(f"{address}/none", headers=TOURS), 404, "no-such-path")


@pytest.mark.parametrize(
    "prefix",
    [
        "tours",
        "//other.example",
        "https://other.example",
        "/tours//",
        "/../tours",
        "/a b",
        "/%2e%2e",
        "/a?b",
        "/a#b",
        "/t\u00f6urs".encode(),
        "/a, /b",
        "/" + "a" * 200,
    ],
)
def test_what_is_not_a_plain_path_is_ignored(url: str, prefix: str | bytes) -> None:
    answer = httpx.get(f"{url}/none", headers=[("X-Forwarded-Prefix", prefix)])
    problem(answer, 404, "no-such-path", "/set")


def test_two_prefixes_are_ignored(url: str) -> None:
    answer = httpx.get(
        f"{url}/none", headers=[("X-Forwarded-Prefix", each) for each in ("/a", "/b")]
    )
    problem(answer, 404, "no-such-path", "/set")
