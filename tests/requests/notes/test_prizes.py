"""Prizes for which no visit pays are noted, over HTTP as elsewhere; others are not."""

import json
from typing import Any

import pytest

from service.kinds.parsing import parse_task
from service.requests.task import TaskSource
from tests.helpers.serving import ACTORS, LIMITS

INFO = {actor.info.name: actor.info for actor in ACTORS}
WAY: dict[str, Any] = {"name": "way", "from": "great_circle"}
LONGEST: dict[str, Any] = {**WAY, "name": "longest", "over": "max"}
UNASSIGNED = {"name": "left", "measure": "unassigned"}
MATRIX: dict[str, Any] = {"name": "way", "matrix": [[0, 5, 9], [5, 0, 9], [9, 9, 0]]}
PLANE: dict[str, Any] = {"name": "way", "coordinates": [[0, 0], [0, 5], [9, 0]]}
VAN: dict[str, Any] = {"id": "van", "start": "d", "end": "d"}


def notes(*prizes: float | None, first: dict[str, Any] = WAY, **members: Any) -> list[str]:
    stops: list[dict[str, Any]] = [{"id": "d", "location": [24.941, 60.171]}]
    places = ([24.952, 60.169], [24.933, 60.165])
    for name, place, prize in zip("ab", places, prizes, strict=True):
        stops.append({"id": name, "location": place} | ({} if prize is None else {"prize": prize}))
    objectives = [first, {**first, "name": "longest", "over": "max"}]
    body = {"stops": stops, "vehicles": [VAN], "objectives": objectives, **members}
    task = parse_task(TaskSource("fleet", json.dumps(body).encode()), LIMITS, INFO)
    assert all(note.pointer == "/stops" for note in task.notes)
    return [note.text for note in task.notes if note.code == "prizes"]


@pytest.mark.parametrize(
    ("found", "text"),
    [
        (notes(100, 80), "'a' has a prize of 100, and a visit to it alone costs 1295.59"),
        (notes(9, 9, first=MATRIX), "'a' has a prize of 9, and a visit to it alone costs 10 or"),
        (notes(9, 9, first=PLANE), "'a' has a prize of 9, and a visit to it alone costs 10 or"),
        (notes(4, 3, first=MATRIX, vehicles=[{"id": "v", "start": "d"}]), "alone costs 5 or"),
        (notes(19, 19, first=MATRIX, vehicles=[{**VAN, "fixed": 10}]), "alone costs 20 or"),
        (notes(0, 9, first=MATRIX), "'b' has a prize of 9, and a visit to it alone costs 18"),
    ],
)
def test_prizes_for_which_no_visit_pays_are_noted(found: list[str], text: str) -> None:
    assert len(found) == 1
    assert found[0].startswith("No stop pays for itself: ")
    assert text in found[0]


@pytest.mark.parametrize(
    "found",
    [
        notes(None, None),
        notes(100, None),
        notes(0, 0),
        notes(2000, 80),
        notes(10, 9, first=MATRIX),
        notes(9, 18, first=MATRIX),
        notes(9, 9, first=MATRIX, vehicles=[{"id": "van"}]),
        notes(19, 19, first=MATRIX, vehicles=[VAN, {**VAN, "id": "dear", "fixed": 99}]),
        notes(100, 80, objectives=[WAY, UNASSIGNED]),
    ],
)
def test_prizes_that_pay_are_not_noted(found: list[str]) -> None:
    assert found == []
