"""The costs between stops are those of the engine, whole or refused, whatever the engine does."""

import asyncio
import gzip
import json
import logging
import time
from collections.abc import Callable
from threading import Event
from typing import Any
from urllib.parse import parse_qs

import numpy as np
import pytest
from numpy.typing import NDArray

from service.errors import (
    NoRoad,
    OffRoad,
    Refusal,
    RouterTooSlow,
    RouterUnavailable,
    RouterUnusable,
)
from service.roads.client import RoadClient, RoadCosts
from service.roads.router import RouterSettings
from tests.helpers.fake_router import (
    BEYOND,
    FakeOsrm,
    Reply,
    fake_osrm,
    replying,
    road_costs,
    sleeping,
    without_ways,
)
from tests.helpers.ports import free_port

Array = NDArray[np.float64]


def _locations(n: int, seed: int = 1) -> Array:
    return np.random.default_rng(seed).uniform((24.0, 60.0), (25.0, 61.0), (n, 2)).round(6)


def _ids(n: int) -> list[str]:
    return [f"order-{i}" for i in range(n)]


def _asked(fake: FakeOsrm, *places: Array, **options: Any) -> list[RoadCosts]:
    """Return the costs between places, asked for one after another by one client."""

    async def ask() -> list[RoadCosts]:
        settings = {"router": "osrm", "profile": "driving", **options}
        client = RoadClient(RouterSettings(url=fake.url, **settings))
        try:
            return [await client.costs(each, _ids(len(each))) for each in places]
        finally:
            await client.close()

    return asyncio.run(ask())


@pytest.mark.parametrize("n", [1, 2, 7, 50, 51, 130])
def test_the_costs_are_those_of_the_engine_whole(n: int) -> None:
    places = _locations(n)
    with fake_osrm() as fake:
        (costs,) = _asked(fake, places)
    expected = road_costs(places, places)
    np.testing.assert_array_equal(costs.seconds, expected[0])
    np.testing.assert_array_equal(costs.metres, expected[1])


def test_an_engine_with_a_lower_limit_is_asked_in_smaller_blocks() -> None:
    places = _locations(25)
    with fake_osrm(most_pairs=100) as fake:
        with pytest.raises(RouterUnusable, match="TooBig"):
            _asked(fake, places)
        (costs,) = _asked(fake, places, pairs=100)
    np.testing.assert_array_equal(costs, road_costs(places, places))


def test_few_questions_are_asked_at_once() -> None:
    with fake_osrm(sleeping(0.01)) as fake:
        _asked(fake, _locations(40), pairs=25)
        assert len(fake.asked) == 1 + 8 * 8
        assert 2 <= fake.most_at_once <= 4


def test_a_repeat_does_not_ask_again() -> None:
    places, others = _locations(10), _locations(10, seed=2)
    with fake_osrm() as fake:
        first, _, repeat = _asked(fake, places, others, places)
        assert len(fake.asked) == 4  # for each of two the nearest roads and a table
        np.testing.assert_array_equal(first, repeat)
        _asked(fake, places, places, cache_bytes=100)
        assert len(fake.asked) == 8


def test_stops_too_far_from_a_road_are_named() -> None:
    places = _locations(120).round(3)  # at the crossings
    places[[3, 117]] += 0.0003  # 33 m north and some 17 m east
    with fake_osrm() as fake:
        _asked(fake, places, snap=60.0)
        with pytest.raises(OffRoad) as refused:
            _asked(fake, places, snap=30.0)
    document = refused.value.document("")
    assert (document["status"], document["code"]) == (422, "off-road")
    assert "'order-3' must lie within 30 m of a road" in document["detail"]
    assert [each["pointer"] for each in document["errors"]] == [
        "/stops/3/location",
        "/stops/117/location",
    ]


def test_where_the_engine_knows_no_way_the_costs_are_infinite() -> None:
    places = _locations(60)
    places[[7, 55], 0] = BEYOND + 1  # an island with two stops
    with fake_osrm() as fake:
        (costs,) = _asked(fake, places)
    expected = road_costs(places, places)
    np.testing.assert_array_equal(costs, np.where(np.isnan(expected), np.inf, expected))


