"""The answers about plans for several vehicles or robots, as the OpenAPI document has them."""

from pydantic import BaseModel, Field

from service.api.responses import (
    OF_MORE,
    OF_TWO,
    Balance,
    FrontAnswer,
    Lengths,
    MapAnswer,
    ObjectiveName,
    PathItem,
)
from service.fleet.measures.table import MEASURES, Measure
from service.fleet.rules import Over, Rule
from service.requests.fields import Maybe, optional
from service.requests.stop_fields import NamedStop


class RouteItem(BaseModel):
    """The route of one vehicle."""

    vehicle: str = Field(description="the id of its type")
    stops: list[str] = Field(description="ids in order, with the start and end that are stops")
    lengths: Lengths
    load: Maybe[list[int]] = optional("the most that it carries at a time, in each dimension")
    shift: Maybe[int] = optional("the number of its shift, if its vehicle has several")
    route: Maybe[int] = optional(
        "of a vehicle on its way: the number of its route in the plan that is driven"
    )
    profile: Maybe[str] = optional("the profile of its vehicle, if it has one")
    arrivals: Maybe[list[float]] = optional(
        "if there is a clock: when it reaches each stop. At the first stop: when it leaves, as late"
        " as possible without finishing later"
    )
    ends: Maybe[list[float]] = optional("if there is a clock: when the visit at each stop ends")
    breaks: Maybe[list[float]] = optional("when each break on the way begins")
    distance: Maybe[list[float]] = optional(
        "if its vehicle has a max_distance: how far it has driven at each stop"
    )
    driving: Maybe[list[float]] = optional(
        "if its vehicle has a max_driving: how long it has driven at each stop"
    )


class ReasonItem(BaseModel):
    """A rule that keeps the vehicles of a type from a stop."""

    vehicle: str = Field(description="the id of the type")
    rule: Rule
    detail: str = Field(description="what a vehicle would do that the rule forbids")


class LeftOutItem(BaseModel):
    """A stop that a plan leaves out: how it can be served, or why it cannot."""

    stop: str
    plan: Maybe[int] = optional("the number of the plan of this front that serves it")
    price: Maybe[list[float]] = optional(
        "what each length grows by in that plan, or if the stop is inserted here"
    )
    reasons: Maybe[list[ReasonItem]] = optional(
        "if no vehicle can serve it: for each type the rule that forbids"
    )


class PlanItem(BaseModel):
    """A plan of a fleet and where it stands."""

    balance: Maybe[Balance] = optional(OF_TWO)
    losses: Maybe[Lengths] = optional(OF_MORE)
    lengths: Lengths
    kept: Maybe[float] = optional(
        "of a replanned fleet: the share of the stops left that the same vehicles visit after the"
        " same stops as in the plan that is driven"
    )
    measures: dict[str, float] = Field(
        description="what plans are compared by, as far as the request allows:"
        f" {', '.join(MEASURES)}"
    )
    routes: list[RouteItem] = Field(description="one for each vehicle that leaves")
    unassigned: list[str] = Field(description="the ids of stops with a prize that are left out")
    left_out: Maybe[list[LeftOutItem]] = optional("for each of these, once the search has ended")


class FleetObjectiveName(ObjectiveName):
    """An objective of a fleet's front."""

    over: Over = Field(description="whether the routes of a plan are added, or the longest counts")
    measure: Maybe[Measure] = optional("of plans, if it is not of costs")


class FleetAnswer(FrontAnswer):
    """A front of plans for a fleet, by ascending first length."""

    front: list[PlanItem]  # type: ignore[assignment]  # a list for reading only
    objectives: list[FleetObjectiveName]  # type: ignore[assignment]
    stops: list[NamedStop]
    clock: Maybe[ObjectiveName] = optional("the name and unit of all times, if there is a clock")
    driven: Maybe[Lengths] = optional(
        "of a replanned fleet: the lengths of the rest of the plan that is driven, without new"
        " stops, if it keeps every rule"
    )


class RobotRouteItem(BaseModel):
    """The route of one robot."""

    robot: str = Field(description="its id")
    tour: list[int] = Field(description="its places in order, from its start to its end")
    lengths: Lengths
    path: Maybe[PathItem] = optional("if `paths` is true")


class RobotPlanItem(BaseModel):
    """A plan of several robots and where it stands."""

    balance: Balance
    lengths: Lengths
    routes: list[RobotRouteItem] = Field(description="one for each robot that leaves")


class RobotsAnswer(MapAnswer):
    """A front of plans for several robots on a map, by ascending first length."""

    front: list[RobotPlanItem]  # type: ignore[assignment]  # a list for reading only
    objectives: list[FleetObjectiveName]  # type: ignore[assignment]
