"""The fields of stops, vehicles, shipments and objectives in requests of `POST /fleet`."""

from math import inf
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from service.fleet.fleet import ALWAYS, Over, Span, VehicleType, Visit
from service.requests.schemas import LARGEST, AsInteger, PositiveNumber, Text
from service.requests.stop_fields import ObjectiveItem, StopItem, StopReference

_MOST_LOAD = 10**9
_MOST_DIMENSIONS = 8
_MOST_COUNT = 10**6
Load = Annotated[int, Field(ge=0, le=_MOST_LOAD), AsInteger]
Loads = Annotated[list[Load], Field(max_length=_MOST_DIMENSIONS, fail_fast=True)]
Cost = Annotated[float, Field(ge=0, le=LARGEST, allow_inf_nan=False)]
# A pair in JSON, and a list so that OpenAPI has its length.
TimeSpan = Annotated[list[Cost], Field(min_length=2, max_length=2, fail_fast=True)]


def _optional(description: str) -> Any:
    """Return a field that is None where it was not given."""
    return Field(default=None, description=description)


class FleetStopItem(StopItem):
    """A stop, and what it asks of the vehicle that visits it."""

    demand: Loads = Field(
        default_factory=list,
        description="whole numbers that the vehicle brings, one for each dimension of its capacity;"
        " of a shipment's pick-up what it takes on",
    )
    service: Cost = Field(default=0.0, description="how long a visit takes, in the clock's unit")
    window: TimeSpan | None = _optional("when a visit may begin, from and to")
    prize: Cost | None = _optional(
        "what the first length grows by if the stop is left out; without it the stop is visited"
    )

    def visit(self) -> Visit:
        """Return what the stop asks for."""
        return Visit(
            demand=tuple(self.demand),
            service=self.service,
            window=_span(self.window),
            prize=self.prize,
        )


class ShipmentItem(BaseModel):
    """Two stops that one vehicle visits: the pick-up, and later the delivery."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    pickup: StopReference = Field(description="by index or id; its demand and prize are of both")
    delivery: StopReference = Field(description="by index or id")


class VehicleItem(BaseModel):
    """So many vehicles that are alike."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    id: Text = Field(description="comes back with every route; no two types share one")
    count: Annotated[int, Field(ge=1, le=_MOST_COUNT), AsInteger] = Field(
        default=1, description="how many there are"
    )
    start: StopReference | None = _optional(
        "the stop at which they start, by index or id; null: each at its first visit"
    )
    end: StopReference | None = _optional(
        "the stop at which they end, by index or id; null: each at its last visit"
    )
    capacity: Loads = Field(
        default_factory=list, description="the most that one holds, in up to 8 dimensions"
    )
    shift: TimeSpan | None = _optional("when one may leave, and must be back")
    longest: PositiveNumber | None = _optional(
        "the longest route: its time where there is a clock, else its length in the objective that"
        " is a maximum"
    )
    fixed: Cost = Field(default=0.0, description="what the first length grows by if one is used")

    def vehicle_type(self, start: int | None, end: int | None) -> VehicleType:
        """Return the type of vehicles, with its ends as indexes."""
        return VehicleType(
            start=start,
            end=end,
            count=self.count,
            capacity=tuple(self.capacity),
            shift=_span(self.shift),
            longest=inf if self.longest is None else self.longest,
            fixed=self.fixed,
        )


class FleetObjectiveItem(ObjectiveItem):
    """An objective by its name, the source of its costs, and how routes make a plan's length."""

    over: Over = Field(
        default="sum",
        description="of a plan's routes the sum, or the longest; max for one objective at most",
    )


def _span(bounds: list[float] | None) -> Span:
    return ALWAYS if bounds is None else (bounds[0], bounds[1])
