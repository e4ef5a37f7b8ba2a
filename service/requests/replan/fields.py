"""The fields of requests to replan a front."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from service.instance import OBJECTIVES
from service.requests.coverage import Cell
from service.requests.replan.map_fields import MapChanges
from service.requests.schemas import GEOMETRY, LARGEST, Geometry, PlanePoint, PlanFields, Text
from service.requests.stop_fields import Latitude, Longitude, ObjectiveItem, StopReference

Cost = Annotated[float, Field(ge=0, le=LARGEST, allow_inf_nan=False)]
_Row = Annotated[list[Cost | None], Field(min_length=1, fail_fast=True)]
_References = Annotated[list[StopReference], Field(fail_fast=True)]


class StopCosts(BaseModel):
    """The costs of one objective between a new stop and all others."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    to: _Row = Field(
        description="from the new stop to each stop of the front, then to each of `add`, then to"
        " `position` where that is a place; its own entry is disregarded; null where there"
        " is no way"
    )
    back: _Row = Field(
        default_factory=list,
        alias="from",
        description="from each of these stops to the new one, by default the same as `to`; between"
        " two new stops `to` counts",
    )


class NewStop(BaseModel):
    """A stop that the front does not have, and how to reach it under each objective."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    id: Text = Field(description="one that no stop of the front has")
    location: tuple[Longitude, Latitude] | None = Field(
        default=None,
        description="longitude and latitude in degrees, where an objective is measured",
    )
    coordinates: Annotated[
        list[PlanePoint | None],
        Field(min_length=OBJECTIVES, max_length=OBJECTIVES, fail_fast=True),
    ] = Field(
        default_factory=list,
        description="for each objective x and y in its plane, null where it has none",
    )
    costs: Annotated[
        list[StopCosts | None],
        Field(min_length=OBJECTIVES, max_length=OBJECTIVES, fail_fast=True),
    ] = Field(
        default_factory=list,
        description="for each objective the costs to and from all stops, null if not a matrix",
    )


class CostEntry(BaseModel):
    """One cost that has changed, in one direction."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    objective: Annotated[
        Annotated[int, Field(ge=0, lt=OBJECTIVES), Tag("[index]")] | Annotated[Text, Tag("[name]")],
        Discriminator(lambda value: "[name]" if isinstance(value, str) else "[index]"),
    ] = Field(description="0 or 1, or its name")
    origin: StopReference = Field(alias="from", description="the stop that the step leads from")
    destination: StopReference = Field(alias="to", description="the stop that it leads to")
    cost: Cost | None = Field(
        description="of that step from now on; null where there is no way any more"
    )


def _form_of_position(value: object) -> str:
    if isinstance(value, int | float | str):
        return "[stop]"
    return "[cell]" if isinstance(value, list) else "[place]"


Position = Annotated[
    Annotated[StopReference, Tag("[stop]")]
    | Annotated[NewStop, Tag("[place]")]
    | Annotated[Cell, Tag("[cell]")],
    Discriminator(_form_of_position),
]
_Added = Annotated[
    Annotated[NewStop, Tag("[place]")] | Annotated[Cell, Tag("[cell]")],
    Discriminator(lambda value: "[cell]" if isinstance(value, list) else "[place]"),
]


class ReplanRequest(MapChanges):
    """What has changed since a front was planned, and the options of the front of the rest.

    Stops are named by their ids, or by their indexes in the front. Stops of a front without ids
    are named by their indexes, which are their ids from then on.
    """

    done: _References = Field(
        default_factory=list, description="the stops that were visited, in order"
    )
    position: Position | None = Field(
        default=None,
        description="where the way goes on: a stop, or a place, which is given as an added stop is;"
        " by default the last that is done",
    )
    add: Annotated[list[_Added], Field(fail_fast=True)] = Field(
        default_factory=list,
        description="stops to visit as well; of a front of a map row and column of each place",
    )
    remove: _References = Field(default_factory=list, description="stops not to visit any more")
    costs: Annotated[list[CostEntry], Field(fail_fast=True)] = Field(
        default_factory=list, description="single costs that have changed"
    )
    objectives: Annotated[
        list[ObjectiveItem],
        Field(min_length=OBJECTIVES, max_length=OBJECTIVES, fail_fast=True),
    ] = Field(
        default_factory=list,
        description="both objectives anew, where more has changed: with the costs between the"
        " stops of the front, then those of `add`, then `position` where that is a place",
    )
    tour: _References = Field(
        default_factory=list,
        description="the tour that is being driven, with all stops of the front; by default the"
        " front's knee",
    )
    geometry: Geometry = Field(default="straight", description=GEOMETRY)
    min_kept: float = Field(
        default=0.0,
        ge=0,
        le=1,
        allow_inf_nan=False,
        description="return only tours that keep this share of the driven tour's remaining legs",
    )

    @property
    def options_given(self) -> frozenset[str]:
        """The names of the options that the request has, as those of a new request."""
        return frozenset({*PlanFields.model_fields, "geometry"} & self.model_fields_set)
