"""`python -m tests.benchmarks roads`: stops in central Helsinki by road, over HTTP.

A service with two workers beside a Valhalla with two threads, which has the streets of the extract
that the tests use. Stops lie at random where the engine knows a way between all of them; time
against distance, `time_limit` 1. Of each request: seconds until the matrices were there, as the
answer reports them, those of the whole answer, and those of the matrices when the same stops are
asked for again. Stores `results/roads.json`, and says what does not hold.
"""

import argparse
import os
import tempfile
import time
from pathlib import Path
from typing import Any

import httpx
import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load, provenance, store
from tests.helpers.processes import serve_process
from tests.helpers.valhalla import valhalla_service

ROUNDS = 5
SECONDS = {60: 0.5, 200: 3.0}  # for the matrices, by number of stops
TIME_LIMIT = 1.0
PLACES = 320  # some are far from a road, or have no way to others
_CORNER, _SIDES = (24.935, 60.164), (0.02, 0.01)  # degrees: between the railway and the shore
_OBJECTIVES = [{"name": "time", "from": "road_time"}, {"name": "way", "from": "road_distance"}]


def main(arguments: list[str]) -> str | None:
    """The command line. Says what does not hold."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks roads", description=__doc__)
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="requests of each size")
    options = parser.parse_args(arguments)
    results = {**provenance(2), "busy": round(os.getloadavg()[0], 1), **asked(options.rounds)}
    store("roads", results)
    print(roads_table(results))
    return "\n".join(unmet(results)) or None


def asked(rounds: int) -> dict[str, Any]:
    """Return the seconds of some requests of each size, each with stops of its own."""
    with tempfile.TemporaryDirectory() as folder, valhalla_service(Path(folder)) as engine:
        settings = {"PARETOUR_WORKERS": "2", "PARETOUR_ROUTER_URL": engine.url}
        with (
            serve_process(settings, ready=True) as service,
            httpx.Client(base_url=service.url, timeout=120) as client,
        ):
            places = connected(client, np.random.default_rng(3))
            draw = np.random.default_rng(4)
            measured = {
                str(n): [_round(client, draw.permutation(places)[:n]) for _ in range(rounds)]
                for n in SECONDS
            }
    return {"rounds": rounds, "stops": measured}


def connected(client: httpx.Client, draw: np.random.Generator) -> NDArray[np.float64]:
    """Return places, shape (m, 2). The service finds a way by road between any two of them."""
    places = _CORNER + _SIDES * draw.random((PLACES, 2))
    while (answer := _post(client, places)).status_code != 200:
        refused = {int(error["pointer"].split("/")[-1]) for error in answer.json()["errors"]}
        places = np.delete(places, sorted(refused), axis=0)
    return places


def roads_table(results: dict[str, Any]) -> str:
    """The medians, and the worst."""
    rows = []
    for n, rounds in results["stops"].items():
        cells = [
            f"{np.median([each[name] for each in rounds]):.2f} s"
            f" ({max(each[name] for each in rounds):.2f} s)"
            for name in ("matrices", "answer", "again")
        ]
        rows.append([n, *cells, str(len(rounds))])
    return table(["stops", "matrices", "answer", "matrices again", "requests"], rows)


def unmet(results: dict[str, Any]) -> list[str]:
    """A sentence for each demand that does not hold."""
    sentences = []
    for n, rounds in results["stops"].items():
        median = float(np.median([each["matrices"] for each in rounds]))
        if median > SECONDS[int(n)]:
            asked_for = f"matrices of {n} stops must be there within {SECONDS[int(n)]:g} s"
            sentences.append(f"{asked_for}, got {median:.2f} s")
    return sentences


def section() -> str:
    """What is stored, for the page of results."""
    stored = load("roads")
    found = roads_table(stored) if stored else "Not measured.\n"
    return (
        "## By road\n\nNot in the paper: `python -m tests.benchmarks roads`. Random stops in "
        "central Helsinki, the service\nand a Valhalla on the same two cores, `time_limit` "
        f"{TIME_LIMIT:g}; median and worst.\n\n{found}"
    )


def _round(client: httpx.Client, places: NDArray[np.float64]) -> dict[str, float]:
    began = time.perf_counter()
    answer = _post(client, places)
    seconds = time.perf_counter() - began
    again = _post(client, places)
    return {
        "matrices": round(_road_seconds(answer), 3),
        "answer": round(seconds, 3),
        "again": round(_road_seconds(again), 3),
    }


def _road_seconds(answer: httpx.Response) -> float:
    return float(answer.raise_for_status().json()["timings_ms"]["roads"]) / 1000


def _post(client: httpx.Client, places: NDArray[np.float64]) -> httpx.Response:
    stops = [{"id": str(i), "location": place} for i, place in enumerate(places.tolist())]
    request = {"stops": stops, "objectives": _OBJECTIVES, "time_limit": TIME_LIMIT, "size": 20}
    return client.post("/front", json=request)
