"""Define the arguments of the tools, as pydantic models whose JSON schemas an agent reads.

The schemas list the members that agents need most often. Stops, objectives and vehicles may have
all other members of `POST /front` and `POST /fleet` too. These are passed on, and the service
checks them.
"""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

_MOST_TEXT = 2**20  # characters of a file
_OBJECTIVES = "two to four; what is minimised"
Id = Annotated[str, Field(min_length=1, max_length=100)]
Rows = list[list[float]]
Costs = list[list[float | None]]
Numbers = Annotated[dict[str, float], Field(max_length=4)]
Count = Annotated[int, Field(ge=0, le=2**31 - 1)]


class _Item(BaseModel):
    model_config = ConfigDict(extra="allow")


class Arguments(BaseModel):
    """The arguments of a tool. An argument that is not listed is an error."""

    model_config = ConfigDict(extra="forbid")

    def members(self) -> dict[str, Any]:
        """Return the arguments that were given, as members of a request."""
        return self.model_dump(by_alias=True, exclude_unset=True)


class Stop(_Item):
    """A stop of a tour. It may also have service, the seconds of a visit."""

    id: Id = Field(description="your own name for the stop")
    location: list[float] | None = Field(
        default=None, description="longitude and latitude in degrees, in this order"
    )


class Objective(_Item):
    """An objective with a name. It has one of `from`, `matrix` and `coordinates`."""

    name: Id
    unit: str | None = None
    source: str | None = Field(
        default=None,
        alias="from",
        description="great_circle (metres between locations; with speed, seconds), or road_time or"
        " road_distance where the service has a routing engine",
    )
    speed: float | None = Field(default=None, description="km/h, for great_circle")
    matrix: Costs | None = Field(
        default=None,
        description="a row for each stop: its costs to all; null where there is no way",
    )
    coordinates: Rows | None = Field(default=None, description="x and y of each stop in a plane")


class FleetObjective(Objective):
    """An objective of a fleet: summed costs, the longest route, or another measure."""

    over: str | None = Field(default=None, description="sum, or max for the longest route")
    measure: str | None = Field(
        default=None,
        description="vehicles, unassigned, overtime, lateness, imbalance or load_distance, in place"
        " of costs",
    )


class FleetStop(Stop):
    """A stop of a fleet. It may also have windows, due, release, skills, vehicle."""

    demand: list[int] | None = Field(default=None, description="one number for each kind of load")
    service: float | None = Field(default=None, description="seconds of the visit")
    window: list[float] | None = Field(default=None, description="opens and closes, in seconds")
    prize: float | None = Field(
        default=None, description="cost of leaving it out; by default it must be visited"
    )


class Vehicle(_Item):
    """A type of vehicle. It may also have shift, longest, fixed, skills, max_stops, breaks."""

    id: Id
    count: int | None = Field(default=None, description="how many there are; by default 1")
    start: int | str | None = Field(default=None, description="a stop, by index or id")
    end: int | str | None = Field(default=None, description="a stop, by index or id")
    capacity: list[int] | None = Field(default=None, description="one number for each kind of load")


_TIME_LIMIT = Field(default=None, ge=0, description="seconds of search; by default 1")


class PlanFront(Arguments):
    """Stops with objectives, or coordinates, or matrices."""

    stops: list[Stop] | None = None
    objectives: list[Objective] | None = Field(default=None, description=_OBJECTIVES)
    coordinates: Rows | None = Field(
        default=None,
        description="without stops: x and y of each city in the plane of each objective",
    )
    matrices: list[Costs] | None = Field(
        default=None, description="without stops: the costs of each objective, a row for each city"
    )
    closed: bool | None = Field(default=None, description="false: do not return to the start")
    start: int | str | None = Field(default=None, description="a stop, by index or id")
    end: int | str | None = Field(default=None, description="where open routes end, by index or id")
    departure: float | dict[str, float] | None = Field(
        default=None,
        description="when the tour begins, if objectives have over_the_day or slices, or stops have"
        " service: a second of the day, or earliest and latest",
    )
    time_limit: float | None = _TIME_LIMIT


