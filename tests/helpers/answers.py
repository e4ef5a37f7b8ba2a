"""A stand-in for the service, which answers a client with what a test has prepared."""

import json
from collections.abc import Callable
from typing import Any

import httpx

_TOURS: list[dict[str, Any]] = [
    {"angle": 60.0, "balance": 0.0, "lengths": [1.0, 2.0], "tour": [0, 1, 2]},
    {"angle": 30.0, "balance": 1.0, "lengths": [2.0, 1.0], "tour": [0, 2, 1]},
]
FRONT = {
    "id": "f",
    "status": "done",
    "cities": 3,
    "front": _TOURS,
    "points": 2,
    "hypervolume": 0.5,
    "hypervolume_bound": None,
    "reference_point": [3.0, 3.0],
    "scale": [1.0, 1.0],
    "actor": {"name": "pa-one", "digest": "0"},
    "timings_ms": {},
    "terminated": "converged",
}
NAMED = FRONT | {
    "objectives": [{"name": "way", "unit": "m"}, {"name": "risk [red]$", "unit": None}],
    "stops": [{"id": "depot", "location": [24.9, 60.1]}, {"id": "b 2"}, {"id": "c"}],
    "front": [
        item | {"stops": ids}
        for item, ids in zip(_TOURS, (["depot", "b 2", "c"], ["depot", "c", "b 2"]), strict=True)
    ],
}
EMPTY = FRONT | {"status": "running", "front": [], "points": 0, "terminated": None}


Connect = Callable[..., Any]  # makes a client, as the fixture `connect` does


class Answers(httpx.MockTransport):
    """A transport that gives these answers, one after the other, and records the requests."""

    def __init__(self, *answers: httpx.Response | Exception) -> None:
        super().__init__(self._answer)
        self._answers = iter(answers)
        self.requests: list[httpx.Request] = []

    def _answer(self, request: httpx.Request) -> httpx.Response:
        self.requests.append(request)
        answer = next(self._answers)
        if isinstance(answer, Exception):
            raise answer
        return answer


def front(**changed: Any) -> httpx.Response:
    return httpx.Response(200, json=FRONT | changed)


def problem(status: int, code: str, **headers: str) -> httpx.Response:
    document = {"status": status, "code": code, "detail": "it is so", "request_id": "r"}
    headers["Content-Type"] = "application/problem+json"
    return httpx.Response(status, content=json.dumps(document), headers=headers)


def events(*items: tuple[str, dict[str, Any]]) -> httpx.Response:
    text = ": heartbeat\n\n" + "".join(
        f"event: {kind}\ndata: {json.dumps(data)}\n\n" for kind, data in items
    )
    return httpx.Response(200, text=text, headers={"Content-Type": "text/event-stream"})


def status(name: str) -> tuple[str, dict[str, Any]]:
    return "status", {"id": "f", "status": name}


def progress(hypervolume: float) -> tuple[str, dict[str, Any]]:
    return "progress", {"seconds": 0.1, "hypervolume": hypervolume, "points": 3}
