"""DataFrames in place of arrays and of stops, in requests of the client."""

import json
from io import BytesIO
from typing import Any

import numpy as np
import pandas as pd
import pytest
from paretour import fleet_plan, front_plan

COSTS = pd.DataFrame([[0.0, 2.0], [3.0, 0.0]], index=["a", "b"], columns=["a", "b"])
STOPS = pd.DataFrame(
    {
        "ID": ["#1001", 7],
        "lat": [60.1, 60.2],
        "Lon": [24.9, 25.0],
        "demand": [3, None],
        "note": ["ring twice", ""],
    }
)


def test_a_frame_of_coordinates_is_its_rows() -> None:
    frame = pd.DataFrame([[0, 1, 2, 3], [4, 5, 6, 7]], columns=["x", "y", "u", "v"])
    assert json.loads(front_plan({"coordinates": frame}).json) == {
        "coordinates": [[0, 1, 2, 3], [4, 5, 6, 7]]
    }


def test_two_frames_of_costs_are_a_file() -> None:
    plan = front_plan({"matrices": [COSTS, 10 * COSTS]})
    assert plan.file is not None
    np.testing.assert_array_equal(
        np.load(BytesIO(plan.file.content)), np.stack([COSTS, 10 * COSTS])
    )


def test_an_infinite_cost_of_a_frame_is_null() -> None:
    request: Any = {
        "stops": STOPS,
        "objectives": [
            {"name": "way", "from": "great_circle"},
            {"name": "risk", "matrix": COSTS.replace(3.0, np.inf)},
        ],
    }
    body = json.loads(front_plan(request).json)
    assert body["objectives"][1]["matrix"] == [[0, 2], [None, 0]]
    assert body["stops"][0] == {"id": "#1001", "location": [24.9, 60.1], "demand": [3.0]}
    assert body["stops"][1] == {"id": "7", "location": [25.0, 60.2]}


def test_a_frame_of_stops_is_a_fleet_s_too() -> None:
    request: Any = {"stops": STOPS, "vehicles": [{"id": "van"}]}
    assert json.loads(fleet_plan(request).json)["stops"][0]["demand"] == [3.0]


def test_a_frame_of_stops_without_a_place_is_refused_with_what_it_lacks() -> None:
    request: Any = {"stops": STOPS.drop(columns="Lon")}
    with pytest.raises(ValueError, match=r"stops must have a column lon or lng or longitude, got"):
        front_plan(request)
