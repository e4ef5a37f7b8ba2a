"""The fields of requests about costs that spread: how far, and what tours are measured by."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from service.errors import invalid
from service.objectives import MOST_OBJECTIVES
from service.reliability.spread import Spread
from service.requests.arrays import costs_between
from service.requests.fields import (
    IS_LIST,
    AsInteger,
    CostRows,
    StrictModel,
    at_most,
    empty_list,
    optional,
)

Array = NDArray[np.float64]
_LEAST_DAYS, _MOST_DAYS = 2, 50
_MOST_FACTOR = 10.0
_Factor = Annotated[float, Field(ge=0, le=_MOST_FACTOR, allow_inf_nan=False)]
Percentile = Annotated[int, Field(ge=50, le=99), AsInteger]
_SpreadOf = Annotated[_Factor | CostRows, IS_LIST]


class MatrixItem(StrictModel):
    """The costs of one day."""

    matrix: CostRows = Field(description="the costs from each stop (row) to each (column)")


class DaysFields(StrictModel):
    """The costs of several days."""

    days: Annotated[list[MatrixItem], at_most(_MOST_DAYS)] = empty_list(
        "in place of one matrix: the costs of 2 to 50 days. Their mean is the cost of each leg, and"
        " a tour or a plan is measured on each day"
    )

    def costs_of_days(self, part: str, n: int) -> Array:
        """Return the costs of each day, shape (d, n, n).

        Raises:
            Refusal: There are too few days, or a matrix is not of these stops.
        """
        if len(self.days) < _LEAST_DAYS:
            came = len(self.days)
            raise invalid(f"{part}/days", "too-few-days", least=_LEAST_DAYS, came=came)
        days = enumerate(self.days)
        return np.stack(
            [costs_between(each.matrix, f"{part}/days/{d}/matrix", n) for d, each in days]
        )

    def sampled(self, part: str, n: int, spread: object) -> Spread | None:
        """Return the costs of several days; None if there are none.

        Raises:
            Refusal: There is another spread beside them, or as of `costs_of_days`.
        """
        if not self.days:
            return None
        if spread is not None:
            raise invalid(f"{part}/spread", "not-beside", member="days")
        return Spread(days=self.costs_of_days(part, n))


class SpreadOfTimes(DaysFields):
    """How the times of a fleet's legs spread from day to day."""

    spread: _Factor | None = optional(
        "of the clock's times: the standard deviation of each leg, as a share of it; each plan then"
        " says how surely it is `on_time`"
    )


class SpreadFields(DaysFields):
    """The fields of an objective whose costs spread from day to day."""

    spread: _SpreadOf | None = optional(
        "how far the costs of each leg deviate from their mean, independently of other legs: as a"
        " share of the cost, or as a matrix of standard deviations in the objective's unit"
    )
    percentile: Percentile | None = optional(
        "the length of a tour is what so many days of a hundred do not exceed, such as 90; by"
        " default it is the mean"
    )

    def spread_of(self, part: str, n: int) -> Spread | None:
        """Return how the costs between n stops spread; None if they do not.

        Raises:
            Refusal: A percentile has no spread, or a matrix is not of these stops.
        """
        found = self.sampled(part, n, self.spread)
        if isinstance(self.spread, list):
            found = Spread(deviations=costs_between(self.spread, f"{part}/spread", n))
        elif self.spread is not None:
            found = Spread(factor=self.spread)
        if found is None and self.percentile is not None:
            raise invalid(f"{part}/percentile", "no-spread")
        return found and replace(found, percent=self.percentile)


def read_spreads(
    items: Sequence[SpreadFields], n: int, *, timed: bool, bound: bool
) -> tuple[Spread | None, ...]:
    """Return the spread of each objective; nothing if no costs spread.

    Args:
        timed: Whether tours depart at times of the day.
        bound: Whether a bound is asked for.

    Raises:
        Refusal: As `spread_of`, or the objectives and percentiles are too many, or there are times
            of the day or a bound.
    """
    spreads = tuple(item.spread_of(f"objectives/{m}", n) for m, item in enumerate(items))
    if not any(spreads):
        return ()
    if timed:
        raise invalid("departure", "departure-of-spread")
    if bound:
        raise invalid("bound", "bound-of-spread")
    percents = [m for m, each in enumerate(spreads) if each is not None and each.percent]
    if len(items) + len(percents) > MOST_OBJECTIVES:
        part = f"objectives/{percents[-1]}/percentile"
        raise invalid(part, "too-many-percentiles", limit=MOST_OBJECTIVES)
    return spreads
