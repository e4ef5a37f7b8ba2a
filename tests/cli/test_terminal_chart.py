"""A front in characters."""

import numpy as np
import pytest

from service.cli.terminal_chart import HEIGHT, WIDTH, draw_front

FEW = """\
second length
4 |o
  |
  |
  |
  |
  |
  |
  |                     o
  |
  |
  |
1 |                                                               o
  +----------------------------------------------------------------
   1                         first length                         4"""


def test_points_stand_where_their_lengths_say() -> None:
    assert draw_front(np.array([[1.0, 4.0], [2.0, 2.0], [4.0, 1.0]]), "o") == FEW


@pytest.mark.parametrize(
    "lengths",
    [
        [[1.0, 2.0]],
        [[0.0, 0.0], [0.0, 0.0]],
        [[0.0, 1.7e308], [1.7e308, -1.7e308]],
        [[5e-324, 1e-323], [1e-323, 5e-324]],
        np.random.default_rng(0).random((1000, 2)).tolist(),
    ],
)
def test_a_chart_fits_a_terminal_whatever_the_lengths(lengths: list[list[float]]) -> None:
    lines = draw_front(np.array(lengths), "o").splitlines()
    assert len(lines) == HEIGHT + 3 == 15
    assert WIDTH <= max(map(len, lines)) <= 80
    assert "o" in "".join(lines[1 : HEIGHT + 1])


def test_labels_of_any_length_fit() -> None:
    lengths = np.array([[1e-300, 1e300], [1e300, 1e-300]])
    lines = draw_front(lengths, "o", ("x" * 200, "y" * 200)).splitlines()
    assert max(map(len, lines)) <= 80
    assert lines[0] == "y" * 63 + "…"
    assert "xxx" in lines[-1]
