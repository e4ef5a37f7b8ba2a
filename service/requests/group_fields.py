"""The fields of groups of stops in requests of `POST /fleet`."""

from typing import Annotated, Literal

from pydantic import Field

from service.errors import invalid
from service.requests.fields import StrictModel, Time, at_most, empty_list
from service.requests.stop_fields import StopReference

_MOST_IN_GROUP = 100
References = Annotated[
    list[StopReference], Field(min_length=1, max_length=_MOST_IN_GROUP, fail_fast=True)
]


class ApartItem(StrictModel):
    """Stops that must not ride with each other, or with others."""

    stops: References = Field(description="by index or id")
    others: Annotated[list[StopReference], at_most(_MOST_IN_GROUP)] = empty_list(
        "by index or id: no vehicle visits one of these and one of `stops`; without any, no"
        " vehicle visits two of `stops`"
    )


class BeforeItem(StrictModel):
    """Stops that come first, and others that come then."""

    first: References = Field(description="by index or id")
    then: References = Field(
        description="by index or id: on a route after all of `first` that are on it"
    )
    vehicles: Literal["one", "any"] = Field(
        default="one",
        description="one: only the order on one route counts; any: whoever drives, no visit of"
        " `then` begins before all visits of `first` have ended",
    )
    gap: Time = Field(
        default=0.0,
        description="how long after the visits of `first` those of `then` begin at the earliest,"
        " of any vehicles, in the clock's unit",
    )

    def least_gap(self, part: str) -> float | None:
        """Return how long the visits of `then` wait at least; None if only the order counts.

        Raises:
            Refusal: There is a gap, and only the order on one route counts.
        """
        if self.vehicles == "one" and self.gap:
            raise invalid(f"{part}/gap", "gap-of-one")
        return self.gap if self.vehicles == "any" else None
