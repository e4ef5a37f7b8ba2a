"""Choose one tour of a front: at an angle, at a balance, within a budget, or at the knee."""

from collections.abc import Mapping
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_BUDGETS = ("first_at_most", "second_at_most")


class Choice(TypedDict, total=False):
    """Ways to choose a tour other than by angle; None and False count as not given.

    `balance` is 0 at the least first length of the front and 1 at the least second.
    `first_at_most` and `second_at_most` are budgets of one length: the tour with the least other
    length within the budget is chosen. `knee` is the tour with the least sum of both lengths, each
    scaled to 0 to 1 over the front.
    """

    balance: float | None
    first_at_most: float | None
    second_at_most: float | None
    knee: bool


def choose(lengths: Array, angles: Array, angle: float | None, choice: Choice) -> int:
    """Return the index of the chosen tour, the first of equally good ones.

    Args:
        lengths: The lengths of a front's tours, shape (m, 2).
        angles: Their directions in degrees, shape (m,).
        angle: The angle, if the choice is by angle.
        choice: Any other choice.

    Raises:
        ValueError: Not exactly one way is given, no tour is within the budget, or the front is
            empty.
    """
    [(name, wanted)] = the_way({"angle": angle, **choice}).items()
    if not len(lengths):
        raise ValueError("the front is empty yet")
    u, v = _in_box(lengths).T
    if name == "angle":
        return int(np.abs(angles - wanted).argmin())
    if name == "balance":
        return int(np.abs((u + 1 - v) / 2 - wanted).argmin())
    if name == "knee":
        return int((u + v).argmin())
    return _within(lengths, _BUDGETS.index(name), wanted)


def parameters(angle: float | None, choice: Choice) -> dict[str, Any]:
    """Return the query parameters of `GET /tour` for a choice."""
    return {name: str(value).lower() for name, value in the_way({"angle": angle, **choice}).items()}


def the_way(ways: Mapping[str, Any]) -> dict[str, Any]:
    """Return the one way to choose that is given: its name and value.

    Raises:
        ValueError: Not exactly one is given.
    """
    given = {
        name: value for name, value in ways.items() if value is not None and value is not False
    }
    if len(given) != 1:
        names = " and ".join(given) or "none"
        raise ValueError(
            f"one of angle, balance, {', '.join(_BUDGETS)} and knee is wanted, got {names}"
        )
    return given


def _in_box(lengths: Array) -> Array:
    """Return lengths in their own box: 0 at the least of an objective, 1 at the greatest."""
    least = lengths.min(axis=0)
    extent = lengths.max(axis=0) - least
    return (lengths - least) / np.where(extent > 0, extent, 1.0)


def _within(lengths: Array, objective: int, budget: float) -> int:
    inside = lengths[:, objective] <= budget
    if not inside.any():
        which, least = ("first", "second")[objective], lengths[:, objective].min()
        sentence = f"no tour has a {which} length up to {budget:.16g}"
        raise ValueError(f"{sentence}: the least is {least:.16g}")
    return int(np.where(inside, lengths[:, 1 - objective], np.inf).argmin())
