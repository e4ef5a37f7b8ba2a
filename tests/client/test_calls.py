"""Calls, made by both clients against prepared answers."""

import time
from collections.abc import Callable
from typing import Any

import httpx
import numpy as np
import pytest
from paretour import Refused
from paretour.calls import Calls

from tests.client.test_robots import REQUEST as ROBOTS
from tests.helpers.answers import (
    EMPTY,
    Answers,
    Connect,
    events,
    front,
    problem,
    progress,
    status,
)
from tests.helpers.fleet_requests import fleet_request

CITIES = np.random.default_rng(3).random((12, 4))


def test_an_api_key_is_shown_with_every_request(connect: Connect) -> None:
    service = Answers(front(), front())
    client = connect(api_key="secret", transport=service)
    client.front(coordinates=CITIES)
    client.job("f").front()
    assert [asked.headers["authorization"] for asked in service.requests] == ["Bearer secret"] * 2


@pytest.mark.parametrize(
    ("request_", "seconds"),
    [({}, 31), ({"time_limit": 60}, 90), ({"time_limit": 2, "bound": True}, 37)],
)
def test_it_waits_for_as_long_as_the_search_may_take(
    connect: Connect, request_: dict[str, Any], seconds: float
) -> None:
    service = Answers(front())
    connect(transport=service).front(coordinates=CITIES, **request_)
    assert service.requests[0].extensions["timeout"]["read"] == seconds


@pytest.mark.parametrize(("code", "kind"), [(503, "queue-full"), (429, "rate-limited")])
def test_it_asks_again_when_the_service_says_later(connect: Connect, code: int, kind: str) -> None:
    service = Answers(problem(code, kind, **{"Retry-After": "1"}), front())
    began = time.monotonic()
    assert connect(transport=service).front(coordinates=CITIES).id == "f"
    assert time.monotonic() - began >= 1
    assert service.requests[0].content == service.requests[1].content


def test_its_patience_ends(connect: Connect) -> None:
    service = Answers(*[problem(503, "queue-full", **{"Retry-After": "0"})] * 9)
    with pytest.raises(Refused) as refused:
        connect(transport=service, patience=0.45).front(coordinates=CITIES)
    assert refused.value.code == "queue-full"
    assert len(service.requests) == 5


def test_what_is_refused_for_good_is_not_asked_again(connect: Connect) -> None:
    service = Answers(problem(422, "invalid-request", **{"Retry-After": "1"}))
    with pytest.raises(Refused):
        connect(transport=service).front(coordinates=CITIES)
    assert len(service.requests) == 1


def test_pauses_are_those_that_the_service_asks_for() -> None:
    call = Calls(timeout=30, patience=60).actors()
    assert next(call).delay == 0
    assert call.send(problem(503, "busy", **{"Retry-After": "7"})).delay == 7
    assert call.send(problem(503, "busy", **{"Retry-After": "50"})).delay == 50
    with pytest.raises(Refused):
        call.send(problem(503, "busy", **{"Retry-After": "4"}))


def test_what_a_later_service_says_of_an_actor_is_left_out() -> None:
    facts = dict.fromkeys(("name", "digest", "inputs", "commit", "sizes", "angles"), "")
    facts |= {"config": "", "figures": ""}
    earlier, later = facts, {**facts, "repairs": True, "colour": "red"}
    call = Calls(timeout=30, patience=60).actors()
    next(call)
    with pytest.raises(StopIteration) as ended:
        call.send(httpx.Response(200, json={"actors": [earlier, later]}))
    assert [actor.repairs for actor in ended.value.value] == [False, True]


def test_a_job_is_submitted_followed_and_fetched(connect: Connect) -> None:
    accepted = httpx.Response(202, json={"id": "f", "status": "queued"})
    service = Answers(
        accepted,
        events(status("queued"), status("running"), progress(0.3), progress(0.4), status("done")),
        events(status("done")),
        front(),
    )
    job = connect(transport=service).submit(coordinates=CITIES, time_limit=20)
    assert job.id == "f"
    assert [item.hypervolume for item in job.progress()] == [0.3, 0.4]
    assert job.result().status == "done"
    post, first, _, last = service.requests
    assert post.headers["prefer"] == "respond-async"
    assert post.extensions["timeout"]["read"] == 30
    assert (first.url.path, last.url.path) == ("/front/f/events", "/front/f")


