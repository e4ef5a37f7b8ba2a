"""What a request to plan says on its way to the service."""

import json
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from paretour import coverage_plan, front_plan, replan_plan

CITIES = np.random.default_rng(3).random((12, 4))


def test_arrays_travel_as_numbers() -> None:
    plan = front_plan(
        {"coordinates": CITIES[:2], "preferences": np.array([1.5]), "seed": np.int64(3)}
    )
    sent = json.loads(plan.body["content"])
    assert plan.path == "/front"
    assert sent == {"coordinates": CITIES[:2].tolist(), "preferences": [1.5], "seed": 3}


def test_matrices_that_are_an_array_travel_as_a_file() -> None:
    matrices = np.arange(18.0).reshape(2, 3, 3)
    parts = front_plan({"matrices": matrices, "size": 5}).body["files"]
    assert json.loads(parts["request"][1]) == {"size": 5}
    np.testing.assert_array_equal(np.load(BytesIO(parts["matrices"][1])), matrices)


def test_two_objectives_whose_matrices_are_arrays_travel_as_a_file() -> None:
    costs = np.arange(9.0).reshape(3, 3)
    stops: Any = [{"id": "a"}, {"id": "b"}, {"id": "c"}]
    objectives: Any = [
        {"name": "time", "unit": "s", "matrix": costs},
        {"name": "r", "matrix": costs.T},
    ]
    parts = front_plan({"stops": stops, "objectives": objectives}).body["files"]
    named = [{"name": "time", "unit": "s"}, {"name": "r"}]
    assert json.loads(parts["request"][1]) == {"stops": stops, "objectives": named}
    np.testing.assert_array_equal(np.load(BytesIO(parts["matrices"][1])), [costs, costs.T])


@pytest.mark.parametrize(
    "second",
    [
        {"name": "r", "from": "great_circle"},
        {"name": "r", "matrix": [[0, 1], [1, 0]]},
        {"name": "r", "matrix": np.zeros((3, 3))},
    ],
)
def test_other_objectives_travel_as_json(second: Any) -> None:
    first: Any = {"name": "time", "matrix": np.array([[0.0, 2.0], [2.0, 0.0]])}
    plan = front_plan({"stops": [{"id": "a"}, {"id": "b"}], "objectives": [first, second]})
    assert plan.file is None
    assert json.loads(plan.json)["objectives"][0]["matrix"] == [[0, 2], [2, 0]]


@pytest.mark.parametrize(
    "matrix",
    [
        np.array([[0.0, np.inf], [2.0, 0.0]]),
        np.array([[0, None], [2, 0]]),
        [[0, None], [2, 0]],
        [[0, np.inf], [np.float64(2), 0]],
    ],
)
def test_where_there_is_no_way_json_has_null(matrix: Any) -> None:
    objectives: Any = [{"name": "t", "matrix": matrix}, {"name": "r", "from": "great_circle"}]
    plan = front_plan({"stops": [{"id": "a"}, {"id": "b"}], "objectives": objectives})
    assert json.loads(plan.json)["objectives"][0]["matrix"] == [[0, None], [2, 0]]
    of_map: Any = {"second_matrix": matrix}
    assert json.loads(coverage_plan(of_map, None).json) == {"second_matrix": [[0, None], [2, 0]]}
    closed: Any = {"costs": [{"objective": 0, "from": "a", "to": "b", "cost": np.inf}]}
    assert json.loads(replan_plan("id", closed).json)["costs"][0]["cost"] is None


def test_arrays_with_none_travel_as_json_and_with_infinity_as_a_file() -> None:
    matrices = np.full((2, 3, 3), np.inf)
    parts = front_plan({"matrices": matrices}).body["files"]
    np.testing.assert_array_equal(np.load(BytesIO(parts["matrices"][1])), matrices)
    plan = front_plan({"matrices": np.full((2, 3, 3), None)})
    assert plan.file is None
    assert json.loads(plan.json)["matrices"] == np.full((2, 3, 3), None).tolist()


def test_other_numbers_travel_as_they_are_for_the_service_to_refuse() -> None:
    assert front_plan({"coordinates": [[0, 0, 0, np.inf]]}).json == (
        b'{"coordinates": [[0, 0, 0, Infinity]]}'
    )
    assert front_plan({"matrices": [[[np.nan]], [[0]]]}).json == b'{"matrices": [[[NaN]], [[0]]]}'


def test_a_map_is_a_file_or_a_grid() -> None:
    of_picture, of_grid = coverage_plan({}, b"PNG"), coverage_plan({"grid": [[0]]}, None)
    assert of_picture.path == of_grid.path == "/coverage"
    assert of_picture.body["files"]["map"] == ("map", b"PNG")
    assert json.loads(of_grid.body["content"]) == {"grid": [[0]]}


@pytest.mark.parametrize(
    ("request_", "seconds"),
    [
        ({}, 1),
        ({"time_limit": 60}, 60),
        ({"time_limit": 2, "bound": True}, 7),
        ({"time_limit": "long"}, 1),
    ],
)
def test_a_plan_knows_how_long_it_may_take(request_: dict[str, Any], seconds: float) -> None:
    assert front_plan(request_).seconds == seconds  # type: ignore[arg-type]