class ChosenColumn(BaseModel):
    """A column of a table, and what it is taken for."""

    model_config = ConfigDict(extra="forbid")

    name: str = Field(description="its heading; without headings its number, from 1")
    taken_for: str = Field(
        description="id, latitude, longitude, demand, service, x, y, second x, second y, ignored or"
        " another one of the choices that an error lists"
    )


class PlanFile(Arguments):
    """The text of a file, and its name."""

    text: str = Field(
        max_length=_MOST_TEXT,
        description="CSV, GeoJSON, GPX, KML, JSON, TSPLIB, CVRPLIB, Solomon, Li and Lim or VROOM",
    )
    name: str = Field(default="stops.csv", max_length=100, description="such as orders.csv")
    columns: list[ChosenColumn] | None = Field(
        default=None,
        max_length=1000,
        description="what the columns of a table are taken for, if their names do not say it",
    )
    time_limit: float | None = _TIME_LIMIT


class PlanFleet(Arguments):
    """Stops, vehicles and two or three objectives."""

    stops: list[FleetStop]
    vehicles: list[Vehicle]
    objectives: list[FleetObjective] = Field(
        description="two or three; the first is a sum of costs"
    )
    shipments: list[dict[str, Any]] | None = Field(
        default=None, description="each with pickup and delivery, which are stops by index or id"
    )
    clock: str | dict[str, Any] | None = Field(
        default=None, description="what measures travel times, where windows need them"
    )
    time_limit: float | None = _TIME_LIMIT


class StoredFront(Arguments):
    """A front that was planned before."""

    front: Id = Field(description="the id that a planning tool returned")


class ChooseTour(StoredFront):
    """A front and one way to choose: at_most, weights, knee, balance or number."""

    at_most: Numbers | None = Field(
        default=None, description='a budget for objectives by name, such as {"time": 3600}'
    )
    prefer: str | None = Field(
        default=None, description="with at_most: the objective that is to be least"
    )
    weights: Numbers | None = Field(default=None, description="how much each objective matters")
    knee: bool | None = Field(default=None, description="true: the tour with the best balance")
    balance: float | None = Field(
        default=None,
        ge=0,
        le=1,
        description="of two objectives: from 0 (least of the first) to 1 (of the second)",
    )
    number: Count | None = Field(default=None, description="its number in the front, from 0")
    first_stop: Count = Field(
        default=0,
        description="for a long tour: how many of its stops to leave out before the first",
    )


class Replan(StoredFront):
    """A front, and the changes since it was planned."""

    done: list[int | str] | None = Field(default=None, description="stops visited, in order")
    position: int | str | dict[str, Any] | None = Field(
        default=None,
        description="where the rest of the tour begins: a stop, or a place with id and location",
    )
    add: list[dict[str, Any]] | None = Field(
        default=None, description="more stops, each with id and location, or coordinates, or costs"
    )
    remove: list[int | str] | None = Field(
        default=None, description="stops that are no longer visited"
    )
    costs: list[dict[str, Any]] | None = Field(
        default=None, description="changed costs, each with objective, from, to and cost"
    )
    tour: list[int | str] | None = Field(
        default=None, description="the tour that is driven, all its stops; by default the knee"
    )
    min_kept: float | None = Field(
        default=None, ge=0, le=1, description="the least share of the driven tour's legs to keep"
    )
    plan: Count | None = Field(
        default=None, description="of a fleet: the number of the plan that is driven"
    )
    now: float | None = Field(
        default=None,
        description="the time, in seconds: of a fleet, or where costs change over the day",
    )
    routes: list[dict[str, Any]] | None = Field(
        default=None, description="of a fleet: routes on their way, each with route and done"
    )
    time_limit: float | None = _TIME_LIMIT
