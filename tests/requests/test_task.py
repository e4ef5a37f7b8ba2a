"""A body becomes a task, and an actor is chosen for it."""

import json
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from service.actor_info import ActorInfo
from service.coverage.survey import Coverage
from service.errors import InvalidCoverage, Refusal
from service.kinds.parsing import parse_task
from service.kinds.table import is_brief, parts_of
from service.requests.parser import choose_actor
from service.requests.stops import Stops
from service.requests.task import Task, TaskSource
from tests.helpers.actors import info_of
from tests.helpers.serving import LIMITS

FACTS = {
    "pa-one": info_of("pa-one", "coordinates", repairs=True),
    "pa-one-matrix": info_of("pa-one-matrix", "matrices", repairs=True),
}
COVERAGE = {
    "grid": [[0, 0]],
    "cell_size": 1,
    "places": [[0, 0], [0, 1]],
    "second_coordinates": [[0, 0], [1, 1]],
    "paths": True,
}


def test_a_body_becomes_a_task() -> None:
    task = parse_front({"coordinates": np.eye(4).tolist(), "repairs": 2, "time_limit": 0})
    assert isinstance(task.subject, Stops)
    assert (task.actor, task.options.repairs, task.paths) == ("pa-one", 2, False)
    assert parts_of(task)  # twice 20 preferences make more tours than the limit of 30
    task = parse_task(TaskSource("coverage", json.dumps(COVERAGE).encode()), LIMITS, FACTS)
    assert isinstance(task.subject, Coverage)
    assert (task.actor, task.paths, bool(parts_of(task))) == ("pa-one-matrix", True, True)


@pytest.mark.parametrize(
    ("cities", "options", "brief"),
    [
        (250, {}, True),
        (251, {}, False),  # 20 preferences each
        (3, {"repairs": 1}, False),
        (3, {"time_limit": 0.01}, False),
        (3, {"size": 19}, False),  # the best subset is chosen by compiled code
    ],
)
def test_a_task_is_brief_where_one_short_call_of_a_network_does_it(
    cities: int, options: dict[str, object], brief: bool
) -> None:
    coordinates = np.random.default_rng(0).random((cities, 4)).tolist()
    request = {"coordinates": coordinates, "time_limit": 0, "repairs": 0, **options}
    source = TaskSource("front", json.dumps(request).encode())
    assert is_brief(parse_task(source, replace(LIMITS, cities=300), FACTS)) == brief


MATRIX = [[0, 2, 3], [4, 0, 1], [5, 2, 0]]  # least out of each city: 2 + 1 + 2; into: 4 + 2 + 1
CITIES = [[0, 0, 0, 0], [3, 1, 1, 2], [1, 2, 2, 5]]  # longer sides of the planes: 3 and 5


@pytest.mark.parametrize("cities", [{"coordinates": CITIES}, {"matrices": [MATRIX, MATRIX]}])
@pytest.mark.parametrize("objective", [0, 1])
def test_a_reference_point_that_plainly_no_tour_comes_below_is_refused(
    cities: dict[str, object], objective: int
) -> None:
    least = (6, 10) if "coordinates" in cities else (7, 7)
    point = [100.0, 100.0]
    point[objective] = least[objective]
    with pytest.raises(Refusal) as refused:
        parse_front({**cities, "reference_point": point})
    assert refused.value.code == "invalid-request"
    [fault] = refused.value.document("x")["errors"]
    assert fault["pointer"] == f"/reference_point/{objective}"
    assert f"must be more than {least[objective]}, " in fault["detail"]
    point[objective] *= 1.001
    assert parse_front({**cities, "reference_point": point}).options.reference_point is not None


@pytest.mark.parametrize("cities", [CITIES[:1], CITIES[:1] * 3])
def test_any_reference_point_is_above_tours_of_no_length(cities: list[list[int]]) -> None:
    parse_front({"coordinates": cities, "reference_point": [1e-150, 1e-150]})


