"""Answers that are not as the service gives them: one exception with a sentence, or a value."""

import copy
import json
import random
import zlib
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from paretour import Client, Refused, UnexpectedAnswer
from paretour.errors import retry_after

from tests.client.test_robots import REQUEST as ROBOTS
from tests.helpers.answers import FRONT, NAMED, Answers, Connect, events, problem, status
from tests.helpers.fleet_requests import fleet_request
from tests.helpers.sampled import tenth

HOSTILE = (
    *(None, True, False, 0, -1, 1.5, 1e308, 10**400, 2**63, float("nan"), float("inf")),
    *("", "12", "\x1b[31m", "\ud800", "\u202e", [], {}, [[]], [{}], [None], {"id": 1}, "x" * 999),
)
FAULTS = (UnexpectedAnswer, Refused)


def mutated(rng: random.Random, document: Any) -> Any:
    """Return a copy of a document, with up to three of its values changed at any depth."""
    changed = copy.deepcopy(document)
    for _ in range(rng.randint(1, 3)):
        at = changed
        while True:
            keys = [*at] if isinstance(at, dict) else [*range(len(at))]
            if not keys:
                break
            key = rng.choice(keys)
            if isinstance(at[key], dict | list) and rng.random() < 0.7:
                at = at[key]
                continue
            if rng.random() < 0.3:
                del at[key]
            elif isinstance(at, dict) and rng.random() < 0.2:
                at["a-later-member"] = copy.deepcopy(rng.choice(HOSTILE))
            else:
                at[key] = copy.deepcopy(rng.choice(HOSTILE))
            break
    return changed


def answers_of(url: str) -> dict[str, dict[str, Any]]:
    """Return recorded answers, each by the method of a job or client that reads it."""
    grid = {name: ROBOTS[name] for name in ("grid", "cell_size", "places", "paths")}
    with Client(url) as client:
        fleet, robots = client.fleet(**fleet_request()), client.robots(**ROBOTS)  # type: ignore[arg-type]
        coverage = client.coverage(**grid, second_matrix=[[1.0] * 4] * 4, arrivals=True)  # type: ignore[arg-type]
        tour = httpx.get(f"{url}/tour", params={"knee": True, "front": coverage.id}).json()
        actors = httpx.get(f"{url}/actors").json()
    return {
        "front": FRONT,
        "named": NAMED,
        "coverage": dict(coverage.document),
        "fleet": dict(fleet.document),
        "robots": dict(robots.document),
        "tour": tour,
        "actors": actors,
        "submit": {"id": "f", "status": "queued"},
        "failed": FRONT | {"status": "failed", "problem": json.loads(problem(500, "x").content)},
        "geojson": {"type": "FeatureCollection", "features": []},
    }


def read(client: Any, kind: str) -> Any:
    """Read the answer of a kind."""
    match kind:
        case "front" | "named" | "coverage":
            front = client.job("f").front()
            return len(front.tours) and front.choose(balance=0.5)
        case "fleet":
            return client.fleet_job("f").front()
        case "robots":
            return client.robots_job("f").front()
        case "failed":
            return client.job("f").result()
        case "submit":
            return client.submit(coordinates=[[0, 0, 0, 0]])
        case "tour":
            return client.tour(knee=True)
        case "geojson":
            return client.geojson("f")
    return client.actors()


def test_mutated_answers_are_values_or_one_exception(connect: Connect, url: str) -> None:
    rng = random.Random(38)
    for kind, answer in answers_of(url).items():
        ended = [events(status("done"))] * (kind == "failed")
        if kind != "failed":
            later = {**answer, "a-later-member": {"of": [1]}}
            read(connect(transport=Answers(response(later))), kind)
        for _ in range(tenth(200)):
            document = mutated(rng, answer)
            try:
                read(connect(transport=Answers(*ended, response(document))), kind)
            except FAULTS as error:
                assert str(error).isprintable(), error  # noqa: PT017


@pytest.mark.parametrize("member", ["angle", "balance", "lengths", "tour"])
def test_a_wrong_member_of_one_tour_of_many_is_named(
    connect: Connect, url: str, member: str
) -> None:
    answer = copy.deepcopy(answers_of(url)["front"])
    answer["front"][1][member] = "north"
    demand = rf"answer/front/1/{member} must be .*, got 'north'"
    with pytest.raises(UnexpectedAnswer, match=demand):
        read(connect(transport=Answers(response(answer))), "front")


def response(document: Any) -> httpx.Response:
    return httpx.Response(200, content=json.dumps(document).encode(), headers=JSON)