def test_stops_without_any_way_are_named() -> None:
    places = _locations(60)
    places[7, 0] = BEYOND + 1

    forgotten = np.zeros((60, 60), np.bool_)
    forgotten[55] = forgotten[:, 55] = True
    with fake_osrm(without_ways(places, forgotten)) as fake, pytest.raises(NoRoad) as refused:
        _asked(fake, places)
    document = refused.value.document("")
    assert (document["status"], document["code"]) == (422, "no-road")
    assert [each["pointer"] for each in document["errors"]] == ["/stops/7", "/stops/55"]
    assert "from stop 'order-7' to stop 'order-0'" in document["detail"]


def test_where_the_engine_refuses_a_block_for_one_direction_the_pair_is_found() -> None:
    places = _locations(60)
    first, second = (f"{place[0]:.6f},{place[1]:.6f}" for place in places[[3, 44]])

    def refuse_one_way(_: FakeOsrm, path: str) -> Reply | None:
        names = path.partition("?")[0].rpartition("/")[2].split(";")
        query = parse_qs(path.partition("?")[2])
        sources, targets = (
            [names[int(i)] for i in query[each][0].split(";")]
            for each in ("sources", "destinations")
        )
        refused = "distance" in path and first in sources and second in targets
        return (400, b'{"code": "NoTable"}', {}) if refused else None

    with fake_osrm(refuse_one_way) as fake:
        (costs,) = _asked(fake, places)
    expected = road_costs(places, places)
    expected[:, 3, 44] = np.inf
    np.testing.assert_array_equal(costs, expected)


def test_where_the_engine_refuses_a_block_the_stops_are_found() -> None:
    places = _locations(60)
    places[41, 0] = BEYOND + 1

    def refuse_apart(fake: FakeOsrm, path: str) -> Reply | None:
        if "distance" not in path or b"null" not in fake.answer(path)[1]:
            return None
        return 400, b'{"code": "NoTable"}', {}

    with fake_osrm(refuse_apart) as fake, pytest.raises(NoRoad, match="'order-41'"):
        _asked(fake, places)
    assert len(fake.asked) < 250


def test_where_the_engine_finds_no_segment_the_stop_is_found() -> None:
    places = _locations(30)
    lost = f"{places[17][0]:.6f},"

    def no_segment(_: FakeOsrm, path: str) -> Reply | None:
        return (400, b'{"code": "NoSegment"}', {}) if lost in path else None

    with fake_osrm(no_segment) as fake, pytest.raises(OffRoad, match="'order-17'"):
        _asked(fake, places)


