"""Deliveries in central Helsinki by road: time, people passed and side streets; or by several vans.

Times and streets are those of a Valhalla whose tiles are built of OpenStreetMap's data,
(c) OpenStreetMap contributors, under the Open Database License (ODbL).
"""

import asyncio
import re
from collections.abc import Mapping, Sequence
from functools import cache
from itertools import pairwise, permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.errors import NoRoad, OffRoad
from service.roads.client import RoadClient
from service.roads.great_circle import great_circle_distances
from service.roads.reachability import missing_ways
from service.roads.router import Line, RouterSettings
from service.roads.streets import Leg

Array = NDArray[np.float64]
Place = tuple[float, float]  # longitude and latitude
STOPS = 60
SEED = 3
SOUTH_WEST, NORTH_EAST = (24.935, 60.1635), (24.955, 60.175)
# Longitude, latitude, reach in metres, and the people that a driver meets on each metre.
CROWDS = np.array(
    [
        [24.9436, 60.1710, 72.0, 3.0],  # the square before the railway station
        [24.9421, 60.1664, 60.0, 2.2],  # Erottaja, where six streets meet
        [24.9518, 60.1694, 60.0, 1.7],  # Senate Square
        [24.9385, 60.1690, 56.0, 2.0],  # Kamppi
    ]
)
USUAL = 0.004  # people on a metre of any other street
DEGREE = np.array([55_400.0, 111_200.0])  # metres of one to the east and to the north
ALONG = 4.0  # metres from a main street within which a way is on it
VANS = 6
CAPACITY = 24  # parcels
OPENS, CLOSES = 8 * 3600, 12 * 3600  # when the first van may leave, and the last must be back
_SERVICE = 240  # seconds at a customer
_HANDED_OVER = 45  # seconds at a customer of the rush hour, who waits at the door
# Invented: from when on driving takes how many times as long, and how many times as many people
# are in the streets.
_RUSH = [[6 * 3600, 1.0], [7 * 3600, 1.4], [7.5 * 3600, 1.9], [8.5 * 3600, 1.5], [9.5 * 3600, 1.1]]
_ABOUT = [[6 * 3600, 0.3], [7 * 3600, 0.8], [8 * 3600, 1.6], [9 * 3600, 1.0]]
_TIMED = 3  # every third customer has named an hour


def helsinki(router_url: str) -> tuple[dict[str, Any], Mapping[Leg, Line]]:
    """Return the request, and the line of each leg, as the Valhalla at this address tells them."""
    return asyncio.run(_request(router_url))


