"""Worker processes of either engine that are killed under load: no job is lost."""

import os
import signal
import time
from concurrent.futures import ThreadPoolExecutor
from threading import Event
from typing import Any

import httpx
import pytest

from tests.helpers.engines import Served, engine_of
from tests.helpers.jobs import CITIES, check, ended, later
from tests.helpers.sampled import sixth
from tests.helpers.serving import problem

# Long enough for a report on the fastest machine.
REQUEST = {"coordinates": CITIES[:100], "time_limit": 0.8}
CHANGES = {"done": [1, 2], "time_limit": 0.8}
FLEET = {
    "stops": [{"id": str(stop)} for stop in range(40)],
    "vehicles": [{"id": "van", "count": 9, "start": "0", "end": "0"}],
    "objectives": [
        {"name": name, "coordinates": [city[:2] for city in CITIES[:40]], "over": over}
        for name, over in (("total", "sum"), ("longest", "max"))
    ],
    "time_limit": 0.8,
}
CALLERS = 3
KILLS = sixth(12)


@pytest.mark.parametrize("kind", ["embedded", "cluster"])
def test_kills_under_load_lose_nothing(kind: str, request: pytest.FixtureRequest) -> None:
    over = Event()
    with (
        engine_of(kind, request, workers=2) as engine,
        engine.serve(queue=40) as served,
        ThreadPoolExecutor(CALLERS) as callers,
    ):
        served.client.timeout = 300  # As each process that follows one takes seconds to load.
        front = served.client.post("/front", json=REQUEST).json()
        rest = f"/front/{front['id']}/replan"
        asking = [callers.submit(ask, served.client, over) for _ in range(CALLERS)]
        paths = [later(served.client, REQUEST) for _ in range(3)]
        fleets = [later(served.client, FLEET, "/fleet") for _ in range(3)]
        rests = [later(served.client, CHANGES, rest) for _ in range(3)]
        try:
            kill_many(served)
        finally:
            over.set()
        for path in paths:
            check_ended(ended(served.client, path))
        for path in fleets:
            check_fleet(ended(served.client, path))
        for path in rests:
            check_rest(ended(served.client, path))
        assert served.client.get(f"/front/{front['id']}").json() == front
        for answer in [answer for asked in asking for answer in asked.result()]:
            check_answered(answer)


def check_rest(found: dict[str, Any]) -> None:
    """With a front of the rest of the way, or lost with its worker."""
    if found["status"] != "done":
        assert (found["status"], found["problem"]["code"]) == ("failed", "worker-lost")
        return
    left = {str(city) for city in range(100)} - {"1"}
    for tour in found["front"]:
        assert (tour["stops"][0], tour["stops"][-1]) == ("2", "0")
        assert set(tour["stops"]) == left


def check_fleet(found: dict[str, Any]) -> None:
    """With plans that visit every stop, or lost with its worker; what was found is kept."""
    if found["status"] != "done":
        assert (found["status"], found["problem"]["code"]) == ("failed", "worker-lost")
    else:
        assert found["front"]
    for plan in found["front"]:
        visits = [stop for route in plan["routes"] for stop in route["stops"][1:-1]]
        assert sorted(visits, key=int) == [str(stop) for stop in range(1, 40)]


def ask(client: httpx.Client, over: Event) -> list[httpx.Response]:
    """One request after the other, until it is over."""
    answers = []
    while not over.is_set():
        answers.append(client.post("/front", json=REQUEST))
    return answers


def kill_many(served: Served) -> None:
    """Kill a process in mid-search many times, each time over another front."""
    killed = set()
    while len(killed) < KILLS:
        for front, pid in served.searching().items():
            if front not in killed and len(killed) < KILLS:
                os.kill(pid, signal.SIGKILL)
                killed.add(front)
        time.sleep(0.01)


def check_ended(found: dict[str, Any]) -> None:
    """With a front, whatever befell it: a kill that came late hit the front that followed."""
    assert found["front"]
    check(found)
    if found["status"] != "done":
        assert (found["status"], found["problem"]["code"]) == ("failed", "worker-lost")


def check_answered(answer: httpx.Response) -> None:
    """With a front, or with a clear refusal."""
    if answer.status_code == 200:
        check(answer.json())
    else:
        code = answer.json()["code"]
        assert code in ("queue-full", "worker-lost")
        problem(answer, 503, code)
