"""Which of all tours each row keeps, which others are remembered, and how they are repaired."""

import pytest
import torch

from models.shared_tours import (
    best_for_rows,
    gains_for_rows,
    slopes_for_rows,
    worth_remembering,
)

BALANCED, FIRST, SECOND = (0.5, 0.5), (0.8, 0.2), (0.2, 0.8)


@pytest.mark.parametrize(
    ("rows", "points", "best"),
    [
        # Its own, as long as no other is better.
        ([BALANCED], [(4, 4)], [0]),
        ([BALANCED], [(4, 4), (5, 5)], [0]),
        ([BALANCED], [(4, 4), (3, 3)], [1]),
        # Another one of the same lengths, or within rounding, is not better.
        ([BALANCED], [(4, 4), (4, 4)], [0]),
        ([BALANCED], [(4, 4), (3.999999, 3.999999)], [0]),
        ([BALANCED, BALANCED], [(4, 4), (4, 4)], [0, 1]),
        # The first of two that are equally good.
        ([BALANCED], [(4, 4), (3, 3), (3, 3)], [1]),
        # What one row has found may be best for the other, or for both.
        ([FIRST, SECOND], [(8, 2), (2, 8)], [1, 0]),
        ([FIRST, SECOND], [(9, 9), (9, 9), (2, 8), (8, 2)], [2, 3]),
        ([FIRST, SECOND], [(9, 9), (9, 9), (1, 1), (8, 2)], [2, 2]),
        # Not the least weighted sum, but one that lies along the preference.
        ([BALANCED], [(4, 4), (1, 6.5)], [0]),
        # Scales do not matter.
        ([BALANCED], [(4e6, 4e6), (3e6, 3e6)], [1]),
        ([BALANCED], [(4e-6, 4e-6), (3e-6, 3e-6)], [1]),
        # Under three objectives the exponent is lower.
        ([(1 / 3, 1 / 3, 1 / 3)], [(4, 4, 4), (3, 3, 5)], [1]),
        ([(1 / 3, 1 / 3, 1 / 3)], [(4, 4, 4), (1, 1, 7)], [0]),
    ],
)
def test_each_row_keeps_the_best_of_all_points_for_its_weights(rows, points, best) -> None:
    found = best_for_rows(torch.tensor(rows), torch.tensor(points, dtype=torch.float))
    assert found.tolist() == best


@pytest.mark.parametrize(
    ("kept", "others", "remembered"),
    [
        ([(4, 4)], [(2, 8), (5, 5)], {(2, 8)}),  # rather than a dominated one
        ([(4, 4)], [(5, 5), (2, 8)], {(2, 8)}),
        ([(4, 4)], [(3.9, 4.2), (2, 8)], {(2, 8)}),  # rather than one beside another
        ([(4, 4)], [(2, 8), (1, 9)], {(2, 8)}),  # the later one adds less to both
        ([(4, 4), (4, 4)], [(2, 8), (2, 8), (8, 2), (4, 4)], {(2, 8), (8, 2)}),  # no copies
        ([(4, 4, 4)], [(4, 4, 5), (9, 9, 1)], {(9, 9, 1)}),
        ([(4, 4)], [(0, 8), (5, 5)], {(0, 8)}),  # a length of zero
    ],
)
def test_points_that_no_other_comes_close_to_dominating_are_remembered(
    kept, others, remembered
) -> None:
    points = torch.tensor(others, dtype=torch.float)
    found = worth_remembering(torch.tensor(kept, dtype=torch.float), points)
    assert len(found) == len(kept)
    assert {tuple(point) for point in points[found].tolist()} == remembered


@pytest.mark.parametrize(
    ("row", "point", "slopes"),
    [
        # Along the preference they are its weights.
        (BALANCED, (4, 4), BALANCED),
        (FIRST, (2, 8), FIRST),
        # Beside it the objective that is too long weighs more.
        (BALANCED, (4, 2), (16 / 17, 1 / 17)),
        (BALANCED, (4e6, 2e6), (16 / 17, 1 / 17)),
        (SECOND, (8, 4), (1 / 65, 64 / 65)),
        ((0.25, 0.25, 0.5), (4, 2, 1), (2 / 5, 1 / 5, 2 / 5)),
        # Nothing is without weight, and lengths may be zero.
        (BALANCED, (4, 0), (1, 0)),
        (BALANCED, (0, 0), BALANCED),
    ],
)
def test_repairs_weigh_more_what_is_long_for_the_row(row, point, slopes) -> None:
    found = slopes_for_rows(torch.tensor([row]), torch.tensor([point], dtype=torch.float))
    assert found[0].tolist() == pytest.approx(slopes, abs=1e-6)
    assert (found > 0).all()


@pytest.mark.parametrize(
    ("rows", "kept", "point", "gain"),
    [
        ([BALANCED], [(4, 4)], (4, 4), 0),
        ([BALANCED], [(4, 4)], (5, 5), 0),
        ([BALANCED], [(4, 4)], (3, 3), 0.25),
        ([BALANCED], [(4, 4)], (1, 6.5), 0),  # a shorter sum, but not along the preference
        ([BALANCED, FIRST], [(4, 4), (2, 8)], (3, 3), 0.25),
        ([BALANCED, BALANCED], [(4, 4), (6, 6)], (3, 3), 0.75),
        ([(1 / 3, 1 / 3, 1 / 3)], [(4, 4, 4)], (3, 3, 3), 0.25),
    ],
)
def test_a_tour_is_worth_what_all_rows_gain_by_it(rows, kept, point, gain) -> None:
    weights, points = torch.tensor(rows), torch.tensor([point], dtype=torch.float)
    found = gains_for_rows(weights, torch.tensor(kept, dtype=torch.float), points)
    assert found.tolist() == pytest.approx([gain], abs=1e-5)
