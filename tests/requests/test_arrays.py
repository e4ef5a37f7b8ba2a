"""Arrays in requests: matrices from rows of numbers, and every refusal of them."""

import numpy as np
import pytest

from service.errors import Refusal
from service.requests.arrays import check_costs, cost_matrix, stack_matrices

COSTS = np.random.default_rng(6).random((2, 12, 12))
SQUARE = [[0.0, 1, 2], [1, 0, 3], [2, 3, 0]]


def test_matrices_are_stacked() -> None:
    expected = COSTS * (1 - np.eye(12))
    np.testing.assert_array_equal(stack_matrices(COSTS.tolist()), expected)


def test_null_is_no_way_and_on_the_diagonal_nothing() -> None:
    rows: list[list[float | None]] = [[None, 1, None], [4, np.nan, 3], [2, None, np.inf]]
    expected = [[0, 1, np.inf], [4, 0, 3], [2, np.inf, 0]]
    assert cost_matrix(rows, "matrices/0").tolist() == expected


@pytest.mark.parametrize(("cost", "shown"), [(np.nan, "NaN"), (np.inf, "Infinity")])
def test_what_is_not_finite_in_json_is_refused_beside_null(cost: float, shown: str) -> None:
    with pytest.raises(Refusal) as refused:
        cost_matrix([[0, 1, None], [None, 0, 3], [2, cost, 0]], "matrices/0")
    assert refused.value.detail == (
        f"matrices/0/2/1 must be a finite number, or null where there is no way, got {shown}"
    )


def test_a_leg_may_be_forbidden() -> None:
    matrix = np.array(SQUARE)
    matrix[0, 1] = np.inf
    check_costs(matrix, "matrices/1")


@pytest.mark.parametrize(
    ("matrices", "sentence"),
    [
        ([[], []], "matrices/0 must have a row of numbers or more, got none"),
        ([SQUARE, [[], [], []]], "matrices/1 must have a row of numbers or more, got none"),
        ([SQUARE, [[0, 1], [1, 0]]], "matrices/1 must have 3 rows, as many as matrices/0, got 2"),
        ([[[0, 1], [1, 0], [2, 3]], SQUARE], "matrices/0 must be square, got 3 rows of 2 numbers"),
        (
            [SQUARE, [[0, 1, 2], [1, 0], [2, 3, 0]]],
            "matrices/1/1 must have 3 numbers, as the first, got 2",
        ),
    ],
)
def test_what_is_not_square_is_named(matrices: list[list[list[float]]], sentence: str) -> None:
    with pytest.raises(Refusal) as refused:
        stack_matrices(matrices)
    assert refused.value.detail == sentence
    assert refused.value.errors[0].pointer == f"/{sentence.partition(' ')[0]}"


@pytest.mark.parametrize(
    ("cost", "sentence"),
    [
        (-0.5, "must not be negative, got -0.5"),
        (np.nan, "must be a number, or infinity where there is no way, got NaN"),
        (-np.inf, "must not be negative, got -Infinity"),
        (1e200, "must be at most 1e+150, got 1e+200"),
    ],
)
def test_an_entry_that_is_no_cost_is_named(cost: float, sentence: str) -> None:
    matrix = np.array(SQUARE)
    np.fill_diagonal(matrix, np.nan)
    check_costs(matrix, "matrices/1")
    matrix[1, 2] = cost
    with pytest.raises(Refusal) as refused:
        check_costs(matrix, "matrices/1")
    assert refused.value.detail == f"matrices/1/1/2 {sentence}"
