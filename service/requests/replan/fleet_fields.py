"""Requests to replan a fleet: the fields that say what has changed since its front was planned."""

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Annotated

from pydantic import Field

from service.errors import invalid
from service.fleet.vehicles import Visit
from service.requests.fields import (
    GEOMETRY,
    Branch,
    Cost,
    Geometry,
    Items,
    NonNegativeInteger,
    SearchFields,
    StrictModel,
    Text,
    Time,
    empty_list,
    optional,
)
from service.requests.fleet_fields import FleetStopItem, Windows, spans_of
from service.requests.replan.fields import CostEntry, NewCosts, NewStop
from service.requests.stop_fields import StopReference, find_index

_Place = Annotated[
    StopReference | NewStop, Branch(lambda value: not isinstance(value, int | float | str))
]


class NewFleetStop(FleetStopItem, NewCosts):
    """A new stop of a fleet, with its demands, and how to reach it under each objective."""


class RouteOnTheWay(StrictModel):
    """A route of the plan that is driven, whose vehicle has left."""

    route: NonNegativeInteger = Field(description="its number in the plan, from 0")
    done: Items[StopReference] = empty_list("the stops of the route that were visited, in order")
    position: _Place | None = optional(
        "where it goes on: a stop that is done or a depot, or a new place in the form of a stop; by"
        " default the last stop that is done, or its start"
    )
    leaves: Time | None = optional(
        "when it leaves there, if that is after the present time: at the end of the visit that has"
        " begun"
    )
    distance: Cost | None = optional(
        "how far it has driven, where its vehicle has a max_distance; by default as far as in the"
        " plan, which does not say it of a new place"
    )
    driving: Time | None = optional(
        "how long it has driven, where its vehicle has a max_driving; by default as long as in the"
        " plan, which does not say it of a new place"
    )
    broken_down: bool = Field(
        default=False,
        description="whether its vehicle is out of service: other vehicles bring what it carries,"
        " which they load again",
    )


class ChangedStop(StrictModel):
    """What is asked of a stop of the front from now on, in place of what was."""

    stop: StopReference
    prize: Cost | None = optional("added to the first length if the stop is left out")
    windows: Windows = empty_list("when the visit may begin, from and to, by ascending time")

    def index(self, part: str, ids: Mapping[str, int], depots: Collection[int]) -> int:
        """Return the index of the stop, whose part of the request is `part`.

        Raises:
            Refusal: It is no stop of the front, or a depot.
        """
        stop = find_index(self.stop, ids, f"{part}/stop", len(ids))
        if stop in depots:
            raise invalid(f"{part}/stop", "removed-depot", came=self.stop)
        return stop

    def of(self, visit: Visit, part: str) -> Visit:
        """Return a visit with what is asked otherwise of it.

        Raises:
            Refusal: Windows are not in order.
        """
        prize = visit.prize if self.prize is None else self.prize
        spans = tuple(spans_of(None, self.windows, f"{part}/window"))
        return replace(visit, prize=prize, windows=spans if self.windows else visit.windows)


class ChangedVehicle(StrictModel):
    """What vehicles of an id may do from now on."""

    vehicle: Text = Field(description="the id of the type")
    more: NonNegativeInteger = Field(
        default=0, description="how many more of them can leave from now on, where the others did"
    )
    max_overtime: Time | None = optional(
        "how long after the end of its shift a route may end, or after the present time if the"
        " shift is over"
    )


class FleetChanges(StrictModel):
    """The changes since a fleet was planned."""

    plan: NonNegativeInteger | None = optional(
        "the number of the plan that is driven, from 0; by default the front's knee"
    )
    now: Time | None = optional("the present time, needed if the fleet has a clock")
    slack: Time | None = optional(
        "how long before a window closes a vehicle must reach the stop from now on; by default as"
        " long as before. With 0, vehicles that are delayed may use it up"
    )
    routes: Items[RouteOnTheWay] = empty_list("the routes whose vehicles have left")
    add: Items[NewFleetStop] = empty_list("more stops to visit")
    remove: Items[StopReference] = empty_list("stops that are no longer visited")
    stops: Items[ChangedStop] = empty_list("what is asked otherwise of stops of the front")
    vehicles: Items[ChangedVehicle] = empty_list("what vehicles may do otherwise, and more of them")
    costs: Items[CostEntry] = empty_list("single costs that have changed")


class ChangesItem(StrictModel):
    """An objective that counts the stops which change vehicle, or are visited later."""

    name: Text = Field(default="changes", description="the name of the objective")
    tolerance: Time | None = optional(
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
