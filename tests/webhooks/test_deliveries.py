"""The end of a job is posted to its webhook: signed, once, again after failures, nowhere else."""

import base64
import logging
import time
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import httpx
import pytest

from service.api.app import Edge
from service.api.metrics import Metrics
from service.webhooks import sender
from tests.api.test_metrics import samples
from tests.guide.pages import GUIDE, blocks
from tests.helpers.actors import Broken, Shuffler
from tests.helpers.engines import Clustered, Embedded, engine_of
from tests.helpers.fleet_requests import fleet_request
from tests.helpers.jobs import LATER, LONG, SHORT, ended, id_of, later, until_found
from tests.helpers.serving import app_of, problem, serving
from tests.helpers.webhook_receiver import (
    SECRET,
    Receiver,
    certificate_for,
    receiving,
    webhooks_to,
)

Engine = Embedded | Clustered
PAGE = GUIDE / "be-told-when-a-plan-is-ready.md"
_LOOKS = 0.05  # seconds from one look for deliveries that are due to the next
_SILENCE = 10 * _LOOKS  # within which what is posted once too often has come


@pytest.fixture(autouse=True)
def looked_for_often(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sender, "_POLL", _LOOKS)


@pytest.fixture(scope="module", params=["embedded", "cluster"])
def engine(request: pytest.FixtureRequest) -> Iterator[Engine]:
    with engine_of(request.param, request) as engine:
        yield engine


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with receiving() as receiver:
        yield receiver


def edge_to(receiver: Receiver) -> Edge:
    metrics = Metrics()
    webhooks = webhooks_to(receiver.url, observe=metrics.posted)
    return Edge(metrics=metrics, webhooks=webhooks)


def hook(receiver: Receiver, path: str = "/done?of=us") -> dict[str, str]:
    return {"Webhook-Url": receiver.url + path}


def test_the_end_of_a_job_is_posted_once(engine: Engine, receiver: Receiver) -> None:
    with engine.serve(edge=edge_to(receiver)) as served:
        path = later(served.client, **hook(receiver))
        assert ended(served.client, path)["status"] == "done"
        [event] = receiver.wait()
        assert event["type"] == "front.completed"
        assert event["data"] == {"id": id_of(path), "status": "done", "url": path}
        at = datetime.fromisoformat(event["timestamp"])
        assert abs((datetime.now(UTC) - at).total_seconds()) < 60
        assert served.client.get(event["data"]["url"]).json()["status"] == "done"
        time.sleep(_SILENCE)
    [(headers, _)] = receiver.came
    assert headers["webhook-id"] == f"msg_{id_of(path)}"
    assert receiver.url.endswith(headers["host"])


def test_the_program_of_the_guide_believes_the_service_alone(receiver: Receiver) -> None:
    program: dict[str, Any] = {}
    [block] = [each.text for each in blocks(PAGE) if each.language == "python"]
    exec(block, program)
    with Embedded().serve(edge=edge_to(receiver)) as served:
        later(served.client, **hook(receiver))
        receiver.wait()
    [(headers, body)] = receiver.came
    program["verify"](headers, body, SECRET)
    old = {**headers, "webhook-timestamp": str(int(headers["webhook-timestamp"]) - 1000)}
    other = f"whsec_{base64.b64encode(bytes(32)).decode()}"
    for wrong in ((headers, body + b" ", SECRET), (old, body, SECRET), (headers, body, other)):
        with pytest.raises(ValueError, match=r"too old|not of this secret"):
            program["verify"](*wrong)


def test_every_kind_of_plan_and_every_end_is_posted(engine: Engine, receiver: Receiver) -> None:
    with engine.serve(edge=edge_to(receiver)) as served:
        client = served.client
        fleet = client.post("/fleet", json=fleet_request(), headers={**LATER, **hook(receiver)})
        [planned] = receiver.wait()
        stopped = later(client, LONG, **hook(receiver))
        until_found(client, stopped)
        client.delete(stopped)
        [_, cancelled] = receiver.wait(2)
    assert planned["data"]["url"] == fleet.headers["location"]
    assert (cancelled["type"], cancelled["data"]["status"]) == ("front.cancelled", "cancelled")
    with engine.serve(Broken(), edge=edge_to(receiver)) as served:
        broken = later(served.client, **hook(receiver))
        [*_, failed] = receiver.wait(3)
    assert (failed["type"], failed["data"]["id"]) == ("front.failed", id_of(broken))


