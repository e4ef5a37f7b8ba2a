"""The fields of a request about its map: which go together, and what they make of it."""

import json
from typing import Any

import numpy as np
import pytest

from service.errors import Refusal
from service.requests.coverage import CoverageRequest, parse_coverage_request
from service.requests.json_schemas import form_schemas
from tests.helpers.serving import LIMITS
from tests.requests.maps.test_occupancy_grid import MESSAGE

REST: dict[str, Any] = {"places": [[0, 0], [0, 1]], "second_coordinates": [[0, 0], [1, 1]]}
THRESHOLDS = {"occupied_thresh": 0.65, "free_thresh": 0.196}
# Free, grey 205, a grey between the thresholds, occupied; and a row of free cells.
PGM = b"P5 4 2 255\n" + bytes([254, 205, 150, 0, 254, 254, 254, 254])


def parsed(picture: bytes | None = None, **members: Any) -> CoverageRequest:
    return parse_coverage_request(json.dumps({**REST, **members}).encode(), LIMITS, picture)


def top_row(**members: Any) -> list[float]:
    return parsed(PGM, cell_size=0.05, **members).grid[0].tolist()


def test_unknown_cells_of_a_picture_are_blocked_unless_they_shall_be_free() -> None:
    assert top_row() == [0, 1, 0, 1]
    assert top_row(unknown="free") == [0, 0, 0, 1]
    assert top_row(**THRESHOLDS) == [0, 1, 1, 1]
    assert top_row(**THRESHOLDS, unknown="free") == [0, 0, 0, 1]


def test_the_threshold_of_a_picture_is_a_field() -> None:
    assert top_row(occupied_thresh=0.4) == [0, 1, 1, 1]
    assert top_row(occupied_thresh=0.004) == [0, 1, 1, 1]
    assert top_row(occupied_thresh=0.003) == [1, 1, 1, 1]


def test_modes_and_negation_are_fields() -> None:
    assert top_row(**THRESHOLDS, negate=True) == [1, 1, 1, 0]
    # In mode scale grey 205 has an occupancy of 0 and grey 150 one of 47.
    assert top_row(**THRESHOLDS, mode="scale") == [0, 0, 0, 1]
    assert top_row(**THRESHOLDS, mode="scale", obstacle_from=47) == [0, 0, 1, 1]
    assert top_row(mode="raw") == [1, 1, 1, 0]


def test_cells_of_a_message_are_blocked_from_an_occupancy_on() -> None:
    request = parsed(occupancy_grid=MESSAGE)
    np.testing.assert_array_equal(request.grid, [[1, 1, 1], [0, 0, 0]])
    assert (request.cell_size, request.origin) == (0.5, [-1.5, 2.0, 0.0])
    request = parsed(occupancy_grid=MESSAGE, obstacle_from=51, unknown="free")
    np.testing.assert_array_equal(request.grid, [[1, 0, 0], [0, 0, 0]])
    request = parsed(occupancy_grid=MESSAGE, obstacle_from=1)
    np.testing.assert_array_equal(request.grid, [[1, 1, 1], [0, 1, 1]])


GRID = {"grid": [[0, 0]], "cell_size": 1}


@pytest.mark.parametrize(
    ("members", "picture", "sentence"),
    [
        ({"cell_size": 1}, None, "grid is required, as rows, as occupancy_grid or as the part map"),
        ({**GRID, "occupancy_grid": MESSAGE}, None, "got it as grid and as occupancy_grid"),
        (GRID, PGM, "grid must come once, got it as grid and as the part map"),
        ({"occupancy_grid": MESSAGE}, PGM, "got it as occupancy_grid and as the part map"),
        ({"grid": [[0]]}, None, "cell_size is required"),
        ({}, PGM, "cell_size is required"),
        ({**GRID, "mode": "raw"}, None, "mode must be left out where the map comes as grid"),
        ({**GRID, "unknown": "free"}, None, "unknown must be left out where the map comes as grid"),
        (
            {"occupancy_grid": MESSAGE, "cell_size": 1},
            None,
            "cell_size must be left out where the map comes as occupancy_grid",
        ),
        ({"occupancy_grid": MESSAGE, "origin": [0, 0, 0]}, None, "origin must be left out"),
        ({"occupancy_grid": MESSAGE, "negate": True}, None, "negate must be left out"),
        ({"cell_size": 1, "free_thresh": 0.2}, PGM, "occupied_thresh is required in mode trinary"),
        (
            {"cell_size": 1, "mode": "scale", "occupied_thresh": 0.2},
            PGM,
            "free_thresh is required in mode scale",
        ),
        (
            {"cell_size": 1, "free_thresh": 0.7, "occupied_thresh": 0.65},
            PGM,
            "free_thresh must be less than occupied_thresh, which is 0.65, got 0.7",
        ),
        ({"cell_size": 1, "mode": "binary"}, PGM, "mode must be 'trinary', 'scale' or 'raw'"),
        ({"cell_size": 1, "occupied_thresh": 2}, PGM, "occupied_thresh must be at most 1, got 2"),
        ({"cell_size": 1, "obstacle_from": 0}, PGM, "obstacle_from must be at least 1, got 0"),
        ({"cell_size": 1, "unknown": 1}, PGM, "unknown must be 'blocked' or 'free', got 1"),
        ({**GRID, "origin": [0, 0]}, None, "origin must have 3 items, got 2"),
        ({"occupancy_grid": 1}, None, "occupancy_grid must be"),
        ({"occupancy_grid": {"data": [0]}}, None, "occupancy_grid/info is required"),
    ],
)
def test_what_does_not_go_together_is_named(
    members: dict[str, Any], picture: bytes | None, sentence: str
) -> None:
    with pytest.raises(Refusal) as refused:
        parsed(picture, **members)
    assert sentence in refused.value.detail


def test_the_schema_has_the_limit_of_cells() -> None:
    schema = form_schemas(LIMITS, ["pa-one-matrix"])["OccupancyGrid"]
    data = schema["properties"]["data"]
    assert data["maxItems"] == LIMITS.cells
