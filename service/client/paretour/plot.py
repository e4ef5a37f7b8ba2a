"""Draw the lengths of a front with matplotlib."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

_TWO, _THREE = 2, 3  # objectives


def draw_lengths(lengths: NDArray[np.float64], labels: Sequence[str], axes: Any = None) -> Any:
    """Draw lengths under two or three objectives, each along an axis with its label.

    Args:
        lengths: The lengths of k tours or plans, in order of the first, shape (k, m).
        axes: The axes to draw into; None for those of a new figure.

    Returns:
        The axes.

    Raises:
        ValueError: There are more than three objectives.
    """
    count = lengths.shape[1]
    if count > _THREE:
        raise ValueError(f"a plot is of two or three objectives, and there are {count}")
    if axes is None:
        from matplotlib import pyplot

        options = {"projection": "3d"} if count == _THREE else {}
        _, axes = pyplot.subplots(layout="constrained", subplot_kw=options)
    if count == _TWO:
        axes.step(*lengths.T, where="post", color="0.8", linewidth=1)
        axes.spines[["top", "right"]].set_visible(False)
    axes.scatter(*lengths.T, s=14)
    for name, text in zip("xyz", labels, strict=False):
        label = getattr(axes, f"{name}axis").label
        label.set(text=text, parse_math=False)  # a name may have a dollar sign in it
    return axes