def test_a_job_without_a_webhook_is_not_posted(engine: Engine, receiver: Receiver) -> None:
    with engine.serve(edge=edge_to(receiver)) as served:
        ended(served.client, later(served.client))
        time.sleep(_SILENCE)
    assert receiver.came == []


def test_a_repeat_is_posted_with_the_first(engine: Engine, receiver: Receiver) -> None:
    with engine.serve(edge=edge_to(receiver)) as served:
        key = {"Idempotency-Key": "monday", **hook(receiver)}
        first = later(served.client, **key)
        ended(served.client, first)
        assert later(served.client, **key) == first
        time.sleep(_SILENCE)
    assert [event["data"]["id"] for event in receiver.wait()] == [id_of(first)]


def test_what_fails_is_posted_again_with_the_same_id(engine: Engine, receiver: Receiver) -> None:
    receiver.statuses = [500, 302]
    receiver.headers = {"Location": receiver.url + "/elsewhere"}
    with engine.serve(edge=edge_to(receiver)) as served:
        later(served.client, **hook(receiver))
        events = receiver.wait(3)
        time.sleep(_SILENCE)
        counted = samples(str(served.client.base_url).rstrip("/"))
    assert events[0] == events[1] == events[2]
    assert len({headers["webhook-id"] for headers, _ in receiver.came}) == 1
    assert len(receiver.came) == 3
    assert counted["paretour_webhooks_total", "failed"] == 2
    assert counted["paretour_webhooks_total", "delivered"] == 1


@pytest.mark.parametrize(("statuses", "attempts"), [([500] * 9, 3), ([410] * 9, 1)])
def test_a_webhook_that_goes_on_failing_is_given_up(
    engine: Engine, receiver: Receiver, statuses: list[int], attempts: int
) -> None:
    receiver.statuses = statuses
    with engine.serve(edge=edge_to(receiver)) as served:
        later(served.client, **hook(receiver))
        receiver.wait(attempts)
        until_given_up(str(served.client.base_url).rstrip("/"))
        time.sleep(_SILENCE)
    assert len(receiver.came) == attempts


def test_an_end_outlives_the_service(engine: Engine, receiver: Receiver, tmp_path: Path) -> None:
    with engine.serve(edge=Edge(webhooks=webhooks_to(receiver.url, pauses=(2.0,))),
                      folder=tmp_path) as served:  # fmt: skip
        receiver.statuses = [503]
        path = later(served.client, **hook(receiver))
        receiver.wait()
    with engine.serve(edge=edge_to(receiver), folder=tmp_path):
        events = receiver.wait(2)
    assert {event["data"]["id"] for event in events} == {id_of(path)}


def test_a_job_resumed_by_the_next_service_keeps_its_webhook(
    engine: Engine, receiver: Receiver, tmp_path: Path
) -> None:
    gated = Shuffler(tmp_path / "gate")
    gated.close()
    with engine.serve(gated, edge=edge_to(receiver), folder=tmp_path) as served:
        path = later(served.client, **hook(receiver))
        while not gated.started:
            time.sleep(0.01)
    gated.open()
    with engine.serve(gated, edge=edge_to(receiver), folder=tmp_path):
        [event] = receiver.wait()
    assert event["data"]["id"] == id_of(path)


def test_replicas_post_once(
    request: pytest.FixtureRequest, receiver: Receiver, tmp_path: Path
) -> None:
    (tmp_path / "begun").touch()  # so that the second leaves the first one's records
    with (
        engine_of("cluster", request) as cluster,
        cluster.serve(edge=edge_to(receiver)) as served,
        cluster.serve(edge=edge_to(receiver), folder=tmp_path),
    ):
        paths = [later(served.client, **hook(receiver)) for _ in range(5)]
        events = receiver.wait(5)
        time.sleep(_SILENCE)
    assert sorted(event["data"]["id"] for event in events) == sorted(map(id_of, paths))
    assert len(receiver.came) == 5


