"""Coverage requests: maps, places and second objectives, and every refusal of them."""

import io
import json
from typing import Any

import numpy as np
import pytest
from PIL import Image

from service.errors import Refusal
from service.requests.coverage import parse_coverage_request
from service.requests.json_schemas import form_schemas
from tests.helpers.serving import LIMITS

GRID = [
    [0, 0, 0, 0, 0, 0],
    [0, 0, 0, 0, 0, 0],
    [1, 1, 1, 1, 0, 0],
    [0, 0, 0, 0, 0, 0],
    [0, 0, 0, 0, 0, 0],
]
PLACES = [[0, 0], [4, 0], [4, 5], [0, 5], [3, 2]]
POINTS = [[0, 0], [3, 4], [5, 5], [1, 0], [2, 2]]
TASK = {"grid": GRID, "cell_size": 0.5, "places": PLACES, "second_coordinates": POINTS}


def body(**members: Any) -> bytes:
    """The task with other members, and without those that are None."""
    changed = {name: value for name, value in {**TASK, **members}.items() if value is not None}
    return json.dumps(changed).encode()


def refusal(body: bytes, png: bytes | None = None) -> Refusal:
    with pytest.raises(Refusal) as refused:
        parse_coverage_request(body, LIMITS, png)
    return refused.value


def test_a_request_becomes_a_coverage_task() -> None:
    coverage = parse_coverage_request(body(start=2), LIMITS).coverage()
    np.testing.assert_array_equal(coverage.blocked, np.array(GRID, dtype=np.bool_))
    np.testing.assert_array_equal(coverage.places, PLACES)
    np.testing.assert_array_equal(coverage.second_coordinates, POINTS)
    assert (coverage.cell_size, coverage.robot_radius, coverage.start) == (0.5, 0.0, 2)
    assert (coverage.spacing, coverage.second_matrix, coverage.cost_layers) == (None, None, None)


@pytest.mark.parametrize(
    ("change", "pointer", "sentence"),
    [
        (
            {"grid": None},
            "/grid",
            "grid is required, as rows, as occupancy_grid or as the part map",
        ),
        ({"grid": []}, "/grid", "grid must have a row of numbers or more, got none"),
        ({"grid": [[0, 0], [0]]}, "/grid/1", "grid/1 must have 2 numbers, as the first, got 1"),
        ({"grid": [[0, 2]]}, "/grid/0/1", "grid/0/1 must be 0 or 1, got 2"),
        ({"grid": [[0, "x"]]}, "/grid/0/1", 'grid/0/1 must be a valid number, got "x"'),
        ({"cell_size": None}, "/cell_size", "cell_size is required"),
        ({"cell_size": 0}, "/cell_size", "cell_size must be at least 1e-150, got 0"),
        ({"robot_radius": -1}, "/robot_radius", "robot_radius must be at least 0, got -1"),
        ({"places": [[0, 0, 0]]}, "/places/0", "places/0 must have 2 items, got 3"),
        ({"places": [[0, 0.5]]}, "/places/0/1", "places/0/1 must be a valid integer, got 0.5"),
        ({"start": 5}, "/start", "start must be a city, 0 to 4, got 5"),
        (
            {"second_coordinates": None, "second_matrix": [[0, 1], [1]]},
            "/second_matrix/1",
            "second_matrix/1 must have 2 numbers, as the first, got 1",
        ),
        (
            {"second_coordinates": None, "second_matrix": [[0, 1]]},
            "/second_matrix",
            "second_matrix must be square, got 1 rows of 2 numbers",
        ),
        (
            {"second_coordinates": None, "second_matrix": [[0, 1], [-1, 0]]},
            "/second_matrix/1/0",
            "second_matrix/1/0 must not be negative, got -1.0",
        ),
        (
            {"places": None, "spacing": 1, "initial_tours": [[0]]},
            "/initial_tours",
            "initial_tours must be of places, and none are given",
        ),
    ],
)
def test_what_is_no_coverage_request_is_named(
    change: dict[str, Any], pointer: str, sentence: str
) -> None:
    refused = refusal(body(**change))
    assert (refused.code, refused.errors[0].pointer) == ("invalid-request", pointer)
    assert refused.detail == sentence


@pytest.mark.parametrize("number", ["NaN", "Infinity", "1e400"])
@pytest.mark.parametrize("member", ["second_matrix", "second_coordinates", "grid"])
def test_what_is_not_finite_is_named(member: str, number: str) -> None:
    rows = [[0, "!"], [0, 0]]
    text = body(**{"second_coordinates": None, "places": [[0, 0], [0, 1]], member: rows})
    refused = refusal(text.replace(b'"!"', number.encode()))
    assert refused.errors[0].pointer == f"/{member}/0/1"


def test_a_grid_of_too_many_cells_is_refused() -> None:
    refused = refusal(body(grid=[[0] * 100] * 10))
    assert (refused.status, refused.code) == (413, "too-many-cells")
    assert (refused.limit, refused.actual) == (LIMITS.cells, 1000)


def test_too_many_places_are_refused() -> None:
    refused = refusal(body(places=[[0, 0]] * 51))
    assert (refused.status, refused.code) == (413, "too-many-cities")
    assert refused.detail == "places must have at most 50 rows, got 51"


def test_a_map_may_come_as_a_png_and_not_as_a_grid_as_well() -> None:
    stream = io.BytesIO()
    Image.fromarray((255 * (1 - np.array(GRID))).astype(np.uint8)).save(stream, "PNG")
    request = parse_coverage_request(body(grid=None), LIMITS, stream.getvalue())
    np.testing.assert_array_equal(request.grid, GRID)
    refused = refusal(body(), stream.getvalue())
    assert refused.detail == "grid must come once, got it as grid and as the part map"


def test_the_schema_asks_for_places_and_a_second_objective_in_one_form_each() -> None:
    schema = form_schemas(LIMITS, ["pa-one-matrix"])["CoverageRequest"]
    ways = [[each["required"] for each in choice["oneOf"]] for choice in schema["allOf"]]
    assert ways == [
        [["grid", "cell_size"], ["occupancy_grid"]],
        [["places"], ["spacing"]],
        [["second_matrix"], ["cost_layer"], ["cost_layers"], ["second_coordinates"], ["robots"]],
    ]
    assert schema["properties"]["places"]["maxItems"] == LIMITS.cities
