"""`python -m tests.benchmarks attack`: honest requests beside crowds that attack the service.

For five minutes, at the deployed limits: two workers, 1,024 descriptors, 2 GiB, behind nginx with
the configuration of service/deploy. Memory is counted in pages of the server and its processes;
what they share counts once. 160 uploads of 16 MB come over a link of a gigabit and stall, 1,100
connections are idle or drip, two clients hang up while their fronts are planned, one repeats a key
on a full queue, two send hostile bodies as fast as they are answered, and three long ones of two
million lists. Each crowd has an address of its own, idle connections five. Honest requests come at
a steady rate from fifty other addresses, first alone and then beside the crowds. Server, crowds and
honest clients share the cores: on a machine that does anything else the waiting says little.
Stores `results/attack.json`, and says what does not hold.
"""

import argparse
import json
import multiprocessing
import os
import re
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from urllib.parse import urlsplit

import httpx
import psutil

from tests.benchmarks import crowds
from tests.benchmarks.demands import WORKERS, unmet_by_attack
from tests.benchmarks.instances import paper_instances
from tests.benchmarks.provenance import provenance, store
from tests.benchmarks.traffic import Asked, Client, evenly, quantiles
from tests.benchmarks.under_load import attack_table
from tests.helpers.nginx import nginx_before
from tests.helpers.processes import ServeProcess, serve_process

SECONDS = 300
DESCRIPTORS = 1024
HONEST = tuple(f"127.0.1.{last}" for last in range(1, 51))  # addresses of honest clients, in turn
PER_SECOND = 2.0  # honest requests for fronts
AT_ONCE = 32  # honest clients that may wait
QUIET_SHARE = 0.2  # of the attack's seconds, before it
_LONG = {"time_limit": 5.0, "preferences": 5}


def main(arguments: list[str]) -> str | None:
    """The command line. Says what does not hold."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks attack", description=__doc__)
    parser.add_argument("--seconds", type=float, default=SECONDS, help="of the attack")
    options = parser.parse_args(arguments)
    cores = len(os.sched_getaffinity(0))
    results = {**provenance(cores), **attacked(options.seconds)}
    store("attack", results)
    print(attack_table(results))
    return "\n".join(unmet_by_attack(results)) or None


def attacked(seconds: float) -> dict[str, Any]:
    """Return what honest clients and crowds were answered, and what it took of the server."""
    settings = {"PARETOUR_WORKERS": str(WORKERS)}
    with (
        serve_process(settings, ready=True, descriptors=DESCRIPTORS) as service,
        TemporaryDirectory() as folder,
        nginx_before(service.url, Path(folder)) as url,
        ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool,
    ):
        address = _address(url)
        quiet = honest(address, QUIET_SHARE * seconds)
        pool.submit(crowds.attack, address, 0).result()  # it imports much
        memory = Memory(psutil.Process(service.process.pid))
        with memory:
            attacking = pool.submit(crowds.attack, address, seconds)
            beside = honest(address, seconds)
            seen = attacking.result()
        lost, present = _lost(service), _present(service)
    return {
        "minutes": round(seconds / 60, 2),
        "busy": round(os.getloadavg()[2], 1),
        "quiet": _summary(quiet),
        "beside": _summary(beside),
        "crowds": seen,
        "megabytes": round(memory.largest / 2**20),
        "workers_lost": lost,
        "workers_present": present,
        "tracebacks_in_log": service.log.count(b"Traceback"),
        "tracebacks": dict(service.tracebacks),
        "exit_status": service.process.returncode,
    }


def honest(address: tuple[str, int], seconds: float) -> list[Asked]:
    """Ask for fronts at a steady rate, each on a connection of its own, from many addresses.

    The status is 0 where there was no answer. The seconds count from when a request was due.
    """
    bodies = [
        json.dumps({"coordinates": cities.tolist(), "time_limit": 0.1}).encode()
        for cities in paper_instances(40)
    ]
    dues = time.perf_counter() + evenly(PER_SECOND, seconds)

    def ask(number: int) -> Asked:
        time.sleep(max(0, dues[number] - time.perf_counter()))
        status = _ask(address, bodies[number % len(bodies)], HONEST[number % len(HONEST)])
        return Asked(status, time.perf_counter() - dues[number])

    with ThreadPoolExecutor(AT_ONCE) as pool:
        return list(pool.map(ask, range(len(dues))))


class Memory:
    """The most bytes that a process and its children had together, while the block lasts.

    Attributes:
        largest: Bytes: pages that several of them share count once.
    """

    def __init__(self, server: psutil.Process) -> None:
        self._server = server
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch)
        self.largest = 0

    def __enter__(self) -> "Memory":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()

    def _watch(self) -> None:
        while not self._ended.wait(0.5):
            processes = (self._server, *self._server.children(recursive=True))
            self.largest = max(self.largest, sum(_pages(each.pid) for each in processes))


def _pages(pid: int) -> int:
    """Return the bytes of a process's pages, shared ones in equal parts; 0 where it has ended."""
    try:
        rollup = Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="utf-8")
    except (FileNotFoundError, ProcessLookupError):
        return 0
    found = re.search(r"^Pss:\s+(\d+) kB", rollup, re.M)
    return 1024 * int(found[1]) if found else 0


def _ask(address: tuple[str, int], body: bytes, source: str) -> int:
    try:
        client = Client(address, source)
    except OSError:
        return 0
    try:
        return client.ask("POST", "/front", body)
    except (OSError, ValueError):
        return 0
    finally:
        client.close()


def _summary(answers: list[Asked]) -> dict[str, Any]:
    statuses = sorted({answer.status for answer in answers})
    counted = {str(each): sum(a.status == each for a in answers) for each in statuses}
    return {"statuses": counted, **quantiles(answers)}


def _lost(service: ServeProcess) -> int:
    return int(_metric(service, "worker_restarts_total"))


def _present(service: ServeProcess) -> int:
    """Return how many workers plan at the same time, when as many fronts are asked for."""
    with httpx.Client(base_url=service.url, timeout=60) as client:
        cities = paper_instances(40)[0].tolist()
        for _ in range(WORKERS):
            job = {**_LONG, "coordinates": cities}
            client.post("/front", json=job, headers={"Prefer": "respond-async"})
    most, until = 0, time.monotonic() + _LONG["time_limit"]
    while most < WORKERS and time.monotonic() < until:
        most = max(most, int(_metric(service, "workers_busy")))
        time.sleep(0.1)
    return most


def _metric(service: ServeProcess, name: str) -> float:
    exposition = httpx.get(f"{service.url}/metrics").text
    return float(re.findall(rf"^paretour_{name} (\S+)", exposition, re.M)[0])


def _address(url: str) -> tuple[str, int]:
    parts = urlsplit(url)
    return str(parts.hostname), int(parts.port or 0)
