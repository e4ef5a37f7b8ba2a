"""`python -m tests.benchmarks soak`: ten minutes of everything at once, and what is left of it.

Visitors plan 10 to 500 cities, send invalid requests, hang up in the middle, and order fronts as
jobs, which they watch, wait for or cancel. Counts answers, faults of the service and jobs that
never ended, and watches the memory of the server and its workers. Stores `results/soak.json`, and
says what does not hold.
"""

import argparse
import os
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any
from urllib.parse import urlsplit

import psutil
from tqdm import tqdm

from tests.benchmarks.demands import growth, unmet_by_soak
from tests.benchmarks.provenance import provenance, store
from tests.benchmarks.under_load import soak_table
from tests.benchmarks.visitors import Tally, Visitor
from tests.helpers.processes import serve_process

VISITORS = 8
EVERY = 2.0  # seconds between two looks at the memory


def main(arguments: list[str]) -> str | None:
    """The command line. Says what does not hold."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks soak", description=__doc__)
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--visitors", type=int, default=VISITORS)
    options = parser.parse_args(arguments)
    cores = len(os.sched_getaffinity(0))
    results = {**provenance(cores), **soak(60 * options.minutes, options.visitors)}
    store("soak", results)
    print(soak_table(results))
    return "\n".join(unmet_by_soak(results)) or None


def soak(seconds: float, visitors: int) -> dict[str, Any]:
    """What was answered, what was lost, and how the memory went."""
    tally = Tally()
    with serve_process({}, ready=True) as service, ThreadPoolExecutor(visitors) as pool:
        parts = urlsplit(service.url)
        address = (str(parts.hostname), int(parts.port or 0))
        until = time.monotonic() + seconds
        visiting = [
            pool.submit(Visitor(address, tally, seed).visit, until) for seed in range(visitors)
        ]
        memory = _watch(psutil.Process(service.process.pid), until)
        for visit in visiting:
            visit.result()
    return {
        "minutes": round(seconds / 60, 2),
        "visitors": visitors,
        "answers": tally.answers,
        "faults": tally.faults,
        "jobs": tally.jobs,
        "tracebacks_in_log": service.log.count(b"Traceback"),
        "tracebacks": dict(service.tracebacks),
        "exit_status": service.process.returncode,
        "megabytes": [round(each / 2**20, 1) for each in memory],
        "growth_over_last_half": round(growth(memory), 4),
    }


def _watch(server: psutil.Process, until: float) -> list[float]:
    """Bytes resident in the server and its workers together, time after time."""
    seen = []
    with tqdm(total=round(until - time.monotonic()), unit="s") as bar:
        while (now := time.monotonic()) < until:
            seen.append(_resident(server))
            time.sleep(min(EVERY, until - now))
            bar.update(round(time.monotonic() - now))
    return seen


def _resident(server: psutil.Process) -> float:
    total = 0.0
    for process in (server, *server.children(recursive=True)):
        try:
            total += process.memory_info().rss
        except psutil.NoSuchProcess:
            continue
    return total
