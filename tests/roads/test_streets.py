"""The streets of tours are those of the engine, leg by leg, and asked for once."""

import asyncio
import json
import time
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from service.errors import NoRoad, OffRoad, RouterTooSlow, RouterUnusable, StreetsTooLong
from service.roads.client import RoadClient
from service.roads.router import Line, RouterSettings
from service.roads.streets import Leg
from tests.helpers.fake_router import (
    BEYOND,
    FakeOsrm,
    Misbehaviour,
    Reply,
    encode_polyline,
    fake_osrm,
    replying,
    sleeping,
    snapped,
)

Array = NDArray[Any]


def _settings(fake: FakeOsrm, **options: Any) -> RouterSettings:
    return RouterSettings(url=fake.url, router="osrm", profile="driving", **options)


def _ids(places: Array) -> list[str]:
    return [f"order-{i}" for i in range(len(places))]


def _streets(fake: FakeOsrm, places: Array, legs: list[Leg]) -> dict[Leg, Line]:
    async def ask() -> dict[Leg, Line]:
        client = RoadClient(_settings(fake))
        try:
            return await client.streets(places, _ids(places), legs)
        finally:
            await client.close()

    return asyncio.run(ask())


def _drawn(
    fake: FakeOsrm, places: Array, *fronts: Array, seconds: float = 20.0, **options: Any
) -> list[list[Line]]:
    """Return the lines of tours of fronts, asked for one after another by one client."""

    async def ask() -> list[list[Line]]:
        client = RoadClient(_settings(fake, **options))
        try:
            return [await client.lines(places, _ids(places), ways, seconds) for ways in fronts]
        finally:
            await client.close()

    return asyncio.run(ask())


def _legs(path: str) -> int:
    """Return how many legs a question is about."""
    return path.count(";") if path.startswith("/route/") else 0


def _ways(n: int, k: int, seed: int = 5) -> Array:
    """Return k closed tours of n stops."""
    rng = np.random.default_rng(seed)
    tours = np.array([rng.permutation(n) for _ in range(k)])
    return np.hstack((tours, tours[:, :1]))


def _places(n: int) -> Array:
    return np.random.default_rng(3).uniform((24.0, 60.0), (25.0, 61.0), (n, 2)).round(6)


def test_each_leg_goes_round_one_corner() -> None:
    places = _places(120)
    rng = np.random.default_rng(4)
    legs = [leg for _ in range(3) for leg in pairwise(rng.permutation(120).tolist())]
    with fake_osrm() as fake:
        streets = _streets(fake, places, legs)
        assert len(fake.asked) < len(legs) / 10
    assert set(streets) == set(legs)
    corners = snapped(places)
    for (i, j), line in streets.items():
        turn = (corners[j][0], corners[i][1])
        expected = [corners[i], turn, turn, corners[j], corners[j], corners[j]]
        np.testing.assert_allclose(line, expected, atol=1e-6)


def test_the_streets_of_a_profile_are_asked_for_by_it() -> None:
    places, way = _places(9), np.arange(9)

    async def ask(fake: FakeOsrm) -> list[Line]:
        client = RoadClient(_settings(fake, profiles={"lorry": "truck"}))
        try:
            for _ in range(2):
                found = await client.lines(places, _ids(places), [way] * 2, 20, ["lorry", None])
            return found
        finally:
            await client.close()

    with fake_osrm() as fake:
        one, other = asyncio.run(ask(fake))
        asked = [path.split("/")[3] for path in fake.asked if path.startswith("/route/")]
    assert asked == ["truck", "driving"]
    np.testing.assert_array_equal(one, other)


def test_a_leg_without_a_way_is_named() -> None:
    places = _places(30)
    places[17, 0] = BEYOND + 1
    with fake_osrm() as fake, pytest.raises(NoRoad, match="'order-16' to stop 'order-17'"):
        _streets(fake, places, list(pairwise(range(30))))


@pytest.mark.parametrize(
    "body",
    [
        b'{"code": "Ok", "routes": []}',
        b'{"code": "Ok", "routes": [{"legs": []}]}',
        b'{"code": "Ok", "routes": [{"legs": [{"steps": [{"geometry": "~~~~~~~~~~~~~~"}]}]}]}',
        b'{"code": "Ok", "routes": [{"legs": [{"steps": [{"geometry": 7}]}]}]}',
        b" " * 10_000_000,
    ],
)
def test_a_wrong_route_is_a_bad_gateway(body: bytes) -> None:
    with fake_osrm(replying(200, body)) as fake, pytest.raises(RouterUnusable):
        _streets(fake, _places(2), [(0, 1)])


