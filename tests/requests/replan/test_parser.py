"""Requests to replan fronts of each kind, and fronts that cannot be replanned."""

import json
from typing import Any

import numpy as np
import pytest

from service.coverage.coverage import Coverage
from service.errors import Refusal
from service.kinds.parsing import parse_replan, parse_task
from service.replanning.earlier_tours import EarlierTours
from service.requests.limits import Limits
from service.requests.replan.way import ReplanSource, StoredFront
from service.requests.stops import Stops
from service.requests.task import Task, TaskKind, TaskSource
from service.requests.task_codec import encode_task
from tests.helpers.actors import info_of
from tests.helpers.changes import Found

LIMITS = Limits(body_bytes=2**20, cities=50, cells=100, preferences=99, size=9999, seconds=9)
INFOS = {kind: info_of(kind, kind) for kind in ("coordinates", "matrices")}
CELLS = [[0, 0], [0, 2], [2, 2], [2, 0]]
MAP = {"grid": [[0] * 3] * 3, "cell_size": 1, "cost_layer": [[1] * 3] * 3, "places": CELLS}
ROBOTS = {
    **{name: value for name, value in MAP.items() if name != "cost_layer"},
    "robots": [{"id": "one", "start": 0}, {"id": "two", "start": 2}],
}
FRONT = {"coordinates": np.eye(4).tolist()}
TOURS = np.array([[0, 1, 2, 3], [0, 2, 1, 3]])
FOUND = Found(TOURS, np.array([[1.0, 2.0], [2.0, 1.0]]), CELLS)


def stored(kind: TaskKind, request: dict[str, Any]) -> bytes:
    source = TaskSource(kind, json.dumps(request).encode())
    return encode_task(parse_task(source, LIMITS, INFOS))


def rest(task: bytes, found: Found = FOUND, limits: Limits = LIMITS) -> Task:
    front = StoredFront("the-front", task, found)
    return parse_replan(ReplanSource(b'{"done": [2]}', front), limits, INFOS)


@pytest.mark.parametrize(("kind", "request_"), [("front", FRONT), ("coverage", MAP)])
def test_fronts_and_what_was_replanned_of_them_are_replanned(
    kind: TaskKind, request_: dict[str, Any]
) -> None:
    replanned = rest(stored(kind, request_))
    assert isinstance(replanned.subject, Stops if kind == "front" else Coverage)
    assert isinstance(replanned.earlier, EarlierTours)
    again = rest(encode_task(replanned), _found_of(replanned))
    assert type(again.subject) is type(replanned.subject)


def _found_of(task: Task) -> Found:
    """The tours that are left, as if they were found anew."""
    assert task.earlier is not None
    tours = task.earlier.tours
    return Found(tours, np.arange(2.0 * len(tours)).reshape(-1, 2), CELLS)


@pytest.mark.parametrize(
    ("task", "reason"),
    [
        (stored("coverage", ROBOTS), "it is of plans for several robots"),
        (b"{}", "what it was planned from is damaged"),
        (b"\x80\x00", "what it was planned from is damaged"),
        (stored("front", {"coordinates": np.eye(4)[:3].tolist()}), "are not of its stops"),
    ],
    ids=["robots", "no task", "no JSON", "of others"],
)
def test_a_front_that_cannot_be_replanned_is_named_with_the_reason(
    task: bytes, reason: str
) -> None:
    with pytest.raises(Refusal) as refused:
        rest(task)
    assert refused.value.code == "not-replannable"
    assert "the-front" in refused.value.detail
    assert reason in refused.value.detail


@pytest.mark.parametrize(("kind", "request_"), [("front", FRONT), ("coverage", MAP)])
def test_a_front_without_a_tour_cannot_be_replanned(
    kind: TaskKind, request_: dict[str, Any]
) -> None:
    none = Found(np.empty((0, 4), np.int64), np.empty((0, 2)), CELLS)
    with pytest.raises(Refusal, match="it has no tour") as refused:
        rest(stored(kind, request_), none)
    assert refused.value.code == "not-replannable"


def test_where_no_actor_reads_what_is_left_the_request_is_refused() -> None:
    front = StoredFront("the-front", stored("front", FRONT), FOUND)
    body = b'{"costs": [{"objective": 0, "from": 1, "to": 2, "cost": 5}]}'
    planes = {"coordinates": INFOS["coordinates"]}
    assert parse_replan(ReplanSource(b"{}", front), LIMITS, planes).actor == "coordinates"
    with pytest.raises(Refusal) as refused:
        parse_replan(ReplanSource(body, front), LIMITS, planes)
    assert refused.value.code == "no-actor"
