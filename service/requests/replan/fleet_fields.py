"""Requests to replan a fleet: the fields that say what has changed since its front was planned."""

from typing import Annotated

from pydantic import Discriminator, Field, Tag

from service.requests.fields import (
    GEOMETRY,
    Cost,
    Geometry,
    Items,
    NonNegativeInteger,
    SearchFields,
    StrictModel,
    Text,
    optional,
)
from service.requests.fleet_fields import FleetStopItem
from service.requests.replan.fields import CostEntry, NewCosts, NewStop
from service.requests.stop_fields import StopReference

_Place = Annotated[
    Annotated[StopReference, Tag("[stop]")] | Annotated[NewStop, Tag("[place]")],
    Discriminator(lambda value: "[stop]" if isinstance(value, int | float | str) else "[place]"),
]


class NewFleetStop(FleetStopItem, NewCosts):
    """A new stop of a fleet, with its demands, and how to reach it under each objective."""


class RouteOnTheWay(StrictModel):
    """A route of the plan that is driven, whose vehicle has left."""

    route: NonNegativeInteger = Field(description="its number in the plan, from 0")
    done: Items[StopReference] = Field(
        default_factory=list, description="the stops of the route that were visited, in order"
    )
    position: _Place | None = Field(
        default=None,
        description="where it goes on: a stop that is done or a depot, or a new place in the form"
        " of a stop; by default the last stop that is done, or its start",
    )
    leaves: Cost | None = Field(
        default=None,
        description="when it leaves there, if that is after the present time: at the end of the"
        " visit that has begun",
    )
    broken_down: bool = Field(
        default=False,
        description="whether its vehicle is out of service: other vehicles bring what it carries,"
        " which they load again",
    )


class FleetChanges(StrictModel):
    """The changes since a fleet was planned."""

    plan: NonNegativeInteger | None = Field(
        default=None,
        description="the number of the plan that is driven, from 0; by default the front's knee",
    )
    now: Cost | None = Field(
        default=None, description="the present time, needed if the fleet has a clock"
    )
    slack: Cost | None = Field(
        default=None,
        description="how long before a window closes a vehicle must reach the stop from now on; by"
        " default as long as before. With 0, vehicles that are delayed may use it up",
    )
    routes: Items[RouteOnTheWay] = Field(
        default_factory=list, description="the routes whose vehicles have left"
    )
    add: Items[NewFleetStop] = Field(default_factory=list, description="more stops to visit")
    remove: Items[StopReference] = Field(
        default_factory=list, description="stops that are no longer visited"
    )
    costs: Items[CostEntry] = Field(
        default_factory=list, description="single costs that have changed"
    )


class ChangesItem(StrictModel):
    """An objective that counts the stops which change vehicle, or are visited later."""

    name: Text = Field(default="changes", description="the name of the objective")
    tolerance: Cost | None = optional(
        "how much later than in the plan that is driven a visit may begin, in the clock's unit,"
        " without being a change; null: only changes of vehicles count"
    )


class ReplanFleetRequest(FleetChanges, SearchFields):
    """The changes since a fleet was planned, and the options of the front of the rest."""

    changes: ChangesItem | None = optional(
        "one more objective: how many stops of the plan that is driven are left out, or visited by"
        " another vehicle or later than with this tolerance. Where that is an objective already:"
        " its tolerance from now on"
    )

    geometry: Geometry = Field(default="straight", description=GEOMETRY)