REFUSED = [
    ("https://elsewhere.example/x", LATER, "webhook-not-allowed"),
    ("http://127.0.0.1:1/x", LATER, "webhook-not-allowed"),
    ("http://localhost/x", LATER, "webhook-not-allowed"),
    ("elsewhere", LATER, "invalid-request"),
    ("", LATER, "invalid-request"),
    ("https://hooks.example.com/" + "x" * 3000, LATER, "invalid-request"),
    ("https://hooks.example.com/x", {}, "invalid-request"),
    ("https://hooks.example.com/x", {"Idempotency-Key": "k"}, "invalid-request"),
]


@pytest.fixture(scope="module")
def allowing() -> Iterator[str]:
    with serving(app_of(edge=Edge(webhooks=webhooks_to("https://hooks.example.com")))) as url:
        yield url


@pytest.mark.parametrize(("target", "headers", "code"), REFUSED)
@pytest.mark.parametrize("path", ["/front", "/coverage", "/fleet", "/front/none/replan"])
def test_a_webhook_that_is_not_allowed_is_refused_before_the_body(
    allowing: str, path: str, target: str, headers: dict[str, str], code: str
) -> None:
    answer = httpx.post(allowing + path, content=b"{", headers={**headers, "Webhook-Url": target})
    document = problem(answer, 422, code)
    assert document["detail"].startswith("Webhook-Url must ")


def test_without_targets_every_webhook_is_refused() -> None:
    with serving(app_of(), warm=False) as url:
        answer = httpx.post(
            f"{url}/front",
            json=SHORT,
            headers={**LATER, "Webhook-Url": "https://hooks.example.com/x"},
        )
        problem(answer, 422, "webhook-not-allowed")


def given_up(
    receiver: Receiver, caplog: pytest.LogCaptureFixture, origin: str, *targets: str
) -> str:
    """Return the log of a service that gives a webhook up which it must not deliver."""
    metrics = Metrics()
    webhooks = webhooks_to(*targets, pauses=(), observe=metrics.posted)
    caplog.set_level(logging.INFO)
    with (
        serving(app_of(edge=Edge(metrics=metrics, webhooks=webhooks))) as url,
        httpx.Client(base_url=url, timeout=300) as client,
    ):
        later(client, **{"Webhook-Url": f"{origin}/token-of-ours"})
        until_given_up(url)
    assert receiver.came == []
    assert "token-of-ours" not in caplog.text
    return caplog.text


def until_given_up(url: str) -> None:
    """Wait until a service counts one webhook that it has given up."""
    while samples(url).get(("paretour_webhooks_total", "given-up")) != 1:
        time.sleep(0.02)


def port_of(receiver: Receiver) -> str:
    return receiver.url.rpartition(":")[2]


@pytest.mark.parametrize("network", ["", "=10.0.0.0/8", "=fd00::/8"])
def test_a_name_whose_address_is_inside_is_not_asked(
    receiver: Receiver, caplog: pytest.LogCaptureFixture, network: str
) -> None:
    origin = f"https://localhost:{port_of(receiver)}"
    assert "an address inside" in given_up(receiver, caplog, origin, origin + network)


LOOPBACK = ("=127.0.0.0/8", "=::1/128")


def test_a_webhook_goes_by_tls_to_the_host_of_the_certificate(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    certificate = certificate_for("localhost", tmp_path)
    monkeypatch.setenv("SSL_CERT_FILE", str(certificate))
    with receiving(certificate) as receiver:
        origin = f"https://localhost:{port_of(receiver)}"
        webhooks = webhooks_to(*(origin + each for each in LOOPBACK))
        with (
            serving(app_of(edge=Edge(webhooks=webhooks))) as url,
            httpx.Client(base_url=url, timeout=300) as client,
        ):
            later(client, **{"Webhook-Url": f"{origin}/x"})
            assert receiver.wait()[0]["type"] == "front.completed"
    [(headers, _)] = receiver.came
    assert headers["host"] == origin.removeprefix("https://")


@pytest.mark.parametrize("trusted", [True, False])
def test_a_wrong_certificate_is_not_trusted(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    trusted: bool,
) -> None:
    certificate = certificate_for("other.example" if trusted else "localhost", tmp_path)
    if trusted:
        monkeypatch.setenv("SSL_CERT_FILE", str(certificate))
    with receiving(certificate) as receiver:
        origin = f"https://localhost:{port_of(receiver)}"
        text = given_up(receiver, caplog, origin, *(origin + each for each in LOOPBACK))
    assert "ConnectError" in text
