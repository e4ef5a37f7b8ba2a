"""Choose one tour of a front: for clients, for `GET /tour`, for the command and for agents."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypedDict

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Objective = str | int  # its name, or its index
NTH = ("first", "second", "third", "fourth")  # what an objective without a name is called
_PAIR = 2  # objectives
_LONGEST = 80  # characters of what came, in a sentence


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


class WrongChoice(ValueError):
    """A choice that is not valid, or not for this front; `parameter` is what is wrong with it."""

    def __init__(self, demand: str, parameter: str | None = None) -> None:
        super().__init__(demand if parameter is None else f"{parameter} {demand}")
        self.parameter = parameter


class NoneWithin(ValueError):
    """No tour is within a budget."""

    def __init__(self, objective: int, limit: float, actual: float) -> None:
        self.which, self.limit, self.actual = NTH[objective], limit, actual
        sentence = f"no tour has a {self.which} length of at most {limit:.16g}"
        super().__init__(f"{sentence}: the least is {actual:.16g}")


def losses(lengths: Array) -> Array:
    """Return lengths, shape (k, m), in their own box: 0 at the least of a length, 1 at the most.

    >>> losses(np.array([[2.0, 70.0, 1.0], [3.0, 40.0, 1.0], [6.0, 30.0, 1.0]]))
    array([[0.  , 1.  , 0.  ],
           [0.25, 0.25, 0.  ],
           [1.  , 0.  , 0.  ]])
    """
    if not len(lengths):
        return lengths
    least = lengths.min(axis=0)
    extent = lengths.max(axis=0) - least
    return (lengths - least) / np.where(extent > 0, extent, 1.0)


def balances(lengths: Array) -> Array:
    """Return the balance of each tour: 0 at the least first length, 1 at the least second.

    With u and v its two losses, the balance of a tour is (u + 1 - v) / 2.

    Args:
        lengths: Shape (k, 2), in any order and unit.

    >>> balances(np.array([[2.0, 70.0], [3.0, 40.0], [6.0, 30.0]]))
    array([0. , 0.5, 1. ])
    >>> balances(np.array([[5.0, 5.0]]))
    array([0.5])
    """
    u, v = losses(lengths).T
    return (u + 1 - v) / 2


def knee(lengths: Array) -> int:
    """Return the index of the tour with the least sum of losses, of equal ones the first.

    Args:
        lengths: Shape (k, m), k at least 1.

    >>> knee(np.array([[2.0, 70.0], [3.0, 40.0], [6.0, 30.0]]))
    1
    """
    return int(losses(lengths).sum(axis=1).argmin())


@dataclass(frozen=True)
class Tours:
    """The tours to choose from; see `choose`."""

    lengths: Array
    angles: Array
    names: Sequence[str]

    @property
    def known(self) -> dict[str, int]:
        """The index of each objective, by its index as a text and by its name."""
        known = {str(index): index for index in range(self.lengths.shape[1])}
        return known | {name: index for index, name in enumerate(self.names)}

    def index(self, parameter: str, objective: Objective) -> int:
        """Return the index of an objective."""
        if isinstance(objective, int) and 0 <= objective < self.lengths.shape[1]:
            return objective
        if objective not in self.known:
            names = ", ".join(map(_shown, self.known))
            raise WrongChoice(f"must name one of {names}, got {_shown(objective)}", parameter)
        return self.known[str(objective)]

    def numbers(self, parameter: str, wanted: Any) -> dict[int, float]:
        """Return the number for the index of each objective, from a mapping or from pairs."""
        found: dict[int, float] = {}
        for objective, number in wanted.items() if isinstance(wanted, Mapping) else wanted:
            index = self.index(parameter, objective)
            if index in found:
                demand = f"must have each objective once, got {_shown(objective)} twice"
                raise WrongChoice(demand, parameter)
            found[index] = number
        return found

    def nearest(self, values: Array, wanted: float) -> int:
        """Return the tour whose value, shape (k,), is nearest to the one that is wanted."""
        return int(np.abs(values - wanted).argmin())

    def within(self, budgets: Mapping[int, float], preferred: int) -> int:
        """Return the tour within budgets whose length of another objective is least."""
        inside = np.ones(len(self.lengths), bool)
        for objective, budget in budgets.items():
            lengths = self.lengths[:, objective]
            least = float(lengths[inside].min())
            inside &= lengths <= budget
            if not inside.any():
                raise NoneWithin(objective, budget, least)
        return int(np.where(inside, self.lengths[:, preferred], np.inf).argmin())

    def by_weights(self, ways: Mapping[str, Any]) -> int:
        """Return the tour whose greatest weighted loss is least, of equal ones by their sum."""
        weights = self.numbers("weights", ways["weights"])
        if not any(weights.values()):
            raise WrongChoice("must have one that is more than 0", "weights")
        weighted = losses(self.lengths)[:, list(weights)] * list(weights.values())
        return int(np.lexsort((weighted.sum(axis=1), weighted.max(axis=1)))[0])

    def by_budgets(self, ways: Mapping[str, Any]) -> int:
        """Return the tour within budgets that has the least length of the preferred objective."""
        budgets = self.numbers("at_most", ways["at_most"])
        if ways.get("prefer") is not None:
            return self.within(budgets, self.index("prefer", ways["prefer"]))
        free = [index for index in range(self.lengths.shape[1]) if index not in budgets]
        if len(free) != 1:
            raise WrongChoice(f"is required, as {len(free)} objectives have no limit", "prefer")
        return self.within(budgets, free[0])


class _Way(NamedTuple):
    """A function that returns the index of a tour, and whether it is for two objectives alone."""

    pick: Callable[[Tours, Mapping[str, Any]], int]
    of_two: bool = False


_WAYS = {
    "angle": _Way(lambda tours, ways: tours.nearest(tours.angles, ways["angle"]), of_two=True),
    "balance": _Way(
        lambda tours, ways: tours.nearest(balances(tours.lengths), ways["balance"]), of_two=True
    ),
    "first_at_most": _Way(
        lambda tours, ways: tours.within({0: ways["first_at_most"]}, 1), of_two=True
    ),
    "second_at_most": _Way(
        lambda tours, ways: tours.within({1: ways["second_at_most"]}, 0), of_two=True
    ),
    "weights": _Way(Tours.by_weights),
    "at_most": _Way(Tours.by_budgets),
    "knee": _Way(lambda tours, _: knee(tours.lengths)),
}


def choose(lengths: Array, angles: Array, names: Sequence[str], ways: Mapping[str, Any]) -> int:
    """Return the index of the chosen tour, the first of equally good ones.

    Args:
        lengths: The lengths of a front's tours, shape (k, m).
        angles: Their directions in degrees, shape (k,), of two objectives.
        names: The names of the objectives, where they have any.
        ways: Members of `Choice`, and `angle`; others are ignored. Numbers of objectives may also
            be pairs.

    Raises:
        WrongChoice: Not exactly one way is given, it does not suit the number of objectives or
            names none of them, or the front is empty.
        NoneWithin: No tour is within the budgets.
    """
    name = the_way(ways)
    way = _WAYS[name]
    if not len(lengths):
        raise WrongChoice("the front is empty yet")
    if lengths.shape[1] > _PAIR and way.of_two:
        *others, last = (each for each in _WAYS if not _WAYS[each].of_two)
        demand = f"is for fronts of two objectives; choose by {', '.join(others)} or {last}"
        raise WrongChoice(f"{demand} among {lengths.shape[1]}", name)
    return way.pick(Tours(lengths, angles, names), ways)


def the_way(ways: Mapping[str, Any]) -> str:
    """Return the name of the one way to choose that is given.

    Raises:
        WrongChoice: Not exactly one is given, or `prefer` without `at_most`.
    """
    given = [name for name in _WAYS if ways.get(name) is not None and ways[name] is not False]
    if len(given) != 1:
        came = " and ".join(given) or "none"
        raise WrongChoice(f"one of {', '.join(_WAYS)} must be given, got {came}")
    if ways.get("prefer") is not None and given != ["at_most"]:
        raise WrongChoice("is for a choice by at_most alone", "prefer")
    return given[0]


def numbers_in(parameter: str, parts: Iterable[str]) -> Iterator[tuple[str, float]]:
    """Yield a name and a number for each text such as `time:0.5`.

    Raises:
        WrongChoice: A text is not a name and a number that is not negative.
    """
    for part in parts:
        name, colon, text = part.rpartition(":")
        number = number_in(text) if colon else None
        if number is None:
            demand = "must be a name, a colon and a number that is not negative"
            raise WrongChoice(f"{demand}, got {_shown(part)}", parameter)
        yield name, number


def number_in(text: str) -> float | None:
    """Return a number that is not negative; None if the text is none."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if 0 <= number < np.inf else None


def parameters(ways: Mapping[str, Any], front: str | None = None) -> dict[str, Any]:
    """Return the query parameters of `GET /tour` for a choice of a front by its id."""
    name = the_way(ways)
    query: dict[str, Any] = {name: str(ways[name]).lower()}
    if isinstance(ways[name], Mapping):
        query = {name: [f"{each}:{number}" for each, number in ways[name].items()]}
    others = {"prefer": ways.get("prefer"), "front": front}
    return query | {other: str(value) for other, value in others.items() if value is not None}


def _shown(value: object) -> str:
    """Return what came as a short text."""
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"
