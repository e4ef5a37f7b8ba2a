"""A real Valhalla with a real extract of OpenStreetMap: central Helsinki."""

import asyncio
from collections.abc import Iterator
from itertools import pairwise

import httpx
import numpy as np
import pytest

from service.errors import OffRoad, RouterUnavailable
from service.roads.client import RoadClient, RoadCosts
from service.roads.great_circle import great_circle_distances, great_circle_matrix
from service.roads.router import RouterSettings
from tests.helpers.helsinki import HARBOUR, Array, any_places, reachable_places
from tests.helpers.valhalla import RunningValhalla, valhalla_service


@pytest.fixture(scope="module")
def stops(valhalla: RunningValhalla) -> Array:
    return asyncio.run(reachable_places(valhalla.url, 60, seed=1))


def _costs(url: str, places: Array, snap: float = 250.0) -> RoadCosts:
    async def ask() -> RoadCosts:
        client = RoadClient(RouterSettings(url=url, snap=snap))
        try:
            return await client.costs(places, [f"order-{i}" for i in range(len(places))])
        finally:
            await client.close()

    return asyncio.run(ask())


def _summary(url: str, *places: Array) -> tuple[float, float]:
    """Return seconds and metres of the route that the engine shows to drivers."""
    locations = [{"lon": lon, "lat": lat} for lon, lat in np.array(places).tolist()]
    answer = httpx.post(f"{url}/route", json={"costing": "auto", "locations": locations})
    summary = answer.json()["trip"]["summary"]
    return summary["time"], 1000 * summary["length"]


def test_the_costs_are_those_of_the_routes_that_drivers_are_shown(
    valhalla: RunningValhalla, stops: Array
) -> None:
    costs = _costs(valhalla.url, stops)
    assert not np.array_equal(costs.metres, costs.metres.T)  # there are one-way streets
    for i, j in np.random.default_rng(5).integers(0, 60, (40, 2)).tolist():
        seconds, metres = _summary(valhalla.url, stops[i], stops[j])
        # Its matrices and routes are of two algorithms, which end elsewhere on a road of a stop.
        assert costs.seconds[i, j] == pytest.approx(seconds, abs=10, rel=0.05)
        assert costs.metres[i, j] == pytest.approx(metres, abs=25, rel=0.05)


def test_no_way_by_road_is_shorter_than_the_great_circle(
    valhalla: RunningValhalla, stops: Array
) -> None:
    costs = _costs(valhalla.url, stops)
    snap = 2 * 100.0  # both ends lie somewhat beside the road
    assert (costs.metres >= great_circle_matrix(stops) - snap).all()


def test_a_time_may_be_asked_for(valhalla: RunningValhalla, stops: Array) -> None:
    """The extract has no traffic: any time has the usual ways, which another algorithm finds."""

    async def ask() -> Array:
        client = RoadClient(RouterSettings(url=valhalla.url))
        try:
            times = ["2026-11-30T07:30", "2026-11-30T12:00"]
            return await client.seconds_at(times, stops, [str(i) for i in range(60)])
        finally:
            await client.close()

    morning, noon = asyncio.run(ask())
    np.testing.assert_array_equal(morning, noon)
    np.testing.assert_allclose(morning, _costs(valhalla.url, stops).seconds, rtol=0.05, atol=10)


def test_a_stop_in_the_harbour_is_named(valhalla: RunningValhalla, stops: Array) -> None:
    places = np.vstack((stops[:7], HARBOUR))
    with pytest.raises(OffRoad, match="'order-7' must lie within 150 m"):
        _costs(valhalla.url, places, snap=150.0)


def test_a_stop_off_the_map_is_named(valhalla: RunningValhalla, stops: Array) -> None:
    places = np.vstack((stops[:7], (25.5, 60.5)))
    with pytest.raises(OffRoad, match="'order-7' must lie within 250 m"):
        _costs(valhalla.url, places)


def test_without_the_stops_that_lack_a_way_there_is_one_between_all(
    valhalla: RunningValhalla,
) -> None:
    assert np.isinf(_costs(valhalla.url, any_places(70)).seconds).any()
    places = asyncio.run(reachable_places(valhalla.url, 70, seed=1))
    assert np.isfinite(_costs(valhalla.url, places).seconds).all()


def test_the_streets_of_a_leg_lead_from_stop_to_stop_and_are_as_long_as_its_costs(
    valhalla: RunningValhalla, stops: Array
) -> None:
    legs = list(pairwise([*range(30), 0]))

    async def ask() -> dict[tuple[int, int], list[tuple[float, float]]]:
        client = RoadClient(RouterSettings(url=valhalla.url))
        try:
            return await client.streets(stops, [str(i) for i in range(60)], legs)
        finally:
            await client.close()

    streets = asyncio.run(ask())
    costs = _costs(valhalla.url, stops)
    for (i, j), line in streets.items():
        places = np.array(line)
        ends = great_circle_distances(places[[0, -1]], stops[[i, j]])
        assert (ends < 250).all()
        length = great_circle_distances(places[:-1], places[1:]).sum()
        assert length == pytest.approx(costs.metres[i, j], rel=0.01, abs=5)


def test_the_line_of_a_tour_goes_along_the_road_by_all_its_stops(
    valhalla: RunningValhalla, stops: Array
) -> None:
    places = np.vstack((stops[:20], stops[3]))  # two stops are at one place
    rng = np.random.default_rng(2)
    routes = np.array([rng.permutation(20) for _ in range(5)])
    fronts = [routes, np.hstack((routes, routes[:, :1])), np.array([[4, 4], [3, 20]])]

    async def ask() -> list[list[Array]]:
        client = RoadClient(RouterSettings(url=valhalla.url))
        try:
            return [await client.lines(places, _ids(21), ways) for ways in fronts]
        finally:
            await client.close()

    opened, closed, alone = asyncio.run(ask())
    for ways, lines in zip(fronts, (opened, closed, alone), strict=True):
        for way, line in zip(ways, lines, strict=True):
            assert (great_circle_distances(line[[0, -1]], places[way[[0, -1]]]) < 250).all()
            for stop in places[way]:
                nearest = great_circle_distances(line, np.tile(stop, (len(line), 1)))
                assert nearest.min() < 250
    for line, whole in zip(opened, closed, strict=True):
        np.testing.assert_array_equal(whole[: len(line)], line)


def _ids(n: int) -> list[str]:
    return [f"order-{i}" for i in range(n)]


@pytest.fixture
def mortal(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningValhalla]:
    with valhalla_service(tmp_path_factory.mktemp("mortal")) as running:
        yield running


def test_an_engine_that_is_gone_is_unavailable_until_it_is_back(
    mortal: RunningValhalla, stops: Array
) -> None:
    before = _costs(mortal.url, stops[:5])
    mortal.end()
    with pytest.raises(RouterUnavailable):
        _costs(mortal.url, stops[:5])
    mortal.begin()
    np.testing.assert_array_equal(_costs(mortal.url, stops[:5]), before)
