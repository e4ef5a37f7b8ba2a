"""Fleets on the streets of Helsinki: the example of six vans, and more vans for more orders.

Every third customer has named an hour: no visit begins before it, and one after it is late. Places
and times are those of the Valhalla that the tests use.
"""

import asyncio
import json
import tempfile
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.objectives import OBJECTIVES
from service.roads.client import RoadClient
from service.roads.router import RouterSettings
from tests.benchmarks.fleet_instances import FleetInstance, fleet_of
from tests.benchmarks.provenance import ROOT
from tests.examples.helsinki import CLOSES, VANS, Array, reachable_places, vans
from tests.helpers.valhalla import valhalla_service

EXAMPLE = 59  # orders
_FILE = ROOT / "service/examples/helsinki-vans.json"
_SEED = 4
_SPARE = 20  # places of which each instance leaves out some
_SECONDS = 120.0  # for the matrices


class Streets(NamedTuple):
    """Places, and the seconds from each to each by road, shapes (n, 2) and (n, n)."""

    places: Array
    seconds: NDArray[np.int64]


def street_fleets(orders: int, objectives: int, instances: int) -> list[FleetInstance]:
    """Return fleets for so many orders, under driving, lateness, and of three the longest route.

    Of 59 orders there is one: the example's.
    """
    if orders == EXAMPLE:
        requests = [json.loads(_FILE.read_bytes())]
    else:
        requests = [_by_road(orders, seed) for seed in range(instances)]
    return [
        FleetInstance(f"{orders}/{seed}", changed, fleet_of(changed))
        for seed, changed in enumerate(_may_be_late(each, objectives) for each in requests)
    ]


def _may_be_late(request: dict[str, Any], objectives: int) -> dict[str, Any]:
    """Return a request in which an hour that a customer named ends with being late."""
    driving, longest = request["objectives"]
    late = {"name": "lateness", "measure": "lateness"}
    stops = [_due(stop) if "window" in stop else stop for stop in request["stops"]]
    if objectives > OBJECTIVES:
        return {**request, "stops": stops, "objectives": [driving, late, longest]}
    clock = {"name": "time", "matrix": driving["matrix"]}
    return {**request, "stops": stops, "objectives": [driving, late], "clock": clock}


def _due(stop: dict[str, Any]) -> dict[str, Any]:
    begins, ends = stop["window"]
    return {**stop, "window": [begins, CLOSES], "due": ends}


def _by_road(orders: int, seed: int) -> dict[str, Any]:
    """Return a request of the example's recipe for more orders, with as many vans for each."""
    places, seconds = _streets(orders + 1 + _SPARE)
    chosen = np.random.default_rng([_SEED, seed]).permutation(len(places))[: orders + 1]
    stops = [{"id": str(at), "location": place} for at, place in enumerate(places[chosen].tolist())]
    matrix = seconds[np.ix_(chosen, chosen)].tolist()
    request = vans({"stops": stops, "objectives": [{"matrix": matrix}]})
    (van,) = request["vehicles"]
    return {**request, "vehicles": [{**van, "count": round(VANS * orders / EXAMPLE)}]}


@cache
def _streets(n: int) -> Streets:
    with tempfile.TemporaryDirectory() as folder, valhalla_service(Path(folder)) as engine:
        return asyncio.run(_asked(engine.url, n))


async def _asked(url: str, n: int) -> Streets:
    places = await reachable_places(url, n, _SEED)
    client = RoadClient(RouterSettings(url=url, seconds=_SECONDS))
    try:
        costs = await client.costs(places, [str(number) for number in range(n)])
    finally:
        await client.close()
    return Streets(places, np.rint(costs.seconds).astype(np.int64))
