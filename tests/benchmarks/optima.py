"""`python -m tests.benchmarks optima --data FOLDER`: tours over the day beside known optima.

The folder is a checkout of gleraromero/tdtsptw (GitHub, MIT): the time-dependent instances of Adamo
et al. (2019), whose legs have one of three speeds in each of 73 zones of the day, and a sheet of
their least durations from Lera-Romero, Miranda Bront and Soulignac (2020), two decimals each. Some
of these are only the best that was known: tours here take up to 40 % less.

A service with one worker on one core is asked over HTTP for tours that leave at midnight, under
duration and distance. The zones are `slices`, in seconds. Each tour of least duration is driven
again by code of this module. Instances are spread evenly over those with a known value. Stores
`results/optima.json`.
"""

import argparse
import json
import time
import zipfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import httpx
import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.optima_table import LIMITS, optima_table
from tests.benchmarks.rows import resume
from tests.helpers.processes import serve_process

Array = NDArray[np.float64]

INSTANCES = "instances/adamo_et_al_2019"
SHEET = "tdtsptw-optima.ods"
COUNT = 25
MINUTE = 60.0
_LOADED = 1.5  # times the limit: what takes less has nothing left to load
_TABLES = "{urn:oasis:names:tc:opendocument:xmlns:table:1.0}"
_REPEATED = f"{_TABLES}number-columns-repeated"
_UNKNOWN = ("", "-")


class Known(NamedTuple):
    """An instance: minutes as its file has them.

    `speeds`: shape (zones, n, n), how far a leg is driven in a minute of each zone. `begins`: when
    each zone begins.
    """

    name: str
    least: float
    distances: Array
    speeds: Array
    begins: Array


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks optima", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="a checkout of the repository")
    parser.add_argument("--stops", type=int, nargs="+", choices=LIMITS, default=list(LIMITS))
    parser.add_argument("--count", type=int, default=COUNT, help="instances of each size")
    options = parser.parse_args(arguments)
    least = least_durations(options.data / SHEET)
    with (
        serve_process({"PARETOUR_WORKERS": "1"}, ready=True) as service,
        httpx.Client(base_url=service.url, timeout=300) as client,
    ):
        for n in options.stops:
            instances = [
                read(options.data / INSTANCES / f"{name}.json", least[name])
                for name in spread_evenly([each for each in least if each.startswith(f"{n}_")])
            ][: options.count]
            while planned(client, LIMITS[n], instances[0])["seconds"] > _LOADED * LIMITS[n]:
                pass  # the first requests of a kind load what they need
            measure = partial(planned, client, LIMITS[n])
            resume("optima", f"{n} stops, {LIMITS[n]:g} s", "", instances, measure)
    print(optima_table())


def least_durations(sheet: Path) -> dict[str, float]:
    """Read the known least duration of each of Adamo's instances, in minutes."""
    with zipfile.ZipFile(sheet) as opened:
        root = ElementTree.fromstring(opened.read("content.xml"))
    rows = (list(_cells(row)) for row in root.iter(f"{_TABLES}table-row"))
    named = ((row[1], row[2]) for row in rows if len(row) > 2)
    return {name: float(value) for name, value in named if "_" in name and value not in _UNKNOWN}


def _cells(row: ElementTree.Element) -> Iterator[str]:
    for cell in row:
        for _ in range(min(3, int(cell.get(_REPEATED, "1")))):
            yield "".join(cell.itertext())


def spread_evenly(names: list[str]) -> list[str]:
    """Return names in an order in which any first ones are spread over the alphabet."""
    order = np.random.default_rng(0).permutation(len(names))
    return [sorted(names)[index] for index in order]


def read(path: Path, least: float) -> Known:
    """Read an instance; its last vertex is the first one again."""
    given = json.loads(path.read_text(encoding="utf-8"))
    n = given["digraph"]["vertex_count"] - 1
    order = [*range(1, n), n]  # to each stop, and back
    columns = [order[-1], *order[:-1]]
    distances = np.array(given["distances"])[:n, columns]
    groups = np.array(given["clusters"])[:n, columns]
    speeds = np.array(given["cluster_speeds"])
    begins = np.array([zone[0] for zone in given["speed_zones"]])
    np.fill_diagonal(distances, 0.0)
    return Known(path.stem, least, distances, speeds[groups].transpose(2, 0, 1), begins)


def request_of(known: Known, limit: float) -> dict[str, Any]:
    """Return the body of a request."""
    slices = [
        {"from": MINUTE * begin, "matrix": (MINUTE * known.distances / speeds).tolist()}
        for begin, speeds in zip(known.begins, known.speeds, strict=True)
    ]
    return {
        "stops": [{"id": str(stop)} for stop in range(len(known.distances))],
        "objectives": [
            {"name": "time", "slices": slices},
            {"name": "distance", "matrix": known.distances.tolist()},
        ],
        "departure": 0,
        "time_limit": limit,
        "seed": 1,
    }


def planned(client: httpx.Client, limit: float, known: Known) -> dict[str, Any]:
    """Return the least duration that a service finds, in minutes, beside the known one."""
    body = json.dumps(request_of(known, limit))
    began = time.monotonic()
    answer = client.post("/front", content=body, headers={"Content-Type": "application/json"})
    front = answer.raise_for_status().json()["front"]
    seconds = time.monotonic() - began
    best = min(front, key=lambda each: each["lengths"][0])
    minutes = best["lengths"][0] / MINUTE
    np.testing.assert_allclose(minutes, duration(known, best["tour"]), rtol=1e-9)
    found = round(minutes, 4)
    return {"name": known.name, "known": known.least, "found": found, "seconds": round(seconds, 3)}


def duration(known: Known, tour: list[int]) -> float:
    """Return the minutes that a tour takes from midnight on, driven zone by zone."""
    assert sorted(tour) == list(range(len(known.distances)))
    ends = [*known.begins[1:], np.inf]
    now, zone = 0.0, 0
    for i, j in zip(tour, [*tour[1:], tour[0]], strict=True):
        left = known.distances[i, j]
        while left > (ends[zone] - now) * known.speeds[zone, i, j]:
            left -= (ends[zone] - now) * known.speeds[zone, i, j]
            now, zone = ends[zone], zone + 1
        now += left / known.speeds[zone, i, j]
    return float(now)