def test_a_job_has_a_best_front_so_far_even_an_empty_one(connect: Connect) -> None:
    job = connect(transport=Answers(httpx.Response(200, json=EMPTY))).job("f")
    found = job.front()
    assert (found.status, found.tours.shape, found.lengths.shape) == ("running", (0, 3), (0, 2))


def test_a_job_that_failed_raises_its_problem(connect: Connect) -> None:
    why = {"status": 500, "code": "internal-error", "detail": "a fault", "request_id": "r"}
    service = Answers(events(status("failed")), front(status="failed", problem=why))
    with pytest.raises(Refused) as refused:
        connect(transport=service).job("f").result()
    assert refused.value.code == "internal-error"


def test_a_job_that_is_cancelled_keeps_what_it_has_found(connect: Connect) -> None:
    service = Answers(httpx.Response(200, json=EMPTY), front(status="cancelled"))
    assert connect(transport=service).job("f").cancel().status == "cancelled"
    assert [asked.method for asked in service.requests] == ["GET", "DELETE"]


def test_cancelling_does_not_forget_a_job_that_has_ended(connect: Connect) -> None:
    service = Answers(front())
    assert connect(transport=service).job("f").cancel().status == "done"
    assert [asked.method for asked in service.requests] == ["GET"]


def test_cancelling_keeps_the_front_of_a_job_that_ends_meanwhile(connect: Connect) -> None:
    service = Answers(front(status="running"), httpx.Response(204))
    assert len(connect(transport=service).job("f").cancel().tours) == 2


def test_a_front_can_be_forgotten(connect: Connect) -> None:
    service = Answers(httpx.Response(204))
    connect(transport=service).job("f").forget()
    assert (service.requests[0].method, service.requests[0].url.path) == ("DELETE", "/front/f")


def listed(id_: str) -> dict[str, Any]:
    return {
        **{"id": id_, "status": "done", "kind": "front", "cities": 3, "points": 2},
        **{"stored_at": "2026-03-02T09:30:12Z", "hypervolume": 0.5},
    }


def test_a_list_is_read_page_by_page_until_there_are_enough() -> None:
    call = Calls(timeout=1, patience=1).fronts(most=3)
    first = next(call)
    assert (first.path, first.content["params"]) == ("/front", {"limit": 3})
    link = {"Link": '</behind/a/proxy/front?limit=3&after=17>; rel="next"'}
    page = {"fronts": [listed("c"), listed("b")]}
    second = call.send(httpx.Response(200, json=page, headers=link))
    assert second.content["params"] == {"limit": 1, "after": "17"}
    with pytest.raises(StopIteration) as ended:
        call.send(httpx.Response(200, json={"fronts": [listed("a")]}, headers=link))
    assert [each.id for each in ended.value.value] == ["c", "b", "a"]


def test_every_job_may_name_a_webhook(connect: Connect) -> None:
    hook = "https://hooks.example.com/done"
    robots: Any = {**ROBOTS}
    grid: Any = {name: ROBOTS[name] for name in ("grid", "cell_size", "places")}
    fleet: Any = fleet_request()
    submits: list[Callable[[Any, str | None], Any]] = [
        lambda client, webhook: client.submit(coordinates=CITIES, webhook=webhook),
        lambda client, webhook: client.submit_coverage(**grid, webhook=webhook),
        lambda client, webhook: client.submit_fleet(**fleet, webhook=webhook),
        lambda client, webhook: client.submit_robots(**robots, webhook=webhook),
        lambda client, webhook: client.submit_replan("f", done=[1], webhook=webhook),
        lambda client, webhook: client.submit_replan_fleet("f", done=[["a"]], webhook=webhook),
    ]
    for submit in submits:
        accepted = httpx.Response(202, json={"id": "f", "status": "queued"})
        service = Answers(accepted, accepted)
        client = connect(transport=service)
        assert submit(client, hook).id == submit(client, None).id == "f"
        named, unnamed = (request.headers for request in service.requests)
        assert named["webhook-url"] == hook
        assert "webhook-url" not in unnamed
        assert named["prefer"] == unnamed["prefer"] == "respond-async"