JSON = {"Content-Type": "application/json"}


@pytest.mark.parametrize(
    ("content", "headers", "sentence"),
    [
        (b"<html>", {"Content-Type": "text/html"}, "answer must be JSON, got 'text/html'"),
        (b"<html>", JSON, "answer must be JSON"),
        (b'{"actors": [}', JSON, "answer must be JSON"),
        (b'{"actors": "\xe9"}', {"Content-Type": "application/json; charset=latin-1"}, "JSON"),
        (b'{"actors": [], "actors": []}', JSON, "an object names a member twice"),
        (b'{"actors": [], "x": 1e999}', JSON, "a number is not finite"),
        (b'{"actors": [], "x": NaN}', JSON, "a number is not finite"),
        (b'{"actors": ' + b"[" * 100_000, JSON, "answer must be JSON"),
        (b"[]", JSON, "answer must be an object, got "),
        (b"{}", JSON, "answer must have a member actors, got none"),
        (b'{"actors": [1]}', JSON, "answer/actors/0 must be an object, got 1"),
        (b"", JSON, "answer must be JSON"),
    ],
)
def test_the_sentence_says_what_was_expected_and_what_came(
    connect: Connect, content: bytes, headers: dict[str, str], sentence: str
) -> None:
    with pytest.raises(UnexpectedAnswer, match=sentence):
        connect(transport=Answers(httpx.Response(200, content=content, headers=headers))).actors()


@pytest.mark.parametrize("event", ["progress", "status"])
@pytest.mark.parametrize("data", [{}, {"seconds": "1"}, {"status": 3}])
def test_a_wrong_event_is_named(connect: Connect, event: str, data: dict[str, Any]) -> None:
    with pytest.raises(UnexpectedAnswer, match=event):
        list(connect(transport=Answers(events((event, data)))).job("f").progress())


def test_new_events_and_new_members_of_events_are_left_alone(connect: Connect) -> None:
    report = {"seconds": 0.1, "hypervolume": 0.5, "points": 3, "colour": "red"}
    stream = events(("weather", {"rain": 1}), ("progress", report), status("done"))
    [progress] = connect(transport=Answers(stream)).job("f").progress()
    assert progress.points == 3


def test_an_unknown_end_of_a_search_is_told_as_it_came(connect: Connect) -> None:
    service = Answers(response(FRONT | {"terminated": "boredom"}))
    assert connect(transport=service).job("f").front().terminated == "boredom"


def test_a_redirect_is_refused_with_its_target(connect: Connect) -> None:
    moved = httpx.Response(302, headers={"Location": "https://elsewhere"})
    with pytest.raises(Refused, match=r"302 Found, to https://elsewhere"):
        connect(transport=Answers(moved)).actors()


@pytest.mark.parametrize(
    "header", ["Wed, 21 Oct 2015 07:28:00", "Wed, 21 Oct 2015 07:28:00 -0000", "9" * 400, "(", ""]
)
def test_any_retry_after_is_a_bounded_pause(header: str) -> None:
    assert 0.1 <= retry_after(problem(503, "busy", **{"Retry-After": header})) <= 86400


def bomb() -> Iterator[bytes]:
    """A gigabyte of zeros as a megabyte of gzip."""
    packed = zlib.compressobj(9, zlib.DEFLATED, 16 + zlib.MAX_WBITS)
    for _ in range(1024):
        yield packed.compress(bytes(2**20))


@pytest.mark.parametrize("encoding", ["gzip", "br", "gzip, gzip"])
def test_a_long_answer_is_broken_off(encoding: str) -> None:
    def answer(_: httpx.Request) -> httpx.Response:
        return httpx.Response(200, content=bomb(), headers=JSON | {"Content-Encoding": encoding})

    with (
        Client("http://service", transport=httpx.MockTransport(answer), most_bytes=2**22) as client,
        pytest.raises(
            UnexpectedAnswer, match=r"at most 4194304 bytes|Content-Encoding must be gzip"
        ),
    ):
        client.actors()


def test_an_event_without_end_is_broken_off() -> None:
    def endless() -> Iterator[bytes]:
        while True:
            yield b"data: " + b"x" * 2**16

    def answer(_: httpx.Request) -> httpx.Response:
        return httpx.Response(200, content=endless(), headers={"Content-Type": "text/event-stream"})

    with (
        Client("http://service", transport=httpx.MockTransport(answer)) as client,
        pytest.raises(UnexpectedAnswer, match="at most 262144 characters"),
    ):
        list(client.job("f").progress())
