"""`python -m tests.benchmarks served`: the paper's instances as a caller gets them, over HTTP.

A service with one worker on one core is asked for 100 tours of each instance: by the network alone,
and with each time limit. Hypervolume in per cent, of the tours that it returns, up to (n, n); the
seconds are those from sending the request until the answer is read. Prints a table and stores
`results/served.json`.
"""

import argparse
import time
from functools import partial
from typing import Any

import httpx
import numpy as np
from numpy.typing import NDArray

from service.pareto import hypervolume
from tests.benchmarks.instances import COUNT, check_tours, paper_instances
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load
from tests.benchmarks.rows import resume
from tests.helpers.processes import serve_process

LIMITS = {40: (0.0, 0.05), 200: (0.0, 0.1), 500: (0.0, 0.3), 1000: (0.0, 0.6)}  # seconds
TOURS = 100


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks served", description=__doc__)
    parser.add_argument("--cities", type=int, nargs="+", choices=LIMITS, default=list(LIMITS))
    parser.add_argument("--count", type=int, default=COUNT, help="instances of each size")
    options = parser.parse_args(arguments)
    with (
        serve_process({"PARETOUR_WORKERS": "1"}, ready=True) as service,
        httpx.Client(base_url=service.url, timeout=60) as client,
    ):
        for n in options.cities:
            instances = paper_instances(n, options.count)
            answered(client, 0.0, instances[0])  # the first request of a kind loads what it needs
            for limit in LIMITS[n]:
                measure = partial(answered, client, limit)
                resume("served", f"{n} cities, {limit:g} s", "", instances, measure)
    print_table()


def answered(client: httpx.Client, limit: float, cities: NDArray[np.float64]) -> dict[str, Any]:
    """The hypervolume of what a service returns for an instance, and the seconds that it took."""
    n = len(cities)
    body = {"coordinates": cities.tolist(), "time_limit": limit, "size": TOURS, "seed": 1}
    began = time.monotonic()
    answer = client.post("/front", json=body)
    front = answer.raise_for_status().json()["front"]
    seconds = time.monotonic() - began
    check_tours(np.array([each["tour"] for each in front]), n)
    points = np.array([each["lengths"] for each in front])
    share = hypervolume(points, np.full(2, float(n)))
    return {"hypervolume": round(100 * share, 4), "seconds": round(seconds, 4)}


def print_table() -> None:
    """Print the means of what is stored."""
    stored = load("served")
    rows = []
    for n, limits in LIMITS.items():
        for limit in limits:
            found = stored.get(f"{n} cities, {limit:g} s", {}).get("instances", [])
            if found:
                means = [
                    np.mean([each[key] for each in found]) for key in ("hypervolume", "seconds")
                ]
                rows.append([str(n), f"{limit:g} s", f"{means[0]:.2f}", f"{means[1]:.3f} s"])
    print(table(["cities", "time_limit", "hypervolume", "answered in"], rows))
