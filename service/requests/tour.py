"""The query of `GET /tour`, and the tour of a front that it chooses."""

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field
from pydantic.json_schema import SkipJsonSchema

from service.errors import Fault, Refusal
from service.objectives import NTH, OBJECTIVES
from service.pareto import balances, knee, losses
from service.requests.fields import GEOMETRY, Angle, Geometry, Share, optional
from service.requests.validation import show

Array = NDArray[np.float64]
_BUDGETS = ("first_at_most", "second_at_most")  # of objectives 0 and 1
_OF_TWO = ("angle", "balance", *_BUDGETS)  # objectives
_WAYS = (*_OF_TWO, "weights", "at_most", "knee")
_MOST_PARTS = 8  # of a list in the query
_Length = Annotated[float, Field(ge=0, allow_inf_nan=False)]
_Parts = Annotated[list[str], Field(max_length=_MOST_PARTS)]
# `?knee` means `?knee=true`.
_Flag = Annotated[bool, BeforeValidator(lambda value: value if value != "" else True)]


class TourQuery(BaseModel):
    """The query parameters of `GET /tour`: the front, and one of seven ways to choose its tour."""

    model_config = ConfigDict(extra="forbid")

    angle: Angle = optional("the tour nearest to this angle, in degrees")
    balance: Share = optional(
        "the tour nearest to this balance: 0 at the front's least first length, 1 at its least"
        " second"
    )
    first_at_most: _Length = optional(
        "the tour with the least second length whose first length is at most this"
    )
    second_at_most: _Length = optional(
        "the tour with the least first length whose second length is at most this"
    )
    weights: _Parts = Field(
        default_factory=list,
        description="of objectives, by name or number, as `time:0.5,risk:0.3`: the tour whose"
        " greatest weighted loss is least. A loss is a length in the front's own box, 0 at its"
        " least and 1 at its greatest",
    )
    at_most: _Parts = Field(
        default_factory=list,
        description="of objectives, by name or number, as `time:3600`, each with the most that is"
        " allowed: among the tours within all of them that with the least length of `prefer`",
    )
    prefer: str | SkipJsonSchema[None] = Field(
        default=None,
        description="only with `at_most`: the objective, by name or number, whose length is to be"
        " least; by default the one that has no limit, where there is one such",
    )
    knee: _Flag = Field(
        default=False,
        description="the tour with the least sum of all lengths, each in the front's own box",
    )
    front: str | SkipJsonSchema[None] = Field(
        default=None, description="the front's id; by default the latest"
    )
    geometry: Geometry = Field(default="straight", description=GEOMETRY)

    def check(self) -> None:
        """Raise a refusal unless exactly one way to choose a tour was given."""
        given = [name for name in _WAYS if name in self.model_fields_set and self._says(name)]
        if len(given) != 1:
            came = " and ".join(given) or "none"
            sentence = f"one of {', '.join(_WAYS)} must be given, got {came}"
            raise Refusal("invalid-request", detail=sentence)
        if self.prefer is not None and not self.at_most:
            raise _refused("prefer", "is for a choice by at_most alone")

    def _says(self, name: str) -> bool:
        return name != "knee" or self.knee

    def choose(self, points: Array, angles: Array, names: Sequence[str] = ()) -> int:
        """Return the index of the tour chosen; of equally good ones the first.

        Args:
            points: The lengths of a front's tours, shape (k, m), k at least 1.
            angles: Their directions in degrees, shape (k,), of two objectives.
            names: The names of the objectives, where they have any.

        Raises:
            Refusal: No tour is within the budget, or the way to choose is not for this front.
        """
        self._check_for(points.shape[1])
        if self.angle is not None:
            return int(np.abs(angles - self.angle).argmin())
        if self.balance is not None:
            return int(np.abs(balances(points) - self.balance).argmin())
        for objective, name in enumerate(_BUDGETS):
            if (budget := getattr(self, name)) is not None:
                return _within(points, {objective: budget}, 1 - objective)
        if self.knee:
            return knee(points)
        known = _Objectives(names, points.shape[1])
        if self.weights:
            return _by_weights(points, known.numbers("weights", self.weights))
        budgets = known.numbers("at_most", self.at_most)
        return _within(points, budgets, known.preferred(self.prefer, budgets))

    def _check_for(self, objectives: int) -> None:
        """Raise a refusal where the way to choose does not suit this number of objectives."""
        given = self.model_fields_set.intersection(_OF_TWO)
        if objectives > OBJECTIVES and given:
            demand = "is for fronts of two objectives; choose by weights, at_most or knee"
            raise _refused(given.pop(), f"{demand} among {objectives}")


