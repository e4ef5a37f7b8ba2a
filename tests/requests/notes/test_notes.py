"""Notes on requests of every kind: what is planned, and yet looks mistaken."""

import json
from typing import Any

import numpy as np
import pytest

from service.actor_info import RELEASED, read_actor_infos
from service.kinds.parsing import parse_task
from service.requests.notes.costs import notes_on_costs
from service.requests.notes.places import doubtful_places
from service.requests.task import Task, TaskKind, TaskSource
from service.requests.task_codec import decode_task, encode_task
from service.settings import Settings

INFOS = {info.name: info for info in read_actor_infos(RELEASED).values()}
LIMITS = Settings().limits
HELSINKI = [[24.94, 60.17], [24.96, 60.18], [24.9, 60.2], [24.97, 60.16], [25.01, 60.19]]
SWAPPED = [place[::-1] for place in HELSINKI]
MEASURES = [{"name": "metres", "from": "great_circle"}, {"name": "time", "from": "great_circle"}]


def parsed(kind: TaskKind, request: dict[str, Any]) -> Task:
    return parse_task(TaskSource(kind, json.dumps(request).encode()), LIMITS, INFOS)


def stops_at(places: list[list[float]]) -> list[dict[str, Any]]:
    return [{"id": f"s{number}", "location": place} for number, place in enumerate(places)]


def of_stops(kind: TaskKind, places: list[list[float]]) -> Task:
    fleet = {"vehicles": [{"id": "van", "start": "s0"}]} if kind == "fleet" else {}
    return parsed(kind, {"stops": stops_at(places), "objectives": MEASURES, **fleet})


@pytest.mark.parametrize("kind", ["front", "fleet"])
@pytest.mark.parametrize(
    ("places", "code", "pointer", "text"),
    [
        (SWAPPED, "swapped", "/stops", "at sea or in Antarctica, and on land with latitude and"),
        ([*HELSINKI, [0, 0]], "place", "/stops/5/location", "'s5' lies at longitude 0 and"),
        ([*HELSINKI, [60.17, 24.94]], "swapped", "/stops/5/location", "far from most others"),
        ([*HELSINKI, [139.7, 35.7]], "far", "/stops/5/location", "more than 1000 km"),
        ([*HELSINKI, [27.5, 62.9]], "outlier", "/stops/5/location", "from the nearest other stop"),
    ],
)
def test_places_that_look_mistaken_are_noted(
    kind: TaskKind, places: list[list[float]], code: str, pointer: str, text: str
) -> None:
    task = of_stops(kind, places)
    [note] = task.notes
    assert (note.code, note.pointer) == (code, pointer)
    assert text in note.text
    assert decode_task(encode_task(task)).notes == task.notes


@pytest.mark.parametrize("kind", ["front", "fleet"])
def test_ordinary_places_are_not(kind: TaskKind) -> None:
    assert of_stops(kind, HELSINKI).notes == ()


@pytest.mark.parametrize(
    ("longitude", "latitude"),
    [
        *[(13.4, 52.5), (2.35, 48.86), (-0.13, 51.5), (-3.7, 40.4), (-74, 40.7), (77.2, 28.6)],
        *[(-46.6, -23.5), (36.8, -1.3), (12.5, 41.9), (29, 41), (-87.6, 41.9)],
        *[(-15.4, 28.1), (-17, 32.7), (-23.5, 14.9), (14.5, 35.9)],  # islands
        *[(2, 58), (-40, 45)],  # ships
    ],
)
def test_cities_islands_and_ships_are_taken_as_they_are(longitude: float, latitude: float) -> None:
    places = np.array([longitude, latitude]) + np.random.default_rng(1).normal(0, 0.02, (8, 2))
    assert list(doubtful_places([str(n) for n in range(8)], places)) == []


@pytest.mark.parametrize(
    ("longitude", "latitude"),
    [(13.4, 52.5), (2.35, 48.86), (-0.13, 51.5), (-3.7, 40.4), (-74, 40.7), (77.2, 28.6)],
)
def test_all_places_of_a_city_that_are_swapped_are_noted(longitude: float, latitude: float) -> None:
    places = np.array([latitude, longitude]) + np.random.default_rng(1).normal(0, 0.02, (8, 2))
    [doubt] = doubtful_places([str(n) for n in range(8)], places)
    assert (doubt.code, doubt.at) == ("swapped", list(range(8)))


def costs(big: float, times: int, usual: float = 10.0) -> np.ndarray:
    matrix = np.full((8, 8), usual) + np.arange(8)
    matrix.ravel()[1 : 1 + times] = big
    np.fill_diagonal(matrix, big)
    return matrix


@pytest.mark.parametrize(
    ("matrix", "noted"),
    [
        (costs(2147483647.0, 3), "3 costs of 'time' are 2147483647, more than 1000 times"),
        (costs(1e7, 2), "2 costs of 'time' are 10000000"),
        (costs(99999.5, 5), "5 costs of 'time' are 99999.5"),
        (costs(1e7, 8 * 6), "43 costs of 'time' are 10000000"),  # most of all legs
        (costs(1e7, 1), None),  # once: a cost
        (costs(5e3, 6), None),  # not as large
        (costs(np.inf, 6), None),
        (costs(0.0, 6), None),
        (costs(1e7, 64, 0.0), None),  # no other cost
    ],
)
def test_huge_costs_that_come_again_are_noted(matrix: np.ndarray, noted: str | None) -> None:
    found = list(notes_on_costs(matrix, "'time'"))
    assert len(found) == (noted is not None)
    assert all(text.startswith(noted or "") and "write null" in text for text in found)


def test_a_note_on_costs_points_to_their_matrix() -> None:
    usual, big = costs(11.0, 1), costs(1e7, 3)
    task = parsed("front", {"matrices": [usual.tolist(), big.tolist()]})
    assert [(note.code, note.pointer) for note in task.notes] == [("large-costs", "/matrices/1")]
    objectives = [{"name": name, "matrix": m.tolist()} for name, m in (("a", big), ("b", usual))]
    request = {"stops": [{"id": str(n)} for n in range(8)], "objectives": objectives}
    [note] = parsed("front", request).notes
    assert note.pointer == "/objectives/0"
    assert "costs of 'a' are" in note.text
    [note] = parsed("fleet", {**request, "vehicles": [{"id": "van", "start": "0"}]}).notes
    assert note.pointer == "/objectives/0"
