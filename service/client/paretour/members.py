"""The members of requests, as types of dictionaries: made of the service's forms.

`python -m tests.guide` writes this module. Types are calls where a member is called `from`.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Literal, Required, TypedDict

from numpy.typing import ArrayLike
from paretour.frames import Costs, Frame

DEFAULT_TIME_LIMIT = 1.0  # seconds
BOUND_SECONDS = 5.0  # the most that the service takes to prove a bound


class SearchOptions(TypedDict, total=False):
    """The fields of every request: how long to plan, and how much to return."""

    time_limit: float
    size: int
    reference_point: ArrayLike
    seed: int


class PlanOptions(SearchOptions, total=False):
    """The fields of every request for a front of tours."""

    preferences: int | ArrayLike
    repairs: int
    arrivals: bool
    bound: bool
    actor: str


class DepartureRangeRequest(TypedDict, total=False):
    """The times at which a tour may begin."""

    earliest: Required[float]
    latest: Required[float]


class StopRequest(TypedDict, total=False):
    """A stop, and how long a visit takes."""

    id: Required[str]
    location: ArrayLike | None
    service: float


# A slice of the day, and the costs in it.
SliceRequest = TypedDict(
    "SliceRequest",
    {
        "from": Required[float],
        "matrix": Required[Costs],
    },
    total=False,
)


class TrafficRequest(TypedDict, total=False):
    """Which times of travel a routing engine is asked for."""

    date: Required[str]
    at: Required[ArrayLike]


# An objective, whose costs may change over the day.
ObjectiveRequest = TypedDict(
    "ObjectiveRequest",
    {
        "name": Required[str],
        "unit": str | None,
        "matrix": Costs,
        "coordinates": ArrayLike,
        "from": Literal["great_circle", "road_time", "road_distance"],
        "speed": float | None,
        "over_the_day": ArrayLike,
        "slices": Sequence[SliceRequest],
        "traffic": TrafficRequest | None,
    },
    total=False,
)


class FrontRequest(PlanOptions, total=False):
    """Cities or stops under two to four objectives, and the options of their front."""

    closed: bool
    start: int | str | None
    end: int | str | None
    initial_tours: Sequence[Sequence[int | str] | ArrayLike] | ArrayLike
    departure: float | DepartureRangeRequest | None
    clock: str | None
    coordinates: ArrayLike
    matrices: Sequence[Costs] | ArrayLike
    stops: Sequence[StopRequest] | Frame
    objectives: Sequence[ObjectiveRequest]
    augment: int
    geometry: Literal["straight", "roads"]


class FleetStopRequest(TypedDict, total=False):
    """A stop, and its demands on the vehicle that visits it."""

    id: Required[str]
    location: ArrayLike | None
    demand: ArrayLike
    service: float
    window: ArrayLike | None
    windows: ArrayLike
    due: float | None
    release: float
    skills: Sequence[str]
    vehicle: str | None
    prize: float | None


class BreakRequest(TypedDict, total=False):
    """A break that a driver takes who is on the way then."""

    window: Required[ArrayLike]
    length: Required[float]


class VehicleRequest(TypedDict, total=False):
    """A type of vehicle, and how many of it there are."""

    id: Required[str]
    count: int
    start: int | str | None
    end: int | str | None
    capacity: ArrayLike
    shift: ArrayLike | None
    shifts: ArrayLike
    max_overtime: float
    breaks: Sequence[BreakRequest]
    skills: Sequence[str]
    max_stops: int | None
    reload: Sequence[int | str] | ArrayLike
    max_trips: int | None
    initial_load: ArrayLike
    longest: float | None
    fixed: float


Measure = Literal["vehicles", "unassigned", "overtime", "lateness", "imbalance", "load_distance"]


# An objective by its name: costs with their source, or another measure of plans.
FleetObjectiveRequest = TypedDict(
    "FleetObjectiveRequest",
    {
        "name": Required[str],
        "unit": str | None,
        "matrix": Costs,
        "coordinates": ArrayLike,
        "from": Literal["great_circle", "road_time", "road_distance"],
        "speed": float | None,
        "measure": Measure | None,
        "over": Literal["sum", "max"],
    },
    total=False,
)


class ShipmentRequest(TypedDict, total=False):
    """Two stops that one vehicle visits: the pick-up, and later the delivery."""

    pickup: Required[int | str]
    delivery: Required[int | str]


# The source of travel times that are not an objective.
ClockRequest = TypedDict(
    "ClockRequest",
    {
        "name": str,
        "unit": str | None,
        "matrix": Costs,
        "coordinates": ArrayLike,
        "from": Literal["great_circle", "road_time", "road_distance"],
        "speed": float | None,
    },
    total=False,
)


class FleetRequest(SearchOptions, total=False):
    """Stops, vehicles and two to four objectives, and the options of their front of plans."""

    stops: Required[Sequence[FleetStopRequest] | Frame]
    vehicles: Required[Sequence[VehicleRequest]]
    objectives: Required[Sequence[FleetObjectiveRequest]]
    shipments: Sequence[ShipmentRequest]
    clock: str | ClockRequest | None
    geometry: Literal["straight", "roads"]


class LayerRequest(TypedDict, total=False):
    """A cost layer with its name: an objective of its own."""

    name: Required[str]
    unit: str | None
    layer: Required[ArrayLike]


class CoverageRequest(PlanOptions, total=False):
    """Places on a map, the objectives between them, and the options of their front."""

    closed: bool
    start: int | None
    end: int | None
    initial_tours: ArrayLike
    grid: ArrayLike
    occupancy_grid: Mapping[str, Any]
    cell_size: float
    origin: ArrayLike
    mode: Literal["trinary", "scale", "raw"]
    negate: bool
    occupied_thresh: float
    free_thresh: float
    obstacle_from: int
    unknown: Literal["blocked", "free"]
    robot_radius: float
    places: ArrayLike
    spacing: float
    start_pose: ArrayLike
    end_pose: ArrayLike
    second_matrix: Costs
    cost_layer: ArrayLike
    cost_layers: Sequence[LayerRequest]
    detours: bool
    second_coordinates: ArrayLike
    paths: bool


class RobotRequest(TypedDict, total=False):
    """A robot: where it starts and, where robots do not return, maybe where it ends."""

    id: Required[str]
    start: int
    start_pose: ArrayLike
    end: int
    end_pose: ArrayLike


class RobotsRequest(CoverageRequest, total=False):
    """Places that several robots share."""

    robots: Required[Sequence[RobotRequest]]
    over: Sequence[Literal["sum", "max"]]


# The costs of one objective between a new stop and all others.
StopCostsRequest = TypedDict(
    "StopCostsRequest",
    {
        "to": Required[Sequence[float | None] | ArrayLike],
        "from": Sequence[float | None] | ArrayLike,
    },
    total=False,
)


class NewStopRequest(TypedDict, total=False):
    """A stop that the front does not have, and how to reach it under each objective."""

    coordinates: Sequence[ArrayLike | None] | ArrayLike
    costs: Sequence[StopCostsRequest | None]
    id: Required[str]
    location: ArrayLike | None
    service: float | None


# One cost that has changed, in one direction.
CostEntryRequest = TypedDict(
    "CostEntryRequest",
    {
        "objective": Required[int | str],
        "from": Required[int | str],
        "to": Required[int | str],
        "cost": Required[float | None],
    },
    total=False,
)


class ReplanRequest(PlanOptions, total=False):
    """The changes since a front was planned, and the options of the front of the rest."""

    done: Sequence[int | str] | ArrayLike
    position: int | str | NewStopRequest | ArrayLike | None
    add: Sequence[NewStopRequest | ArrayLike] | ArrayLike
    remove: Sequence[int | str] | ArrayLike
    costs: Sequence[CostEntryRequest]
    objectives: Sequence[ObjectiveRequest]
    now: float | None
    tour: Sequence[int | str] | ArrayLike
    geometry: Literal["straight", "roads"]
    min_kept: float
    pose: ArrayLike
    grid: ArrayLike
    blocked: ArrayLike
    freed: ArrayLike
    cost_layer: ArrayLike
    cost_layers: Sequence[LayerRequest]
    paths: bool


class RouteOnTheWayRequest(TypedDict, total=False):
    """A route of the plan that is driven, whose vehicle has left."""

    route: Required[int]
    done: Sequence[int | str] | ArrayLike
    position: int | str | NewStopRequest | None
    broken_down: bool


class NewFleetStopRequest(TypedDict, total=False):
    """A new stop of a fleet, with its demands, and how to reach it under each objective."""

    coordinates: Sequence[ArrayLike | None] | ArrayLike
    costs: Sequence[StopCostsRequest | None]
    id: Required[str]
    location: ArrayLike | None
    demand: ArrayLike
    service: float
    window: ArrayLike | None
    windows: ArrayLike
    due: float | None
    release: float
    skills: Sequence[str]
    vehicle: str | None
    prize: float | None


class ReplanFleetRequest(SearchOptions, total=False):
    """The changes since a fleet was planned, and the options of the front of the rest."""

    plan: int | None
    now: float | None
    routes: Sequence[RouteOnTheWayRequest]
    add: Sequence[NewFleetStopRequest]
    remove: Sequence[int | str] | ArrayLike
    costs: Sequence[CostEntryRequest]
    geometry: Literal["straight", "roads"]


class OfferedOrderRequest(TypedDict, total=False):
    """An order whose time is not agreed yet: a stop without windows and without a prize."""

    coordinates: Sequence[ArrayLike | None] | ArrayLike
    costs: Sequence[StopCostsRequest | None]
    id: Required[str]
    location: ArrayLike | None
    demand: ArrayLike
    service: float
    due: float | None
    release: float
    skills: Sequence[str]
    vehicle: str | None


# Slots of equal length, one after another, in the unit of the clock.
EverySlotRequest = TypedDict(
    "EverySlotRequest",
    {
        "from": Required[float],
        "to": Required[float],
        "length": Required[float],
        "step": float | None,
    },
    total=False,
)


class OffersRequest(TypedDict, total=False):
    """An order without a time, the slots to choose from, and what has changed since the plan."""

    plan: int | None
    now: float | None
    routes: Sequence[RouteOnTheWayRequest]
    add: Sequence[NewFleetStopRequest]
    remove: Sequence[int | str] | ArrayLike
    costs: Sequence[CostEntryRequest]
    order: Required[OfferedOrderRequest]
    slots: ArrayLike
    every: EverySlotRequest | None
    time_limit: float
