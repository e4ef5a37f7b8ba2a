"""Requests of either engine over HTTP: submit jobs, wait for them, and check their fronts."""

import json
import time
from typing import Any

import httpx
import numpy as np
from paretour.server_sent_events import EventParser

from service.instance import Instance, tour_lengths

# So many that no search of theirs has converged within seconds.
CITIES = np.random.default_rng(5).random((300, 4)).tolist()
LONG = {"coordinates": CITIES, "time_limit": 600}
SHORT = {"coordinates": CITIES[:12], "time_limit": 0.05}
SECONDS = 300  # that a job may take on the busiest machine
LATER = {"Prefer": "handling=strict, respond-async; wait=10"}


def later(
    client: httpx.Client, request: dict[str, Any] = SHORT, to: str = "/front", **headers: str
) -> str:
    """The path of a front that will be found."""
    answer = client.post(to, json=request, headers={**LATER, **headers})
    assert (answer.status_code, answer.headers["preference-applied"]) == (202, "respond-async")
    path = answer.headers["location"]
    assert path == f"/front/{answer.json()['id']}"
    assert answer.json()["status"] in ("queued", "running", "done")
    return path


def first_found(
    client: httpx.Client, request: dict[str, Any], to: str = "/front", **headers: str
) -> httpx.Response:
    """The first answer to a request, asked again where a busy machine finds nothing in time."""
    deadline = time.monotonic() + SECONDS
    while (answer := client.post(to, json=request, headers=headers)).status_code == 504:
        if time.monotonic() > deadline:
            raise TimeoutError(f"nothing was found within {SECONDS} s")
    return answer


def id_of(path: str) -> str:
    return path.rpartition("/")[2]


def ended(client: httpx.Client, path: str) -> dict[str, Any]:
    deadline = time.monotonic() + SECONDS
    while (found := client.get(path).json())["status"] in ("queued", "running"):
        _wait(deadline, path, found)
    return found


def until_found(client: httpx.Client, path: str) -> dict[str, Any]:
    """A front that is being planned and has a tour already."""
    deadline = time.monotonic() + SECONDS
    while not (found := client.get(path).json())["front"]:
        _wait(deadline, path, found)
    assert found["status"] == "running"
    return found


def _wait(deadline: float, path: str, found: dict[str, Any]) -> None:
    if time.monotonic() > deadline:
        raise TimeoutError(f"{path} is still {found['status']} after {SECONDS} s")
    time.sleep(0.02)


def check(found: dict[str, Any]) -> None:
    tours = np.array([item["tour"] for item in found["front"]])
    lengths = tour_lengths(Instance(coordinates=np.array(CITIES)[: found["cities"]]), tours)
    np.testing.assert_allclose([item["lengths"] for item in found["front"]], lengths)


def events(client: httpx.Client, path: str) -> list[tuple[str, dict[str, Any]]]:
    """The type and data of each event of a front, until its job has ended."""
    answer = client.get(f"{path}/events", headers={"Accept": "text/event-stream"})
    parsed = EventParser().feed(answer.content)
    return [(event.type, json.loads(event.data)) for event in parsed]
