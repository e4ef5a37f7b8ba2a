"""`python -m tests.benchmarks load`: what HTTP costs, and how long answers take under load.

40 cities, 100 preferences, the network alone. The server, its clients and the bare ONNX session
share the cores that this process may use; server and bare session have one process or thread of
inference a core. The bare session and the server are measured in turn, because machines drift.
Prints a table and stores `results/load.json`.
"""

import argparse
import json
import multiprocessing
import os
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from service.actor import Actor
from service.instance import Instance
from service.preferences import fan, from_angles
from tests.benchmarks.actors import ACTORS, PREFERENCES
from tests.benchmarks.instances import paper_instances
from tests.benchmarks.provenance import provenance, store
from tests.benchmarks.traffic import (
    Asked,
    as_fast_as_answered,
    at_a_rate,
    now_and_then,
    quantiles,
)
from tests.serving import running

CITIES = 40
SHARE = 0.8  # of the sustained rate, at which answers are timed
NAME = "pa-one"


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks load", description=__doc__)
    parser.add_argument("--seconds", type=float, default=20, help="of each measurement")
    parser.add_argument("--rounds", type=int, default=3, help="bare session and server in turn")
    options = parser.parse_args(arguments)
    cores = len(os.sched_getaffinity(0))
    results = {**provenance(cores), **measure(cores, options.rounds, options.seconds)}
    store("load", results)
    _print_table(results)


def measure(cores: int, rounds: int, seconds: float) -> dict[str, Any]:
    """Answers a second, of the bare session and the server, and how long answers take."""
    settings = {"PARETOUR_WORKERS": str(cores), "PARETOUR_THREADS": "1"}
    with running(settings, ready=True) as service:
        parts = urlsplit(service.url)
        address = (str(parts.hostname), int(parts.port or 0))
        _check(as_fast_as_answered(address, _bodies(), cores, 1))
        bare, served = [], []
        for _ in range(rounds):
            bare.append(_bare_rate(cores, seconds))
            answers = as_fast_as_answered(address, _bodies(), 3 * cores, seconds)
            served.append(_check(answers) / seconds)
        rate = float(np.mean(served))
        timed = at_a_rate(address, _bodies(), SHARE * rate, seconds)
        _check(timed)
        asides = _asides(address, cores, seconds)
    return {
        "cities": CITIES,
        "preferences": PREFERENCES,
        "seconds": seconds,
        "bare_per_second": [round(each, 2) for each in bare],
        "served_per_second": [round(each, 2) for each in served],
        "served_share": round(rate / float(np.mean(bare)), 4),
        "at_80_percent": {**quantiles(timed), "requests": len(timed)},
        "under_full_load": asides,
    }


def _asides(address: tuple[str, int], cores: int, seconds: float) -> dict[str, Any]:
    """How long health and metrics take while all workers are busy and more fronts wait."""
    stop = threading.Event()
    paths = ("/health/live", "/health/ready", "/metrics")
    with ThreadPoolExecutor(len(paths)) as pool:
        asking = [pool.submit(now_and_then, address, path, 0.05, stop) for path in paths]
        try:
            as_fast_as_answered(address, _bodies(), 4 * cores, seconds)
        finally:
            stop.set()
    answers = [each.result() for each in asking]
    return {path: quantiles(each) for path, each in zip(paths, answers, strict=True)}


def _bodies() -> list[bytes]:
    return [
        json.dumps({"coordinates": cities.tolist(), "time_limit": 0}).encode()
        for cities in paper_instances(CITIES)
    ]


def _check(answers: list[Asked]) -> int:
    statuses = {answer.status for answer in answers}
    if statuses != {200}:
        raise RuntimeError(f"every answer must be a front, got statuses {statuses}")
    return len(answers)


def _bare_rate(cores: int, seconds: float) -> float:
    """Inference calls a second, of one process a core."""
    with multiprocessing.get_context("spawn").Pool(cores) as pool:
        return sum(pool.map(_loop, [seconds] * cores))


def _loop(seconds: float) -> float:
    """Inference calls a second, of a session with one thread."""
    actor = Actor(ACTORS / f"{NAME}.onnx", threads=1)
    preferences = from_angles(fan(PREFERENCES))
    instances = [Instance(coordinates=cities) for cities in paper_instances(CITIES)]
    for instance in instances:
        actor.tours(instance, preferences)
    calls, began = 0, time.perf_counter()
    while time.perf_counter() < began + seconds:
        actor.tours(instances[calls % len(instances)], preferences)
        calls += 1
    return calls / (time.perf_counter() - began)


def _print_table(results: dict[str, Any]) -> None:
    timed = results["at_80_percent"]
    print("| | |\n|---|---|")
    print(f"| bare session, calls a second | {np.mean(results['bare_per_second']):.1f} |")
    print(f"| served, answers a second | {np.mean(results['served_per_second']):.1f} |")
    print(f"| share | {100 * results['served_share']:.1f} % |")
    print(f"| median at 80 % of that | {timed['median_ms']:.1f} ms |")
    print(f"| p99 at 80 % of that | {timed['p99_ms']:.1f} ms |")
    for path, each in results["under_full_load"].items():
        worst = f"p99 {each['p99_ms']:.1f} ms, worst {each['worst_ms']:.1f} ms"
        print(f"| {path} under full load | {worst} |")
