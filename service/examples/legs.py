"""The ways along the streets between the stops of the examples in Helsinki, which the page draws.

Lines are those of a Valhalla whose tiles are built of OpenStreetMap's data, (c) OpenStreetMap
contributors, under the Open Database License (ODbL).
"""

import asyncio
from collections.abc import Iterable, Mapping
from itertools import pairwise, permutations
from typing import Any

import numpy as np

from service.examples.streets import CREDIT, ORIGIN, STEP
from service.roads.client import RoadClient
from service.roads.router import Array, Line, RouterSettings
from service.roads.trails import Leg

Place = tuple[int, int]  # steps east and north of the origin
Way = list[int]  # nodes; the first and the last are stops


def legs(router_url: str, stops: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the ways between all stops that the Valhalla at this address tells.

    Members: `nodes`, places in steps from the origin, those of the stops first; `next`, for each
    node those to which ways lead from it; `legs`, for each stop the ways to all of them, each as
    digits: at a node that leads to several, the next digit says to which.
    """
    places = np.array([stop["location"] for stop in stops])
    lines = asyncio.run(_lines(router_url, places, [stop["id"] for stop in stops]))
    nodes, ways = _ways(lines, _steps(places))
    ahead = _ahead(ways.values(), len(nodes))
    pairs = [[ways.get((i, j), []) for j in range(len(stops))] for i in range(len(stops))]
    return {
        "credit": CREDIT,
        "origin": list(ORIGIN),
        "step": STEP,
        "nodes": [list(place) for place in nodes],
        "next": ahead,
        "legs": [[_digits(way, ahead) for way in row] for row in pairs],
    }


async def _lines(router_url: str, places: Array, ids: list[str]) -> Mapping[Leg, Line]:
    client = RoadClient(RouterSettings(url=router_url, seconds=120.0))
    try:
        return await client.streets(places, ids, list(permutations(range(len(ids)), 2)))
    finally:
        await client.close()


def _steps(places: Array) -> list[Place]:
    """Return places of longitude and latitude, shape (m, 2), in steps from the origin."""
    return [(x, y) for x, y in ((places - ORIGIN) / STEP).round().astype(int).tolist()]


def _ways(lines: Mapping[Leg, Line], stops: list[Place]) -> tuple[list[Place], dict[Leg, Way]]:
    """Return the places of all nodes, and the nodes of each way, from its stop to the other."""
    numbers: dict[Place, int] = {}

    def number(place: Place) -> int:
        return len(stops) + numbers.setdefault(place, len(numbers))

    ways = {}
    for (i, j), line in sorted(lines.items(), key=lambda item: item[0]):
        along = [number(place) for place in _steps(line)]
        moves = [node for node, after in pairwise([*along, j]) if node != after]
        ways[i, j] = [i, *moves, j]
    return [*stops, *numbers], ways


def _ahead(ways: Iterable[Way], nodes: int) -> list[list[int]]:
    """Return the nodes to which ways lead from each node."""
    found: list[set[int]] = [set() for _ in range(nodes)]
    for way in ways:
        for node, after in pairwise(way):
            found[node].add(after)
    return [sorted(each) for each in found]


def _digits(way: Way, ahead: list[list[int]]) -> str:
    """Return which way is taken at each node that leads to several."""
    choices = [ahead[node].index(after) for node, after in pairwise(way) if len(ahead[node]) > 1]
    return "".join(map(str, choices))
