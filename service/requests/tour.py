"""The query of `GET /tour`, and the tour of a front that it chooses."""

from collections.abc import Container, Iterable, Sequence
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from paretour import choice
from paretour.choice import NoneWithin, WrongChoice
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from service.errors import Fault, Refusal
from service.requests.fields import (
    GEOMETRY,
    Angle,
    Geometry,
    Maybe,
    Offered,
    Share,
    empty_list,
    optional,
)

Array = NDArray[np.float64]
_MOST_PARTS = 8  # of a list in the query
_Length = Annotated[float, Field(ge=0, allow_inf_nan=False)]
_Parts = Annotated[list[str], Field(max_length=_MOST_PARTS)]
_Name = Maybe[str]
# `?knee` means `?knee=true`.
_Flag = Annotated[bool, BeforeValidator(lambda value: value if value != "" else True)]
_ON_COMMAND = Offered(option="")


class TourQuery(BaseModel):
    """The query parameters of `GET /tour`: the front, and one of seven ways to choose its tour."""

    model_config = ConfigDict(extra="forbid")

    angle: Annotated[Angle, _ON_COMMAND] = optional("the tour nearest to this angle, in degrees")
    balance: Annotated[Share, _ON_COMMAND] = optional(
        "the tour nearest to this balance: 0 at the front's least first length, 1 at its least"
        " second"
    )
    first_at_most: Annotated[_Length, _ON_COMMAND] = optional(
        "the tour with the least second length whose first length is at most this"
    )
    second_at_most: Annotated[_Length, _ON_COMMAND] = optional(
        "the tour with the least first length whose second length is at most this"
    )
    weights: Annotated[
        _Parts,
        Offered(
            option="For an objective, again for each: the least of the greatest weighted loss,"
            " where a loss is a length scaled to 0 to 1 over the front.",
            each="NAME:NUMBER",
        ),
    ] = empty_list(
        "of objectives, by name or number, as `time:0.5,risk:0.3`: the tour whose greatest weighted"
        " loss is least. A loss is a length in the front's own box, 0 at its least and 1 at its"
        " greatest"
    )
    at_most: Annotated[
        _Parts,
        Offered(
            option="For an objective, again for each: the most that its length may be.",
            each="NAME:NUMBER",
        ),
    ] = empty_list(
        "of objectives, by name or number, as `time:3600`, each with the most that is allowed:"
        " among the tours within all of them that with the least length of `prefer`"
    )
    prefer: Annotated[
        _Name, Offered(option="With --at-most: the objective whose length is to be least.")
    ] = optional(
        "only with `at_most`: the objective, by name or number, whose length is to be least; by"
        " default the one that has no limit, where there is one such"
    )
    knee: Annotated[_Flag, _ON_COMMAND] = Field(
        default=False,
        description="the tour with the least sum of all lengths, each in the front's own box",
    )
    front: _Name = optional("the front's id; by default the latest")
    geometry: Geometry = Field(default="straight", description=GEOMETRY)

    def check(self) -> None:
        """Raise a refusal unless exactly one way to choose a tour was given."""
        try:
            choice.the_way(self._given)
        except WrongChoice as error:
            raise refusal_of(error) from None

    def choose(self, points: Array, angles: Array, names: Sequence[str] = ()) -> int:
        """Return the index of the tour chosen; of equally good ones the first.

        Args:
            points: The lengths of a front's tours, shape (k, m), k at least 1.
            angles: Their directions in degrees, shape (k,), of two objectives.
            names: The names of the objectives, where they have any.

        Raises:
            Refusal: No tour is within the budget, or the way to choose is not for this front.
        """
        known = {*names, *map(str, range(points.shape[1]))}
        ways = {
            name: choice.numbers_in(name, _split(value, known))
            if isinstance(value, list)
            else value
            for name, value in self._given.items()
        }
        try:
            return choice.choose(points, angles, names, ways)
        except NoneWithin as error:
            raise Refusal(
                "no-such-tour", which=error.which, limit=error.limit, actual=error.actual
            ) from None
        except WrongChoice as error:
            raise refusal_of(error) from None

    @property
    def _given(self) -> dict[str, Any]:
        return self.model_dump(exclude_unset=True)


def _split(texts: Iterable[str], known: Container[str]) -> Iterable[str]:
    """Yield the parts of texts at their commas, but for a comma in the name of an objective."""
    for text in texts:
        name, _, number = text.rpartition(":")
        whole = name in known and choice.number_in(number) is not None
        yield from [text] if whole else text.split(",")


def refusal_of(error: WrongChoice) -> Refusal:
    """Return the refusal of a choice that is not valid."""
    fault = error.parameter and Fault("wrong-choice", parameter=error.parameter, said=str(error))
    return Refusal("invalid-request", detail=str(error), errors=[fault] if fault else [])