async def reachable_places(router_url: str, n: int, seed: int) -> Array:
    """Return n places, shape (n, 2), by road in reach of each other.

    They are the first of random ones without those that lack a road, or a way to another.
    """
    rng = np.random.default_rng(seed)
    places = rng.uniform(SOUTH_WEST, NORTH_EAST, (n + n // 4 + 10, 2)).round(5)
    client = RoadClient(RouterSettings(url=router_url, seconds=120.0))
    try:
        while True:
            try:
                costs = await client.costs(places, _ids(len(places)))
                named = {way.blamed for way in missing_ways(np.isinf(costs.seconds))}
            except (NoRoad, OffRoad) as refused:
                pointers = "".join(fault.pointer or "" for fault in refused.errors)
                named = {int(index) for index in re.findall(r"\d+", pointers)}
            if not named:
                return places[:n]
            places = np.delete(places, sorted(named), axis=0)
    finally:
        await client.close()


async def _request(router_url: str) -> tuple[dict[str, Any], Mapping[Leg, Line]]:
    places = await reachable_places(router_url, STOPS, SEED)
    ids = _ids(STOPS)
    client = RoadClient(RouterSettings(url=router_url, seconds=120.0))
    try:
        costs = await client.costs(places, ids)
        streets = await client.streets(places, ids, list(permutations(range(STOPS), 2)))
    finally:
        await client.close()
    located = zip(ids, places.tolist(), strict=True)
    request = {
        "stops": [{"id": id_, "location": place} for id_, place in located],
        "objectives": [
            {"name": "time", "unit": "s", "matrix": costs.seconds.astype(np.int64).tolist()},
            {"name": "people passed", "unit": "people", "matrix": _people(streets).tolist()},
        ],
        "time_limit": 1.0,
        "seed": 1,
    }
    return request, streets


def _ids(n: int) -> list[str]:
    return ["depot", *(f"order-{number}" for number in range(1, n))]


def _people(streets: Mapping[Leg, Line]) -> NDArray[np.int64]:
    """Return how many people are met on the way from each stop to each, shape (n, n)."""
    people = np.zeros((STOPS, STOPS), dtype=np.int64)
    for leg, line in streets.items():
        people[leg] = round(people_along(np.array(line)))
    return people


def people_along(line: Array) -> float:
    """Return how many people are met along a line of places, shape (p, 2)."""
    middles = (line[:-1] + line[1:]) / 2
    people = np.full(len(middles), USUAL)
    for lon, lat, reach, most in CROWDS:
        crowd = np.broadcast_to((lon, lat), middles.shape)
        squared = great_circle_distances(middles, crowd) ** 2
        people += most * np.exp(-squared / (2 * reach**2))
    return float(people @ great_circle_distances(line[:-1], line[1:]))


def three_costs(
    one_van: dict[str, Any], lines: Mapping[Leg, Line], main: Sequence[Array]
) -> dict[str, Any]:
    """Return the request for one van with a third cost: the metres beside the main streets.

    Args:
        one_van: The request under time and people passed.
        lines: The line of each leg.
        main: The lines of the main streets, each of shape (p, 2), longitude and latitude.
    """
    beside = np.zeros((STOPS, STOPS), dtype=np.int64)
    segments = np.concatenate([np.stack((line[:-1], line[1:]), axis=1) for line in main])

    @cache  # most steps are on many legs
    def metres(*step: Place) -> float:
        return metres_beside(np.array(step), segments)

    for leg, line in lines.items():
        beside[leg] = round(sum(metres(*step) for step in pairwise(_places(line))))
    third = {"name": "side streets", "unit": "m", "matrix": beside.tolist()}
    return {**one_van, "objectives": [*one_van["objectives"], third]}


def _places(line: Array) -> list[Place]:
    return [(lon, lat) for lon, lat in line.tolist()]


def metres_beside(line: Array, segments: Array) -> float:
    """Return the metres of a line, shape (p, 2), that are on no segment of others, (k, 2, 2)."""
    middles = (line[:-1] + line[1:]) / 2
    begin, step = segments[:, 0] * DEGREE, (segments[:, 1] - segments[:, 0]) * DEGREE
    off = middles[:, np.newaxis] * DEGREE - begin  # shape (p - 1, k, 2)
    length = np.maximum((step**2).sum(axis=1), 1e-12)
    share = np.clip((off * step).sum(axis=2) / length, 0.0, 1.0)
    nearest = np.hypot(*np.moveaxis(off - share[..., np.newaxis] * step, 2, 0)).min(axis=1)
    return float((nearest > ALONG) @ great_circle_distances(line[:-1], line[1:]))


def rush_hour(one_van: dict[str, Any]) -> dict[str, Any]:
    """Return a request for one van, with times and crowds that change in the morning."""
    depot, *customers = one_van["stops"]
    time, people = one_van["objectives"]
    return {
        "stops": [depot, *({**each, "service": _HANDED_OVER} for each in customers)],
        "objectives": [{**time, "over_the_day": _RUSH}, {**people, "over_the_day": _ABOUT}],
        "departure": {"earliest": 7 * 3600, "latest": 8.5 * 3600},
        "time_limit": 2.0,
        "seed": 1,
    }


def vans(one_van: dict[str, Any]) -> dict[str, Any]:
    """Return the request for several vans at the stops of a request for one; some name an hour."""
    random = np.random.default_rng(6)
    depot, *customers = one_van["stops"]
    seconds = one_van["objectives"][0]["matrix"]
    return {
        "stops": [depot, *(_order(each, at, random) for at, each in enumerate(customers))],
        "vehicles": [
            {
                "id": "van",
                "count": VANS,
                "start": depot["id"],
                "end": depot["id"],
                "capacity": [CAPACITY],
                "shift": [OPENS, CLOSES],
            }
        ],
        "objectives": [
            {"name": "driving", "unit": "s", "matrix": seconds},
            {"name": "longest route", "unit": "s", "matrix": seconds, "over": "max"},
        ],
        "clock": "longest route",
        "time_limit": 3,
    }


def _order(customer: dict[str, Any], number: int, random: np.random.Generator) -> dict[str, Any]:
    """Return a customer with an order of one to three parcels, and maybe an hour."""
    begin = OPENS + 1800 * int(random.integers(1, 5))
    window = {"window": [begin, begin + 3600]} if number % _TIMED == 0 else {}
    parcels = int(random.integers(1, 4))
    return {**customer, "demand": [parcels], "service": _SERVICE, **window}
