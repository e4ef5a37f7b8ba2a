"""A matrix in a DataFrame is aligned by its labels with the ids of the stops, or refused."""

import json
import re
from typing import Any

import numpy as np
import pandas as pd
import pytest
from paretour import fleet_plan, front_plan, plan

IDS = ["c", "a", "b"]
PLACES = {"a": [24.9, 60.1], "b": [24.8, 60.2], "c": [24.7, 60.3]}
STOPS = [{"id": each, "location": PLACES[each]} for each in IDS]
COSTS = pd.DataFrame(
    [[0, 1, 2], [3, 0, 4], [5, 6, 0]], index=["a", "b", "c"], columns=["a", "b", "c"]
)
ALIGNED = [[0, 5, 6], [2, 0, 1], [4, 3, 0]]  # from c, a, b to c, a, b
WAY = {"name": "way", "from": "great_circle"}


class Polars:
    """A DataFrame without an index, whose columns must have names."""

    def __init__(self, frame: pd.DataFrame, names: list[str]) -> None:
        self.columns = names
        self._cells = frame.to_numpy()

    def to_numpy(self) -> Any:
        return self._cells

    def __len__(self) -> int:
        return len(self._cells)


def sent(matrix: Any, stops: Any = STOPS) -> Any:
    objectives: Any = [WAY, {"name": "cost", "matrix": matrix}]
    return json.loads(front_plan({"stops": stops, "objectives": objectives}).json)["objectives"][1][
        "matrix"
    ]


FRAME_OF_STOPS = pd.DataFrame(
    {"id": IDS, "lon": [PLACES[each][0] for each in IDS], "lat": [PLACES[each][1] for each in IDS]}
)
INORDER = COSTS.loc[IDS, IDS]


@pytest.mark.parametrize("stops", [STOPS, FRAME_OF_STOPS], ids=["list", "frame"])
@pytest.mark.parametrize(
    "matrix",
    [
        COSTS,
        INORDER,
        COSTS[["b", "c", "a"]],
        COSTS.loc[["b", "c", "a"]],
        COSTS.astype(float),
        INORDER.reset_index(drop=True).set_axis(range(3), axis=1),  # without labels
        INORDER.set_axis(range(3), axis=1),  # labels of rows alone, in the order of the stops
        INORDER.reset_index(drop=True),
        Polars(INORDER, ["column_0", "column_1", "column_2"]),
        Polars(INORDER, IDS),
        INORDER.to_numpy(),
    ],
    ids=range(11),
)
def test_a_matrix_is_put_in_the_order_of_the_stops(matrix: Any, stops: Any) -> None:
    assert sent(matrix, stops) == ALIGNED


def test_labels_and_ids_may_be_numbers() -> None:
    stops = [{"id": each, "location": [24, 60 + int(each) / 10]} for each in ("30", "10", "20")]
    matrix = COSTS.set_axis([10.0, 20.0, 30.0]).set_axis([10, 20, 30], axis=1)
    assert sent(matrix, stops) == ALIGNED


@pytest.mark.parametrize(
    ("matrix", "sentence"),
    [
        (COSTS.rename(index={"a": "x"}), "matrix: row 'x' must be the id of a stop; ids are 'c'"),
        (COSTS.rename(columns={"b": "B"}), "matrix: column 'B' must be the id of a stop"),
        (COSTS.set_axis(["x", "y", "z"]).set_axis([*"xyz"], axis=1), "matrix: row 'x' must be"),
        (COSTS.set_axis([1, 2, 3]).set_axis([1, 2, 3], axis=1), "matrix: row '1' must be the id"),
        (COSTS.set_axis(["a", "b", "b"]), "matrix: row 'b' must come once"),
        (COSTS.loc[["a", "b"], ["a", "b"]], "matrix must have a row of stop 'c'"),
        (COSTS.set_axis(range(3), axis=1), "must name both its rows and its columns"),
        (COSTS.reset_index(drop=True), "must name both its rows and its columns"),
        (Polars(COSTS, ["a", "b", "c"]), "must name both its rows and its columns"),
        (Polars(COSTS, ["a", "b", "d"]), "matrix: column 'd' must be the id of a stop"),
    ],
)
def test_labels_that_are_not_the_ids_are_refused(matrix: Any, sentence: str) -> None:
    with pytest.raises(ValueError, match=re.escape(sentence)):
        sent(matrix)


def test_numbers_that_may_be_labels_or_none_are_refused() -> None:
    stops = [{"id": each, "location": [24, 60 + int(each) / 10]} for each in ("1", "0", "2")]
    matrix = COSTS.reset_index(drop=True).set_axis(range(3), axis=1)
    with pytest.raises(ValueError, match="counted from 0, and the stops have these numbers"):
        sent(matrix, stops)
    ordered = [{**each, "id": str(at)} for at, each in enumerate(stops)]
    assert sent(matrix, ordered) == COSTS.to_numpy().tolist()


def test_matrices_of_fleets_and_of_the_day_are_aligned() -> None:
    fleet: Any = {"stops": STOPS, "vehicles": [], "objectives": [{"name": "c", "matrix": COSTS}]}
    assert json.loads(fleet_plan(fleet).json)["objectives"][0]["matrix"] == ALIGNED
    slices = [{"from": 0, "matrix": COSTS}, {"from": 60, "matrix": INORDER}]
    day: Any = {"stops": STOPS, "objectives": [WAY, {"name": "c", "slices": slices}]}
    found = json.loads(front_plan(day).json)["objectives"][1]["slices"]
    assert [each["matrix"] for each in found] == [ALIGNED, ALIGNED]


@pytest.mark.parametrize(
    "second", [INORDER, COSTS.rename(index={"a": "x"}, columns={"a": "x"})], ids=["order", "names"]
)
def test_matrices_without_stops_must_have_the_same_labels(second: Any) -> None:
    with pytest.raises(ValueError, match="matrices must have the same labels in the same order"):
        front_plan({"matrices": [COSTS, second]})
    for same in (COSTS, COSTS.to_numpy(), COSTS.reset_index(drop=True).set_axis(range(3), axis=1)):
        assert front_plan({"matrices": [COSTS, same]}).file is not None


def test_a_tour_has_the_lengths_that_the_labels_say() -> None:
    rng = np.random.default_rng(0)
    ids = [f"s{at}" for at in range(6)]
    costs = pd.DataFrame(rng.integers(1, 99, (6, 6)), ids, ids)
    order = ["s3", "s0", "s5", "s1", "s4", "s2"]
    front = plan(
        stops=[{"id": each} for each in order],
        objectives=[{"name": "one", "matrix": costs}, {"name": "two", "matrix": costs.T}],
        time_limit=0.05,
    )
    for tour in front:
        assert tour.stops is not None
        legs = zip(tour.stops, [*tour.stops[1:], tour.stops[0]], strict=True)
        assert tour.lengths[0] == sum(costs.loc[a, b] for a, b in legs if a != b)