class _Objectives:
    """The objectives of a front, by the names or numbers by which a query says which it means."""

    def __init__(self, names: Sequence[str], count: int) -> None:
        self._count = count
        self._known = {str(index): index for index in range(count)}
        self._known |= {name: index for index, name in enumerate(names)}

    def numbers(self, parameter: str, parts: Sequence[str]) -> dict[int, float]:
        """Return the number for each objective in parts such as `time:0.5,risk:0.3`.

        Raises:
            Refusal: A part is not a name and a number that is not negative, or names one twice.
        """
        found: dict[int, float] = {}
        for part in (each for text in parts for each in self._split(text)):
            name, colon, text = part.rpartition(":")
            number = _number(text)
            if not colon or number is None:
                demand = "must be a name, a colon and a number that is not negative"
                raise _refused(parameter, f"{demand}, got {show(part)}")
            objective = self.find(parameter, name)
            if objective in found:
                raise _refused(parameter, f"must have each objective once, got {show(name)} twice")
            found[objective] = number
        if parameter == "weights" and not any(found.values()):
            raise _refused(parameter, "must have one that is more than 0")
        return found

    def find(self, parameter: str, name: str) -> int:
        """Return the index of an objective.

        Raises:
            Refusal: There is none of this name or number.
        """
        if name not in self._known:
            names = ", ".join(map(show, self._known))
            raise _refused(parameter, f"must name one of {names}, got {show(name)}")
        return self._known[name]

    def preferred(self, name: str | None, budgets: dict[int, float]) -> int:
        """Return the objective whose length is to be least within budgets.

        Raises:
            Refusal: None is named, and not just one has no budget.
        """
        if name is not None:
            return self.find("prefer", name)
        free = [index for index in range(self._count) if index not in budgets]
        if len(free) != 1:
            raise _refused("prefer", f"is required, as {len(free)} objectives have no limit")
        return free[0]

    def _split(self, text: str) -> list[str]:
        """Return the parts of a text at its commas, but for a comma in a name."""
        name, _, number = text.rpartition(":")
        return [text] if name in self._known and _number(number) is not None else text.split(",")


def _number(text: str) -> float | None:
    """Return a number that is not negative, or None."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if 0 <= number < np.inf else None


def _refused(parameter: str, demand: str) -> Refusal:
    sentence = f"{parameter} {demand}"
    return Refusal(
        "invalid-request", detail=sentence, errors=[Fault(sentence, parameter=parameter)]
    )


def _by_weights(points: Array, weights: dict[int, float]) -> int:
    """Return the point whose greatest weighted loss is least, of equal ones by their sum."""
    weighted = losses(points)[:, list(weights)] * list(weights.values())
    return int(np.lexsort((weighted.sum(axis=1), weighted.max(axis=1)))[0])


def _within(points: Array, budgets: dict[int, float], preferred: int) -> int:
    """Return the point within budgets of lengths whose length of another objective is least.

    Raises:
        Refusal: No point is within them. It says the least length within the budgets before.
    """
    within = np.ones(len(points), bool)
    for objective, budget in budgets.items():
        lengths = points[:, objective]
        least = float(lengths[within].min())
        within &= lengths <= budget
        if not within.any():
            raise Refusal("no-such-tour", which=NTH[objective], limit=budget, actual=least)
    return int(np.where(within, points[:, preferred], np.inf).argmin())
