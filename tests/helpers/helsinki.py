"""Stops in central Helsinki, all within reach of each other by road."""

import re

import numpy as np
from numpy.typing import NDArray

from service.errors import NoRoad, OffRoad
from service.roads.client import RoadClient
from service.roads.router import RouterSettings

Array = NDArray[np.float64]
WEST_SOUTH, EAST_NORTH = (24.935, 60.1635), (24.955, 60.175)
HARBOUR = (24.9606, 60.1652)  # on the water


def any_places(n: int, seed: int = 1) -> Array:
    """Return longitude and latitude of places anywhere in the centre, shape (n, 2)."""
    return np.random.default_rng(seed).uniform(WEST_SOUTH, EAST_NORTH, (n, 2)).round(6)


async def reachable_places(url: str, n: int, seed: int = 1) -> Array:
    """Return places, shape (n, 2), without those that the client's refusals name."""
    client = RoadClient(RouterSettings(url=url, seconds=120.0))
    places = any_places(n + n // 4 + 10, seed)
    try:
        while True:
            try:
                await client.costs(places, [str(i) for i in range(len(places))])
            except (NoRoad, OffRoad) as refused:
                named = {
                    int(re.findall(r"\d+", fault.pointer or "")[0]) for fault in refused.errors
                }
                places = np.delete(places, list(named), axis=0)
            else:
                assert len(places) >= n
                return places[:n]
    finally:
        await client.close()
