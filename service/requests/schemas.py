"""What is asked over HTTP, and the most that may be."""

from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    GetPydanticSchema,
    Tag,
)
from pydantic.json_schema import SkipJsonSchema
from pydantic_core.core_schema import no_info_after_validator_function

from service.instance import MAX_SYMMETRIES, Instance, Kind
from service.planner import PlanOptions
from service.preferences import fan
from service.requests.arrays import stacked

# Between these, lengths and hypervolumes neither overflow nor vanish.
LARGEST = 1e150
_SMALLEST = 1e-150


def _whole(given: object) -> object:
    # JSON has one kind of number, and its schemas call 3.0 an integer.
    return int(given) if isinstance(given, float) and given.is_integer() else given


Coordinate = Annotated[float, Field(ge=-LARGEST, le=LARGEST, allow_inf_nan=False)]
Row = Annotated[list[Coordinate], Field(min_length=4, max_length=4, fail_fast=True)]
# That these are costs is checked of the whole array: half a million are too many to look at singly.
Rows = Annotated[list[Annotated[list[float], Field(fail_fast=True)]], Field(fail_fast=True)]
Pair = Annotated[list[Rows], Field(min_length=2, max_length=2, fail_fast=True)]
Matrices = Annotated[
    NDArray[np.float64],
    GetPydanticSchema(lambda _, handler: no_info_after_validator_function(stacked, handler(Pair))),
]
Angle = Annotated[float, Field(ge=0, le=90, allow_inf_nan=False)]
Positive = Annotated[float, Field(ge=_SMALLEST, le=LARGEST, allow_inf_nan=False)]
# The validator comes last: before it, the bounds would be lost to the OpenAPI document.
Count = Annotated[int, Field(ge=1, le=2**31 - 1), BeforeValidator(_whole)]
Whole = Annotated[int, Field(ge=0, le=2**31 - 1), BeforeValidator(_whole)]


class PlanRequest(BaseModel):
    """What is asked of a front."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    preferences: Annotated[
        Annotated[Count, Tag("[count]")]
        | Annotated[list[Angle], Field(min_length=1, fail_fast=True), Tag("[angles]")],
        Discriminator(lambda given: "[angles]" if isinstance(given, list) else "[count]"),
    ] = Field(
        default=100, description="angles in degrees to look along, or how many, evenly spread"
    )
    time_limit: float = Field(
        default=1.0,
        ge=0,
        allow_inf_nan=False,
        description="seconds of improvement after the network; 0 asks for its tours alone",
    )
    size: Count = Field(default=100, description="the most tours to return")
    start: Whole = Field(default=0, description="the city that every tour is reported from")
    reference_point: list[Positive] = Field(
        default_factory=list,
        min_length=2,
        max_length=2,
        description="of the hypervolume; by default the number of cities times the scale",
    )
    initial_tours: Annotated[list[list[Whole]], Field(min_length=1, fail_fast=True)] = Field(
        default_factory=list, description="tours that the front shall dominate or equal"
    )
    bound: bool = Field(
        default=False,
        description="whether to prove, in up to 5 s, how large any front's hypervolume can be",
    )
    actor: str = Field(
        default="",
        description="the network that builds the tours; by default pa-one for coordinates and"
        " pa-one-matrix for matrices",
    )
    seed: Whole = Field(default=0, description="of everything random in the improvement")

    @property
    def named_actor(self) -> str | None:
        """The actor asked for, if one is."""
        return self.actor if "actor" in self.model_fields_set else None

    def demand(self) -> PlanOptions:
        """What is asked of the front."""
        looked = self.preferences
        return PlanOptions(
            angles=fan(looked) if isinstance(looked, int) else np.array(looked),
            size=self.size,
            start=self.start,
            reference_point=np.array(self.reference_point) if self.reference_point else None,
            time_limit=self.time_limit,
            initial_tours=np.array(self.initial_tours) if self.initial_tours else None,
            bound=self.bound,
            seed=self.seed,
        )


class FrontRequest(PlanRequest):
    """Cities under two objectives, and what is asked of their front.

    What is empty can only be a default: none is given.
    """

    coordinates: Annotated[list[Row], Field(min_length=1, fail_fast=True)] = Field(
        default_factory=list,
        description="a row for each city: x and y in plane 1, x and y in plane 2",
    )
    matrices: Matrices = Field(
        default_factory=lambda: np.empty((2, 0, 0)),
        description="instead of coordinates, for each objective the costs from each city (row) to"
        " each (column); the diagonal is disregarded",
    )

    augment: Annotated[int, Field(ge=1, le=MAX_SYMMETRIES), BeforeValidator(_whole)] = Field(
        default=1,
        description="how many times the network is called: each time it sees the coordinates under"
        " another symmetry of the square, and aims between the angles of the other calls",
    )

    @property
    def kind(self) -> Kind:
        """In what the cities are given."""
        return "coordinates" if self.coordinates else "matrices"

    @property
    def n(self) -> int:
        """The number of cities."""
        return len(self.coordinates) or self.matrices.shape[1]

    def instance(self) -> Instance:
        """The cities."""
        if self.kind == "matrices":
            return Instance(matrices=self.matrices)
        return Instance(coordinates=np.array(self.coordinates, dtype=np.float64))

    def demand(self) -> PlanOptions:
        """What is asked of the front."""
        return replace(super().demand(), augment=self.augment)


class TourQuery(BaseModel):
    """Which tour of which front."""

    model_config = ConfigDict(extra="forbid")

    angle: Angle = Field(description="the trade-off wanted, in degrees")
    front: str | SkipJsonSchema[None] = Field(
        default=None, description="the front's id; by default the latest"
    )
