"""The streets of tours are those of the engine, leg by leg."""

import asyncio
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from service.errors import NoRoad, RouterUnusable
from service.roads.client import RoadClient
from service.roads.router import Line, RouterSettings
from service.roads.trails import Leg
from tests.helpers.fake_router import BEYOND, FakeOsrm, fake_osrm, replying, snapped

Array = NDArray[np.float64]


def _streets(fake: FakeOsrm, places: Array, legs: list[Leg]) -> dict[Leg, Line]:
    async def ask() -> dict[Leg, Line]:
        client = RoadClient(RouterSettings(url=fake.url, router="osrm", profile="driving"))
        try:
            return await client.streets(places, [f"order-{i}" for i in range(len(places))], legs)
        finally:
            await client.close()

    return asyncio.run(ask())


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
        expected = [corners[i], (corners[j][0], corners[i][1]), corners[j]]
        np.testing.assert_allclose(line[:3], expected, atol=1e-6)


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