def parse_front(request: dict[str, object], facts: Mapping[str, ActorInfo] = FACTS) -> Task:
    return parse_task(TaskSource("front", json.dumps(request).encode()), LIMITS, facts)


@pytest.mark.parametrize(
    ("request_", "repairs", "fewer"),
    [
        ({}, 0, True),
        ({"time_limit": 0}, LIMITS.repairs, True),
        ({"time_limit": 0, "repairs": 7}, 7, False),
        ({"time_limit": 0.1, "repairs": 7}, 7, False),
        ({"time_limit": 0, "augment": 8}, LIMITS.repairs, True),
    ],
)
def test_repairs_are_as_many_as_asked_for_or_with_a_time_limit_none(
    request_: dict[str, object], repairs: int, fewer: bool
) -> None:
    options = parse_front({"coordinates": CITIES, **request_}).options
    assert (options.repairs, options.fewer_repairs) == (repairs, fewer)


def test_more_repairs_than_the_limit_are_refused() -> None:
    with pytest.raises(Refusal, match=f"repairs must be at most {LIMITS.repairs}, got ") as refused:
        parse_front({"coordinates": CITIES, "repairs": LIMITS.repairs + 1})
    assert refused.value.code == "over-limit"


def test_repairs_are_refused_where_the_actor_makes_none_and_not_made_by_default() -> None:
    facts = {"own": info_of("own", "matrices")}
    asked = {"coordinates": CITIES, "time_limit": 0}
    assert parse_front(asked, facts).options.repairs == 0
    assert parse_front({**asked, "repairs": 0}, facts).options.repairs == 0
    with pytest.raises(Refusal) as refused:
        parse_front({**asked, "repairs": 3}, facts)
    assert (refused.value.status, refused.value.code) == (422, "no-repairs")
    assert refused.value.detail == "repairs must be 0 for own, which cannot repair tours, got 3"


def test_what_cannot_be_planned_is_refused() -> None:
    ambiguous = json.dumps({**COVERAGE, "spacing": 1}).encode()
    with pytest.raises(InvalidCoverage, match="places or spacing is required, and not both"):
        parse_task(TaskSource("coverage", ambiguous), LIMITS, FACTS)


@pytest.mark.parametrize(
    ("loaded", "kind", "name", "code", "detail"),
    [
        (
            ["pa-one", "pa-one-matrix"],
            "coordinates",
            "pa-two",
            "unknown-actor",
            "actor must be one of pa-one, pa-one-matrix, got 'pa-two'",
        ),
        (
            ["pa-one", "pa-one-matrix"],
            "matrices",
            "pa-one",
            "unfit-actor",
            "actor must read matrices, as one of pa-one-matrix; pa-one reads coordinates alone",
        ),
        (
            ["pa-one"],
            "matrices",
            None,
            "no-actor",
            "matrices need an actor that reads them, and none is loaded",
        ),
        (
            ["pa-one"],
            "matrices",
            "pa-one",
            "unfit-actor",
            "actor must read matrices, as one that is loaded, and none is; "
            "pa-one reads coordinates alone",
        ),
    ],
)
def test_an_actor_that_cannot_be_had_is_refused(
    loaded: list[str], kind: str, name: str | None, code: str, detail: str
) -> None:
    actors = {each: FACTS[each] for each in loaded}
    with pytest.raises(Refusal) as refused:
        choose_actor(actors, kind, name)  # type: ignore[arg-type]
    assert (refused.value.status, refused.value.code) == (422, code)
    assert refused.value.detail == detail


def test_an_actor_of_matrices_serves_coordinates_where_it_is_asked_to() -> None:
    assert choose_actor(FACTS, "coordinates", "pa-one-matrix") == "pa-one-matrix"


def test_where_the_default_is_not_loaded_another_that_serves_takes_its_place() -> None:
    own = {"own": info_of("own", "matrices")}
    assert choose_actor(own, "matrices", None) == "own"
    assert choose_actor(own, "coordinates", None) == "own"
