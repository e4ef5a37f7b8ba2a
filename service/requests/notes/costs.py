"""Notes on costs that look as if they stood for legs that are not allowed."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_TIMES = 1000  # the median


def notes_on_costs(matrix: Array, name: str) -> Iterator[str]:
    """Yield a sentence for each huge cost that a matrix has more than once.

    Huge is a thousand times the median of the positive costs without the largest one. A table of
    costs often has such a number for legs that cannot be driven.

    Args:
        matrix: Shape (n, n), or (s, n, n) of slices of the day.
        name: What the matrix is called in the sentence.
    """
    n = matrix.shape[-1]
    legs = matrix[..., ~np.eye(n, dtype=np.bool_)]
    legs = legs[(legs > 0) & (legs < np.inf)]
    if not legs.size:
        return
    others = legs[legs < legs.max()]
    if not others.size or legs.max() < _TIMES * others.min():
        return
    median = float(np.median(others))
    values, counts = np.unique(legs[legs >= _TIMES * median], return_counts=True)
    for value, count in zip(values.tolist(), counts.tolist(), strict=True):
        if count > 1:
            yield (
                f"{count} costs of {name} are {_shown(value)}, more than {_TIMES} times the median:"
                " they are taken for costs. Where there is no way, write null."
            )


def _shown(value: float) -> str:
    return f"{value:.0f}" if value.is_integer() and value < 1e15 else f"{value:g}"
