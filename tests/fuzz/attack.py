"""Attacks with fuzzed bodies: in this process, and over HTTP beside a watch of the health."""

import json
import random
import resource
import threading
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, NoReturn

import httpx

from service.actor_info import ActorInfo
from service.errors import PROBLEMS, Refusal
from service.kinds.parsing import parse_replan, parse_task
from service.requests.limits import Limits
from service.requests.replan.way import ReplanSource
from service.requests.task import TaskSource
from tests.fuzz.bodies import GENERATORS
from tests.helpers.changes import FrontOf


def parse_many(
    name: str, count: int, seed: int, limits: Limits, actors: dict[str, ActorInfo]
) -> Counter[str]:
    """Parse bodies of a generator here, and return how often each outcome came, by its code.

    An exception that is not a refusal would be a 500, and is not caught.
    """
    outcomes: Counter[str] = Counter()
    for number in range(count):
        made = GENERATORS[name](random.Random(f"{name} {seed} {number}"))
        try:
            if isinstance(made, Refusal):
                raise made
            if isinstance(made, ReplanSource):
                parse_replan(made, limits, actors)
            else:
                parse_task(made, limits, actors)
            outcomes["planned"] += 1
        except Refusal as refusal:
            json.dumps(refusal.document("x"), allow_nan=False)
            outcomes[refusal.code] += 1
    assert all(PROBLEMS[code].status < 500 for code in outcomes if code in PROBLEMS)
    return outcomes


def post_many(url: str, sources: Iterable[TaskSource | ReplanSource]) -> Counter[int]:
    """Post bodies and return how often each status came, after a check of each answer.

    What a request to replan is about is planned first.
    """
    statuses: Counter[int] = Counter()
    with httpx.Client(base_url=url, timeout=60) as client:
        for source in sources:
            answer = _post(client, source)
            assert answer.status_code < 500 or answer.status_code == 503, answer.text
            strict_json(answer.content)
            statuses[answer.status_code] += 1
    return statuses


def _post(client: httpx.Client, source: TaskSource | ReplanSource) -> httpx.Response:
    if isinstance(source, TaskSource):
        return client.post(f"/{source.kind}", **message_of(source))
    assert isinstance(source.front, FrontOf)
    front = _post(client, source.front.source).raise_for_status().json()["id"]
    message = message_of(TaskSource("replan", source.body))
    return client.post(f"/front/{front}/replan", **message)


def strict_json(content: bytes) -> Any:
    """Return JSON, in which no number may be NaN or infinite.

    Raises:
        ValueError: One is.
    """

    def refuse(constant: str) -> NoReturn:
        raise ValueError(f"{constant} is not JSON")

    return json.loads(content, parse_constant=refuse)


def largest_memory() -> float:
    """Return the most memory that this process ever had, in MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


@dataclass
class HealthWatch:
    """The seconds that each question for the health of a service took."""

    seconds: list[float] = field(default_factory=list)


@contextmanager
def watching_health(url: str) -> Iterator[HealthWatch]:
    """Ask for the health of a service every 50 ms until the block ends."""
    watch, ended = HealthWatch(), threading.Event()

    def ask() -> None:
        with httpx.Client(base_url=url, timeout=60) as client:
            while not ended.wait(0.05):
                began = time.perf_counter()
                client.get("/health/live").raise_for_status()
                watch.seconds.append(time.perf_counter() - began)

    thread = threading.Thread(target=ask)
    thread.start()
    try:
        yield watch
    finally:
        ended.set()
        thread.join()


def message_of(source: TaskSource) -> dict[str, Any]:
    if source.upload is None:
        return {"content": source.body, "headers": {"Content-Type": "application/json"}}
    part = "matrices" if source.kind == "front" else "map"
    return {"files": {"request": (None, source.body), part: ("file", source.upload)}}
