"""`python -m tests.benchmarks load`: what HTTP costs, and how long answers take under load.

40 cities, 100 preferences, the network alone. The server, its clients and the bare ONNX session
share the cores that this process may use. Sessions are called bare, in a loop: as many as cores,
each in a process and with a thread of its own, as in the server, and a single one with all cores
for each call. Clients, eight a core, ask again as soon as they are answered. All are measured in
turn, because machines drift, and the milliseconds that they take of the processor are counted
beside the answers: these tell on a busy machine, too.
Stores `results/load.json`, and says what does not hold.
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
import psutil

from service.instance import Instance
from service.onnx_runtime import onnxruntime
from service.preferences import fan, from_angles
from tests.benchmarks import long_bodies
from tests.benchmarks.actors import ACTORS, PREFERENCES
from tests.benchmarks.demands import unmet_by_load
from tests.benchmarks.instances import paper_instances
from tests.benchmarks.provenance import provenance, store
from tests.benchmarks.traffic import (
    MOST_AT_ONCE,
    Asked,
    as_fast_as_answered,
    at_random,
    evenly,
    now_and_then,
    quantiles,
    when_due,
)
from tests.benchmarks.under_load import load_table
from tests.helpers.processes import ServeProcess, serve_process

CITIES = 40
CLIENTS = 8  # a core: enough that some always wait for each worker
SECONDS = 20  # of each measurement
ROUNDS = 5
SHARE = 0.8  # of the sustained rate, at which answers are timed
NAME = "pa-one"
_ASIDES = ("/health/live", "/health/ready", "/metrics")


def main(arguments: list[str]) -> str | None:
    """The command line. Says what does not hold."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks load", description=__doc__)
    parser.add_argument("--seconds", type=float, default=SECONDS, help="of each measurement")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="of the measurements in turn")
    options = parser.parse_args(arguments)
    cores = len(os.sched_getaffinity(0))
    results = {**provenance(cores), **measure(cores, options.rounds, options.seconds)}
    whole = options.seconds >= SECONDS and options.rounds >= ROUNDS
    partial = "" if whole else f"{options.rounds} rounds of {options.seconds:g} s"
    store("load", results, partial)
    print(load_table(results))
    return "\n".join(unmet_by_load(results)) or None


def measure(cores: int, rounds: int, seconds: float) -> dict[str, Any]:
    """Answers a second, of the bare session and the server, and how long answers take."""
    settings = {
        "PARETOUR_WORKERS": str(cores),
        "PARETOUR_THREADS": "1",
        # Else a burst is refused, and not timed; all of it comes from one address.
        "PARETOUR_QUEUE": str(MOST_AT_ONCE),
        "PARETOUR_CALLER_SHARE": "1",
    }
    with serve_process(settings, ready=True) as service:
        address = _address(service)
        as_fast_as_answered(address, _bodies(), cores, 1)
        bare, apart, served, timed, bursting = [], [], [], [], []
        for seed in range(rounds):
            bare.append(_bare(1, cores, seconds))
            apart.append(_bare(cores, 1, seconds))
            served.append(_served(service, CLIENTS * cores, seconds))
            rate = SHARE * served[-1]["per_second"]
            for asked, dues in (
                (timed, evenly(rate, seconds)),
                (bursting, at_random(rate, seconds, seed)),
            ):
                asked += _checked(when_due(address, _bodies(), dues))
        asides = _asides(address, cores, seconds)
        sending = long_bodies.Senders(address)
        with sending:
            crowded = _asides(address, cores, seconds)
    return {
        "cities": CITIES,
        "preferences": PREFERENCES,
        "clients": CLIENTS * cores,
        "seconds": seconds,
        "bare": bare,
        "apart": apart,
        "served": served,
        "share_of_apart": round(_mean(served, "per_second") / _mean(apart, "per_second"), 4),
        "processor_share": round(_mean(apart, "session_ms") / _processor_ms(served), 4),
        "at_80_percent": {**quantiles(timed), "requests": len(timed)},
        "at_80_percent_at_random": {**quantiles(bursting), "requests": len(bursting)},
        "under_full_load": asides,
        "with_long_bodies": crowded,
        "long_bodies": sending.statuses,
    }


