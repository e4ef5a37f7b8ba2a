"""Choose one tour of a front: at an angle or balance, by weights, within budgets, or the knee."""

from collections.abc import Mapping, Sequence
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Objective = str | int  # its name, or its index
_BUDGETS = ("first_at_most", "second_at_most")
_OF_TWO = ("angle", "balance", *_BUDGETS)  # objectives
_WAYS = (*_OF_TWO, "weights", "at_most", "knee")
_NTH = ("first", "second", "third", "fourth")


class Choice(TypedDict, total=False):
    """Ways to choose a tour other than by angle; None and False count as not given.

    `balance` is 0 at the least first length of the front and 1 at the least second.
    `first_at_most` and `second_at_most` are budgets of one length: the tour with the least other
    length within the budget is chosen. All of these are for two objectives.

    `weights` are numbers for objectives: the tour is chosen whose greatest weighted loss is least,
    where a loss is a length scaled to 0 to 1 over the front. `at_most` are budgets for objectives:
    the tour within all of them is chosen that has the least length under `prefer`, which may be
    left out where one objective alone has no budget. `knee` is the tour with the least sum of all
    losses.
    """

    balance: float | None
    first_at_most: float | None
    second_at_most: float | None
    weights: Mapping[Objective, float] | None
    at_most: Mapping[Objective, float] | None
    prefer: Objective | None
    knee: bool


def choose(
    lengths: Array, angles: Array, names: Sequence[str], angle: float | None, choice: Choice
) -> int:
    """Return the index of the chosen tour, the first of equally good ones.

    Args:
        lengths: The lengths of a front's tours, shape (k, m).
        angles: Their directions in degrees, shape (k,), of two objectives.
        names: The names of the objectives, where they have any.
        angle: The angle, if the choice is by angle.
        choice: Any other choice.

    Raises:
        ValueError: Not exactly one way is given, it does not suit the number of objectives or names
            none of them, no tour is within the budgets, or the front is empty.
    """
    [(name, wanted)] = the_way({"angle": angle, **choice}).items()
    if not len(lengths):
        raise ValueError("the front is empty yet")
    count = lengths.shape[1]
    if count > len(_BUDGETS) and name in _OF_TWO:
        raise ValueError(f"{name} is for two objectives, and there are {count}")
    loss = losses(lengths)
    if name == "angle":
        return int(np.abs(angles - wanted).argmin())
    if name == "balance":
        return int(np.abs((loss[:, 0] + 1 - loss[:, 1]) / 2 - wanted).argmin())
    if name == "knee":
        return int(loss.sum(axis=1).argmin())
    if name == "weights":
        numbers = [_index(each, names, count) for each in wanted]
        weighted = loss[:, numbers] * list(wanted.values())
        return int(np.lexsort((weighted.sum(axis=1), weighted.max(axis=1)))[0])
    if name == "at_most":
        budgets = {_index(each, names, count): budget for each, budget in wanted.items()}
        return _within(lengths, budgets, _preferred(choice.get("prefer"), budgets, names, count))
    objective = _BUDGETS.index(name)
    return _within(lengths, {objective: wanted}, 1 - objective)


def parameters(angle: float | None, choice: Choice) -> dict[str, Any]:
    """Return the query parameters of `GET /tour` for a choice."""
    ways = {"angle": angle, **choice}
    [(name, value)] = the_way(ways).items()
    if not isinstance(value, Mapping):
        return {name: str(value).lower()}
    query: dict[str, Any] = {name: [f"{each}:{number}" for each, number in value.items()]}
    prefer = choice.get("prefer")
    return query if prefer is None else {**query, "prefer": str(prefer)}


def the_way(ways: Mapping[str, Any]) -> dict[str, Any]:
    """Return the one way to choose that is given: its name and value.

    Raises:
        ValueError: Not exactly one is given, or `prefer` without `at_most`.
    """
    given = {
        name: value for name, value in ways.items() if value is not None and value is not False
    }
    preferring = given.pop("prefer", None) is not None
    if len(given) != 1:
        names = " and ".join(given) or "none"
        raise ValueError(f"one of {', '.join(_WAYS[:-1])} and {_WAYS[-1]} is wanted, got {names}")
    if preferring and "at_most" not in given:
        raise ValueError("prefer is for a choice by at_most alone")
    return given


def losses(lengths: Array) -> Array:
    """Return lengths in their own box: 0 at the least of an objective, 1 at the greatest."""
    if not len(lengths):
        return lengths
    least = lengths.min(axis=0)
    extent = lengths.max(axis=0) - least
    return (lengths - least) / np.where(extent > 0, extent, 1.0)


def _index(objective: Objective, names: Sequence[str], count: int) -> int:
    """Return the index of an objective that is named by it or by its name."""
    if isinstance(objective, str) and objective in names:
        return names.index(objective)
    if isinstance(objective, int) and 0 <= objective < count:
        return objective
    known = ", ".join([*map(repr, names), *map(str, range(count))])
    raise ValueError(f"an objective must be one of {known}, got {objective!r}")


def _preferred(
    prefer: Objective | None, budgets: Mapping[int, float], names: Sequence[str], count: int
) -> int:
    if prefer is not None:
        return _index(prefer, names, count)
    free = [index for index in range(count) if index not in budgets]
    if len(free) != 1:
        raise ValueError(f"prefer is wanted, as {len(free)} objectives have no budget")
    return free[0]


def _within(lengths: Array, budgets: Mapping[int, float], preferred: int) -> int:
    inside = np.ones(len(lengths), bool)
    for objective, budget in budgets.items():
        least = lengths[inside, objective].min()
        inside &= lengths[:, objective] <= budget
        if not inside.any():
            sentence = f"no tour has a {_NTH[objective]} length up to {budget:.16g}"
            raise ValueError(f"{sentence}: the least is {least:.16g}")
    return int(np.where(inside, lengths[:, preferred], np.inf).argmin())
