"""The query of `GET /tour`, and the tour of a front that it chooses."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field
from pydantic.json_schema import SkipJsonSchema

from service.errors import Refusal
from service.pareto import balances, knee
from service.requests.fields import GEOMETRY, Angle, Geometry, Share, optional

Array = NDArray[np.float64]
_BUDGETS = ("first_at_most", "second_at_most")  # of objectives 0 and 1
_WAYS = ("angle", "balance", *_BUDGETS, "knee")
_Length = Annotated[float, Field(ge=0, allow_inf_nan=False)]
# `?knee` means `?knee=true`.
_Flag = Annotated[bool, BeforeValidator(lambda value: value if value != "" else True)]


class TourQuery(BaseModel):
    """The query parameters of `GET /tour`: the front, and one of five ways to choose its tour."""

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
    knee: _Flag = Field(
        default=False,
        description="the tour with the least sum of both lengths, each in the front's own box",
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

    def _says(self, name: str) -> bool:
        return name != "knee" or self.knee

    def choose(self, points: Array, angles: Array) -> int:
        """Return the index of the tour chosen; of equally good ones the first.

        Args:
            points: The lengths of a front's tours, shape (m, 2), m at least 1.
            angles: Their directions in degrees, shape (m,).

        Raises:
            Refusal: No tour is within the budget.
        """
        if self.angle is not None:
            return int(np.abs(angles - self.angle).argmin())
        if self.balance is not None:
            return int(np.abs(balances(points) - self.balance).argmin())
        for objective, name in enumerate(_BUDGETS):
            if (budget := getattr(self, name)) is not None:
                return _within(points, objective, budget)
        return knee(points)


def _within(points: Array, objective: int, budget: float) -> int:
    """Return the point within a budget of one length whose other length is least.

    Raises:
        Refusal: No point is within it.
    """
    lengths = points[:, objective]
    if not (lengths <= budget).any():
        which, least = ("first", "second")[objective], float(lengths.min())
        raise Refusal("no-such-tour", which=which, limit=budget, actual=least)
    return int(np.where(lengths <= budget, points[:, 1 - objective], np.inf).argmin())