WRONG: dict[str, Callable[[FakeOsrm, str], Reply | None]] = {
    "nothing": replying(200),
    "text": replying(200, b"<html>hello</html>"),
    "10 MB": replying(200, b" " * 10_000_000),
    "deep": replying(200, b"[" * 10_000),
    "a list": replying(200, b"[]"),
    "other JSON": replying(200, b'{"code": "Ok"}'),
    "a redirect": replying(302, Location="http://127.0.0.1:1/"),
    "a password wanted": replying(401),
    "an error of its own": replying(500, b"oops"),
    "no such service": replying(404),
    "an unknown refusal": replying(400, b'{"code": "InvalidQuery"}'),
    "no refusal": replying(400, b'{"code": "<script>"}'),
    "compressed": replying(200, gzip.compress(b"[]"), **{"Content-Encoding": "gzip"}),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_wrong_answer_is_a_bad_gateway(what: str) -> None:
    with fake_osrm(WRONG[what]) as fake, pytest.raises(RouterUnusable) as refused:
        _asked(fake, _locations(5))
    assert refused.value.status == 502
    assert len(fake.asked) == 1


def _changing(change: Callable[[dict[str, Any]], object]) -> Callable[[FakeOsrm, str], Reply]:
    """Return a misbehaviour that changes the document of a table of both costs."""

    def misbehave(fake: FakeOsrm, path: str) -> Reply:
        status, body, headers = fake.answer(path)
        document = json.loads(body)
        if "distances" in document:
            change(document)
        return status, json.dumps(document).encode(), headers

    return misbehave


@pytest.mark.parametrize(
    "change",
    [
        lambda table: table["durations"].pop(),
        lambda table: table["distances"][2].pop(),
        lambda table: table["durations"][1].append(1),
        lambda table: table["durations"][1].__setitem__(0, -1),
        lambda table: table["durations"][1].__setitem__(0, float("nan")),
        lambda table: table["durations"][1].__setitem__(0, float("inf")),
        lambda table: table["durations"][1].__setitem__(0, 1e300),
        lambda table: table["durations"][1].__setitem__(0, 10**400),
        lambda table: table["durations"][1].__setitem__(0, "7"),
        lambda table: table["durations"][1].__setitem__(0, True),
        lambda table: table["durations"][1].__setitem__(0, [7]),
        lambda table: table["durations"][1].__setitem__(0, None),
        lambda table: table.pop("distances"),
        lambda table: table.update(code="NoTable"),
        lambda table: table.update(durations={}),
    ],
)
def test_a_table_that_is_none_is_a_bad_gateway(change: Callable[[dict[str, Any]], object]) -> None:
    with fake_osrm(_changing(change)) as fake, pytest.raises(RouterUnusable):
        _asked(fake, _locations(5))


def test_an_engine_that_is_busy_for_a_moment_is_asked_again() -> None:
    places = _locations(5)
    replies = iter([(503, b"", {}), (0, b"", {}), None, (429, b"", {})])
    with fake_osrm(lambda *_: next(replies, None)) as fake:
        (costs,) = _asked(fake, places)
        assert len(fake.asked) == 5
    np.testing.assert_array_equal(costs, road_costs(places, places))


@pytest.mark.parametrize("status", [502, 503, 504, 0])
def test_an_engine_that_stays_busy_is_unavailable(status: int) -> None:
    with fake_osrm(replying(status)) as fake, pytest.raises(RouterUnavailable) as refused:
        _asked(fake, _locations(5))
    assert (refused.value.status, len(fake.asked)) == (503, 3)


def test_an_engine_that_is_dead_is_unavailable_soon() -> None:
    port = free_port()
    with pytest.raises(RouterUnavailable):
        _asked(FakeOsrm(url=f"http://127.0.0.1:{port}"), _locations(5))


@pytest.mark.parametrize("stalls", ["before its answer", "within its answer"])
def test_an_engine_that_is_slow_is_given_up_before_it_answers(stalls: str) -> None:
    gate = Event()

    def misbehave(*_: object) -> Reply | None:
        if stalls == "within its answer":
            return 200, b" ", {"Content-Length": "9"}
        gate.wait(60)
        return None

    with fake_osrm(misbehave) as fake, pytest.raises(RouterTooSlow) as refused:
        _asked(fake, _locations(5), seconds=0.3)
    gate.set()
    assert (refused.value.status, refused.value.limit) == (504, 0.3)


def test_a_caller_who_goes_away_ends_the_questions() -> None:
    async def ask_and_leave(url: str) -> None:
        client = RoadClient(RouterSettings(url=url, router="osrm", profile="driving", pairs=25))
        asking = asyncio.create_task(client.costs(_locations(50), _ids(50)))
        await asyncio.sleep(0.3)
        asking.cancel()
        with pytest.raises(asyncio.CancelledError):
            await asking
        await client.close()

    with fake_osrm(sleeping(0.1)) as fake:
        asyncio.run(ask_and_leave(fake.url))
        asked = len(fake.asked)
        time.sleep(0.3)
        assert len(fake.asked) == asked < 100


def test_nothing_of_the_stops_is_logged(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG)
    places = _locations(5)
    with fake_osrm() as fake:
        _asked(fake, places)
        assert f"{places[2][0]:.6f}" in fake.asked[1]
    assert str(places[2][0])[:7] not in caplog.text


def test_what_is_asked_is_observed() -> None:
    seen: list[tuple[str, float]] = []

    async def ask(url: str) -> None:
        settings = RouterSettings(url=url, router="osrm", profile="driving")
        client = RoadClient(settings, lambda *outcome: seen.append(outcome))
        with pytest.raises(Refusal):
            await client.costs(_locations(5), _ids(5))
        await client.close()

    replies = iter([(503, b"", {}), None])
    with fake_osrm(lambda *_: next(replies, (500, b"", {}))) as fake:
        asyncio.run(ask(fake.url))
    assert [outcome for outcome, _ in seen] == ["unavailable", "answered", "unusable"]
    assert all(seconds > 0 for _, seconds in seen)
