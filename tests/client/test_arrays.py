"""Arrays of NumPy in requests: masked, of Decimal, and of what are no numbers."""

import datetime
import json
import re
from collections.abc import Callable
from decimal import Decimal
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from paretour import coverage_plan, fleet_plan, front_plan

MASKED = np.ma.masked_equal(np.array([[0, 2], [7, 0]]), 7)
LEGS = [[0, 2], [None, 0]]
STOPS = [{"id": "a", "location": [24.9, 60.1]}, {"id": "b", "location": [24.8, 60.2]}]
WAY = {"name": "way", "from": "great_circle"}


def matrix_of(matrix: Any) -> Any:
    objectives: Any = [WAY, {"name": "cost", "matrix": matrix}]
    plan = front_plan({"stops": STOPS, "objectives": objectives})
    return json.loads(plan.json)["objectives"][1]["matrix"]


@pytest.mark.parametrize(
    ("matrix", "legs"),
    [
        (MASKED, LEGS),
        (MASKED.astype(float), LEGS),
        (np.ma.masked_invalid([[0, 2], [np.inf, 0]]), LEGS),
        (np.ma.masked_invalid([[0, 2], [np.nan, 0]]), LEGS),
        (np.ma.array([[0, 2], [7, 0]]), [[0, 2], [7, 0]]),
        (np.ma.array([[0, Decimal(2)], [7, 0]], mask=[[0, 0], [1, 0]], dtype=object), LEGS),
        (np.array([[0, Decimal("2.5")], [None, 0]], dtype=object), [[0, 2.5], [None, 0]]),
        ([[0, Decimal("2.5")], [np.inf, 0]], [[0, 2.5], [None, 0]]),
        ([[0, Decimal("2.5")], [7, 0]], [[0, 2.5], [7, 0]]),
        ([[0, Decimal("Infinity")], [7, 0]], [[0, None], [7, 0]]),
        ([np.ma.array([0, 2], mask=[False, True]), [7, 0]], [[0, None], [7, 0]]),
        (np.array([[0, 2], [7, 0]], np.float16), [[0, 2], [7, 0]]),
    ],
)
def test_where_a_matrix_is_masked_there_is_no_way(matrix: Any, legs: Any) -> None:
    assert matrix_of(matrix) == legs


def test_masked_and_decimal_matrices_travel_as_a_file() -> None:
    decimals = np.array([[0, Decimal(2)], [Decimal(3), 0]])
    plan = front_plan({"matrices": [MASKED, decimals]})
    assert plan.file is not None
    found = np.load(BytesIO(plan.file.content))
    np.testing.assert_array_equal(found, [[[0, 2], [np.inf, 0]], [[0, 2], [3, 0]]])
    whole = front_plan({"matrices": np.ma.stack([MASKED, MASKED])})
    assert whole.file is not None
    assert np.isinf(np.load(BytesIO(whole.file.content))[1, 1, 0])


COMPLEX = np.ones((2, 2), complex)
DATES = np.array([["2026-11-22", "2026-11-23"]] * 2, "datetime64[D]")
LENGTHS = np.ones((2, 2), "timedelta64[s]")
RECORDS = np.zeros((2, 2), [("a", float)])
RAW = np.array([[b"1", b"2"]] * 2)
STRANGE = np.array([[0, datetime.date(2026, 1, 1)], [1, 0]], dtype=object)
PLANES = np.ma.array([[0.0, 1, 2, 3], [4, 5, 6, 7]], mask=[[0, 0, 0, 0], [0, 0, 0, 1]])


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: matrix_of(COMPLEX), "matrix must be numbers, got an array of complex128"),
        (lambda: matrix_of(DATES), "matrix must be numbers, got an array of datetime64[D]"),
        (lambda: matrix_of(LENGTHS), "matrix must be numbers, got an array of timedelta64[s]"),
        (lambda: matrix_of(RECORDS), "matrix must be numbers, got an array of [('a', '<f8')]"),
        (lambda: matrix_of(RAW), "matrix must be numbers, got an array of |S1"),
        (lambda: matrix_of(STRANGE), "matrix must be numbers, got datetime.date(2026, 1, 1)"),
        (lambda: front_plan({"coordinates": PLANES}), "coordinates must have no masked cells, got"),
        (lambda: front_plan({"coordinates": COMPLEX}), "coordinates must be numbers, got an array"),
        (lambda: front_plan({"matrices": [COMPLEX, COMPLEX]}), "matrices must be numbers, got an"),
        (lambda: coverage_plan({"grid": MASKED}, None), "grid must have no masked cells, got 1"),
        (
            lambda: front_plan({"stops": [{"id": "a", "location": np.ma.masked_all(2)}]}),
            "location must have no masked cells, got 2",
        ),
        (lambda: matrix_of([[0, 1j], [1, 0]]), "got 1j of type complex"),
        (lambda: matrix_of([[0, np.complex128(1j)], [1, 0]]), "1j"),
        (lambda: matrix_of([[0, np.datetime64("2026")], [1, 0]]), "of type datetime64"),
        (lambda: front_plan({"size": datetime.date(2026, 1, 1)}).json, "of type date"),  # type: ignore[typeddict-item]
        (lambda: front_plan({"size": {1}}).json, "got {1} of type set"),  # type: ignore[typeddict-item]
        (lambda: fleet_plan({"stops": [{"id": b"a"}]}).json, "got b'a' of type bytes"),  # type: ignore[typeddict-item]
    ],
)
def test_what_is_no_number_is_refused_in_a_sentence(
    make: Callable[[], object], sentence: str
) -> None:
    with pytest.raises(ValueError, match=re.escape(sentence)) as refused:
        make()
    assert len(str(refused.value)) < 250


class Tensor:
    """An array of another library."""

    def tolist(self) -> list[list[float]]:
        return [[0, 2], [float("inf"), 0]]


def test_arrays_of_others_are_sent_as_lists() -> None:
    assert matrix_of(Tensor()) == LEGS
