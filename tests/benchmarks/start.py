"""`python -m tests.benchmarks start`: the seconds from the first command to the first front.

`paretour serve` with an empty cache of compiled code, as after its installation. It is asked for a
front of 60 cities, by the network alone and with a tenth of a second of search. Then it waits until
everything is compiled. Prints, and stores nothing.
"""

import argparse
import json
import tempfile
import time

import httpx
import numpy as np
import psutil

from tests.helpers.processes import ServeProcess, serve_process

CITIES = 60
PAUSE = 0.05  # seconds between two questions


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks start", description=__doc__)
    parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as cache:
        began = time.monotonic()
        settings = {"NUMBA_CACHE_DIR": cache, "NUMBA_DISABLE_JIT": "0"}
        with serve_process(settings) as service, httpx.Client(base_url=service.url) as client:
            measured = {
                "network alone, s": _answered(client, began, time_limit=0, repairs=0),
                "with a search, s": _answered(client, began, time_limit=0.1),
                "all compiled, s": _all_compiled(client, began),
                "processor, s": _processor_seconds(service),
            }
    print(json.dumps(measured, indent=1))


def _answered(client: httpx.Client, began: float, **options: float) -> float:
    """Ask for a front until there is one, and return the seconds since the service was started."""
    coordinates = np.random.default_rng(0).random((CITIES, 4)).tolist()
    body = {"coordinates": coordinates, **options}
    while (answer := client.post("/front", json=body, timeout=60)).status_code == 503:
        time.sleep(PAUSE)
    answer.raise_for_status()
    return round(time.monotonic() - began, 1)


def _all_compiled(client: httpx.Client, began: float) -> float:
    """Wait until everything is compiled, and return the seconds since the service was started."""
    while "compiling" in client.get("/health/ready").json():
        time.sleep(PAUSE)
    return round(time.monotonic() - began, 1)


def _processor_seconds(service: ServeProcess) -> float:
    """Return the time of all processors that the service and its processes have taken."""
    server = psutil.Process(service.process.pid)
    times = [process.cpu_times() for process in (server, *server.children(recursive=True))]
    return round(sum(sum(each[:4]) for each in times), 1)