def _served(service: ServeProcess, clients: int, seconds: float) -> dict[str, float]:
    """Answers a second, and what one takes of the processor."""
    server = psutil.Process(service.process.pid)
    workers = server.children(recursive=True)
    clocks = {
        "server_ms": lambda: _spent(server),
        "workers_ms": lambda: sum(map(_spent, workers)),
        "clients_ms": time.process_time,
    }
    before = {name: clock() for name, clock in clocks.items()}
    answers = _checked(as_fast_as_answered(_address(service), _bodies(), clients, seconds))
    spent = {name: clock() - before[name] for name, clock in clocks.items()}
    each = {name: round(1000 * of_all / len(answers), 3) for name, of_all in spent.items()}
    return {"per_second": round(len(answers) / seconds, 2), **each}


def _spent(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)


def _asides(address: tuple[str, int], cores: int, seconds: float) -> dict[str, Any]:
    """How long health and metrics take while all workers are busy and more fronts wait."""
    stop = threading.Event()
    with ThreadPoolExecutor(len(_ASIDES)) as pool:
        asking = [pool.submit(now_and_then, address, path, 0.05, stop) for path in _ASIDES]
        try:
            as_fast_as_answered(address, _bodies(), 4 * cores, seconds)
        finally:
            stop.set()
    answers = [_checked(each.result()) for each in asking]
    return {path: quantiles(each) for path, each in zip(_ASIDES, answers, strict=True)}


def _bodies() -> list[bytes]:
    return [
        json.dumps({"coordinates": cities.tolist(), "time_limit": 0, "repairs": 0}).encode()
        for cities in paper_instances(CITIES)
    ]


def _address(service: ServeProcess) -> tuple[str, int]:
    parts = urlsplit(service.url)
    return str(parts.hostname), int(parts.port or 0)


def _checked(answers: list[Asked]) -> list[Asked]:
    statuses = {answer.status for answer in answers}
    if statuses != {200}:
        raise RuntimeError(f"every status must be 200, got {statuses}")
    return answers


def _bare(processes: int, threads: int, seconds: float) -> dict[str, float]:
    """Calls a second, of a session in each process, and what one takes of the processor."""
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        found = pool.starmap(_loop, [(threads, seconds)] * processes)
    calls, spent = zip(*found, strict=True)
    each = round(1000 * sum(spent) / sum(calls), 3)
    return {"per_second": round(sum(calls) / seconds, 2), "session_ms": each}


def _loop(threads: int, seconds: float) -> tuple[int, float]:
    """How often a session with a number of threads was run, and its processor seconds."""
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    session = onnxruntime.InferenceSession(ACTORS / f"{NAME}.onnx", options)
    preferences = from_angles(fan(PREFERENCES)).astype(np.float32)
    inputs = [
        {
            "cities": Instance(coordinates=cities).scaled_coordinates.astype(np.float32),
            "preferences": preferences,
            "repairs": np.array(0, dtype=np.int64),
        }
        for cities in paper_instances(CITIES)
    ]
    for each in inputs:
        session.run(["tours"], each)
    calls, until, before = 0, time.perf_counter() + seconds, time.process_time()
    while time.perf_counter() < until:
        session.run(["tours"], inputs[calls % len(inputs)])
        calls += 1
    return calls, time.process_time() - before


def _mean(rows: list[dict[str, float]], name: str) -> float:
    return float(np.mean([row[name] for row in rows]))


def _processor_ms(served: list[dict[str, float]]) -> float:
    return sum(_mean(served, name) for name in ("server_ms", "workers_ms", "clients_ms"))
