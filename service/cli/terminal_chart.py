"""Draw a front in characters, for a terminal."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

WIDTH = 64  # columns that points are drawn in
HEIGHT = 12  # lines of points; the chart has 15 lines
LABELS = ("first length", "second length", "third length", "fourth length")


def draw_front(
    lengths: NDArray[np.float64], point: str = "•", labels: Sequence[str] = LABELS
) -> str:
    """Return a chart of points, shape (k, 2), with the first length to the right.

    It has at most 15 lines of at most 79 characters: the labels of both lengths are cut. Points
    that fall on the same character are drawn as one.
    """
    columns, rows = (_places(lengths[:, m], size) for m, size in ((0, WIDTH), (1, HEIGHT)))
    canvas = np.full((HEIGHT, WIDTH), " ")
    canvas[HEIGHT - 1 - rows, columns] = point
    (left, low), (right, high) = lengths.min(axis=0), lengths.max(axis=0)
    ticks = {0: f"{high:.6g}", HEIGHT - 1: f"{low:.6g}"}
    margin = max(map(len, ticks.values()))
    lines = [
        f"{ticks.get(row, ''):>{margin}} |{''.join(canvas[row])}".rstrip() for row in range(HEIGHT)
    ]
    ends = (f"{left:.6g}", f"{right:.6g}")
    room = WIDTH - sum(map(len, ends))
    between = _cut(labels[0], room - 2).center(room)
    indent = " " * (margin + 1)
    return "\n".join(
        (
            _cut(labels[1], WIDTH),
            *lines,
            f"{indent}+{'-' * WIDTH}",
            f"{indent} {ends[0]}{between}{ends[1]}",
        )
    )


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else f"{text[: most - 1]}…"


def _places(values: NDArray[np.float64], size: int) -> NDArray[np.int64]:
    """Return the character, 0 to size - 1, that each value lies in; all 0 where they are equal."""
    low, high = values.min(), values.max()
    # The halves are finite even where the difference of two finite numbers is not.
    half = high / 2 - low / 2
    shares = np.zeros_like(values) if half == 0 else (values / 2 - low / 2) / half
    return np.rint(shares * (size - 1)).astype(np.int64)
