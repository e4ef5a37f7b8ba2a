"""Requests to replan a front: their fields, and which of them a kind of front has."""

from typing import Annotated

from pydantic import Field

from service.errors import invalid
from service.objectives import MOST_OBJECTIVES
from service.requests.breakpoint_fields import TimeOfDay
from service.requests.coverage import Cell, RobotPose
from service.requests.day_fields import DayObjectiveItem
from service.requests.fields import (
    GEOMETRY,
    IS_LIST,
    IS_TEXT,
    Branch,
    Cost,
    Geometry,
    Items,
    Offered,
    OneEach,
    OneEachOfCosts,
    PlanePoint,
    PlanFields,
    Share,
    SomeItems,
    StrictModel,
    Text,
    empty_list,
    optional,
)
from service.requests.maps.fields import CostLayers, Layer, empty_rows
from service.requests.stop_fields import Latitude, Longitude, StopReference

_Row = SomeItems[Cost | None]
_References = Items[StopReference]


class StopCosts(StrictModel):
    """The costs of one objective between a new stop and all others."""

    to: _Row = Field(
        description="from the new stop to each stop of the front, then to each of `add`, then to"
        " `position` if that is a place; the entry for the new stop itself is ignored;"
        " null where there is no way"
    )
    back: _Row = Field(
        default_factory=list,
        alias="from",
        description="from each of these stops to the new one, by default the same as `to`; between"
        " two new stops `to` counts",
    )


class NewCosts(StrictModel):
    """The costs to and from a stop that the front does not have, under each objective."""

    coordinates: OneEachOfCosts[PlanePoint | None] = empty_list(
        "for each objective that has costs x and y in its plane, null if it has none"
    )
    costs: OneEachOfCosts[StopCosts | None] = empty_list(
        "for each objective that has costs those to and from all stops, null if not a matrix"
    )


class NewStop(NewCosts):
    """A stop that the front does not have, and how to reach it under each objective."""

    id: Text = Field(description="one that no stop of the front has")
    location: tuple[Longitude, Latitude] | None = optional(
        "longitude and latitude in degrees, where an objective is measured"
    )
    service: TimeOfDay | None = optional(
        "the seconds of a visit, where costs change over the day; by default 0"
    )


class CostEntry(StrictModel):
    """One cost that has changed, in one direction."""

    objective: Annotated[Annotated[int, Field(ge=0, lt=MOST_OBJECTIVES)] | Text, IS_TEXT] = Field(
        description="its index, from 0, or its name"
    )
    origin: StopReference = Field(alias="from", description="the stop that the step leads from")
    destination: StopReference = Field(alias="to", description="the stop that it leads to")
    cost: Cost | None = Field(
        description="the new cost of that step; null if there is no longer a way"
    )


def _type_of_position(value: object) -> int:
    if isinstance(value, int | float | str):
        return 0
    return 2 if isinstance(value, list) else 1


Position = Annotated[StopReference | NewStop | Cell, Branch(_type_of_position)]
_Added = Annotated[NewStop | Cell, IS_LIST]
_Cells = Items[Cell]


class ReplanRequest(PlanFields):
    """The changes since a front was planned, and the options of the front of the rest.

    Stops are named by their ids, or by their indexes in the front. Stops of a front without ids
    are named by their indexes, which are their ids from then on.
    """

    done: Annotated[
        _References,
        Offered(option="The stops visited, in order, such as depot,order-17."),
    ] = empty_list("the stops that were visited, in order")
    position: Annotated[
        Position | None,
        Offered(option="The stop from which the rest is planned; by default the last stop done."),
    ] = optional(
        "where the way goes on: a stop, or a new place in the form of an added stop; by default the"
        " last stop that is done"
    )
    add: Items[_Added] = empty_list("more stops to visit; on a map row and column of each place")
    remove: Annotated[
        _References,
        Offered(option="Stops that need no visit any more, with commas between."),
    ] = empty_list("stops that are no longer visited")
    costs: Items[CostEntry] = empty_list("single costs that have changed")
    objectives: OneEach[DayObjectiveItem] = empty_list(
        "all objectives again, where more than single costs has changed: with the costs between the"
        " stops of the front, then those of `add`, then `position` if that is a place"
    )
    now: TimeOfDay | None = optional(
        "where costs change over the day: the second of the day at which the way goes on"
    )
    tour: _References = empty_list(
        "the tour that is being driven, with all stops of the front; by default the front's knee"
    )
    geometry: Geometry = Field(default="straight", description=GEOMETRY)
    min_kept: Annotated[Share, Offered(option="")] = Field(
        default=0.0,
        description="return only tours that keep this share of the driven tour's remaining legs",
    )
    pose: RobotPose = empty_list(
        "instead of position, on a map with an origin: x and y, and maybe yaw, of the robot in the"
        " frame of the map"
    )
    grid: Layer = empty_rows(
        "on a map: the whole map as it is now, in its old size; 0 free, 1 an obstacle"
    )
    blocked: _Cells = empty_list(
        "on a map: row and column of each cell that has become an obstacle"
    )
    freed: _Cells = empty_list(
        "on a map: row and column of each cell that is no longer an obstacle"
    )
    cost_layer: Layer = empty_rows("on a map: a new second objective, as in `POST /coverage`")
    cost_layers: CostLayers = empty_list(
        "on a map whose cost layers have names: all of these layers again"
    )
    paths: bool = Field(
        default=False, description="on a map: whether each tour comes with its path"
    )


_OF_MAPS = ("pose", "grid", "blocked", "freed", "cost_layer", "cost_layers", "paths")
_OF_STOPS = ("costs", "objectives", "geometry")


def check_fields(request: ReplanRequest, *, on_map: bool) -> None:
    """Raise a refusal where a request has a field that only fronts of the other kind have."""
    kind = "stops or cities, by POST /front" if on_map else "a map, by POST /coverage"
    for name in _OF_STOPS if on_map else _OF_MAPS:
        if name in request.model_fields_set:
            raise invalid(name, "of-other-fronts", kind=kind)