def test_a_line_goes_from_stop_to_stop_and_takes_no_step_of_no_length() -> None:
    places, ways = _places(30), _ways(30, 4)
    with fake_osrm() as fake:
        [lines] = _drawn(fake, places, ways)
    corners = snapped(places)
    for way, line in zip(ways, lines, strict=True):
        stops = corners[way]
        turns = np.column_stack((stops[1:, 0], stops[:-1, 1]))
        expected = np.vstack((stops[:1], np.stack((turns, stops[1:]), axis=1).reshape(-1, 2)))
        moves = (expected[1:] != expected[:-1]).any(axis=1)
        np.testing.assert_allclose(line, expected[np.append(True, moves)], atol=1e-6)


def test_one_stop_is_a_line_of_two_positions() -> None:
    with fake_osrm() as fake:
        [[line]] = _drawn(fake, _places(1), np.array([[0, 0]]))
    np.testing.assert_allclose(line, snapped(_places(1)).repeat(2, axis=0), atol=1e-6)


def test_a_leg_that_is_known_is_not_asked_for_again() -> None:
    places, ways = _places(20), _ways(20, 6)
    with fake_osrm() as fake:
        together, one, again = _drawn(fake, places, ways, ways[2:3], ways)
        asked = len(fake.asked)
        np.testing.assert_array_equal(one[0], together[2])
        assert all(map(np.array_equal, together, again))
        _drawn(fake, places, ways, ways, cache_bytes=0)
        assert len(fake.asked) == 3 * asked
    # Nor are legs that several tours have.
    legs = {leg for way in ways.tolist() for leg in pairwise(way)}
    assert sum(_legs(path) for path in fake.asked[:asked]) == len(legs) < ways[:, 1:].size


def test_more_legs_or_positions_than_an_answer_may_have_are_refused() -> None:
    places, ways = _places(20), _ways(20, 6)
    legs = {leg for way in ways.tolist() for leg in pairwise(way)}
    with fake_osrm() as fake:
        with pytest.raises(StreetsTooLong, match=f"at most {len(legs) - 1} different legs"):
            _drawn(fake, places, ways, legs=len(legs) - 1)
        assert fake.asked == []
        most = 6 * 6 * 20  # the fake has six positions a leg
        _drawn(fake, places, ways, legs=len(legs), positions=most)
        with pytest.raises(StreetsTooLong, match=f"at most {most - 1} positions"):
            _drawn(fake, places, ways, positions=most - 1)


def test_what_an_engine_told_before_it_died_is_not_asked_for_again() -> None:
    places, ways = _places(60), _ways(60, 1)

    def die(fake: FakeOsrm, _: str) -> Reply | None:
        if len(fake.asked) < 3:
            return None
        time.sleep(0.2)  # so that the route before has come
        return 500, b"", {}

    async def ask(fake: FakeOsrm) -> None:
        client = RoadClient(_settings(fake))
        with pytest.raises(RouterUnusable, match="its status is 500"):
            await client.lines(places, _ids(places), ways)
        told, fake.misbehave = fake.asked.copy(), lambda *_: None
        await client.lines(places, _ids(places), ways)
        await client.close()
        assert sum(map(_legs, fake.asked[len(told) :])) == 60 - _legs(told[1])

    with fake_osrm(die) as fake:
        asyncio.run(ask(fake))


def test_a_stop_too_far_from_a_road_is_named() -> None:
    places = _places(9).round(3)  # at the crossings
    places[4] += 0.0004
    with fake_osrm() as fake, pytest.raises(OffRoad, match="'order-4' must lie within 20 m"):
        _drawn(fake, places, _ways(9, 2), snap=20.0)


def test_the_time_that_is_left_is_kept() -> None:
    with fake_osrm(sleeping(0.2)) as fake, pytest.raises(RouterTooSlow, match=r"within 0\.1 s"):
        _drawn(fake, _places(9), _ways(9, 1), seconds=0.1)


def _elsewhere(_: FakeOsrm, path: str) -> Reply | None:
    """Answer with the streets of places that nobody asked about."""
    if "/route/" not in path:
        return None
    line = encode_polyline([(2.35, 48.85), (2.36, 48.86)])
    legs = [{"steps": [{"geometry": line}]}] * path.count(";")
    return 200, json.dumps({"code": "Ok", "routes": [{"legs": legs}]}).encode(), {}


def _nowhere(_: FakeOsrm, path: str) -> Reply | None:
    if "/route/" not in path:
        return None
    legs = [{"steps": []}] * path.count(";")
    return 200, json.dumps({"code": "Ok", "routes": [{"legs": legs}]}).encode(), {}


@pytest.mark.parametrize("misbehave", [_elsewhere, _nowhere])
def test_lines_that_do_not_lead_from_stop_to_stop_are_a_bad_gateway(
    misbehave: Misbehaviour,
) -> None:
    with fake_osrm(misbehave) as fake, pytest.raises(RouterUnusable, match="a line must"):
        _drawn(fake, _places(7), _ways(7, 1))
