"""The members of requests, as types of dictionaries: made of the service's forms.

`python -m tests.guide` writes this module.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Literal, Required, TypedDict

from numpy.typing import ArrayLike
from paretour.frames import Costs, Frame
from paretour.member_parts import (
    ApartRequest,
    BeforeRequest,
    ChangedStopRequest,
    ChangedVehicleRequest,
    ChangesRequest,
    ClockRequest,
    CostEntryRequest,
    DepartureRangeRequest,
    EverySlotRequest,
    FleetObjectiveRequest,
    FleetStopRequest,
    LayerRequest,
    NewFleetStopRequest,
    NewStopRequest,
    ObjectiveRequest,
    OfferedOrderRequest,
    PromisedRequest,
    RobotRequest,
    RouteOnTheWayRequest,
    ShipmentRequest,
    StopRequest,
    VehicleRequest,
)

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


class FleetRequest(SearchOptions, total=False):
    """Stops, vehicles and two to four objectives, and the options of their front of plans."""

    stops: Required[Sequence[FleetStopRequest] | Frame]
    vehicles: Required[Sequence[VehicleRequest]]
    objectives: Required[Sequence[FleetObjectiveRequest]]
    shipments: Sequence[ShipmentRequest]
    together: Sequence[Sequence[int | str] | ArrayLike] | ArrayLike
    apart: Sequence[ApartRequest]
    before: Sequence[BeforeRequest]
    clock: str | ClockRequest | None
    slack: float
    leave: Literal["late", "early"]
    promised: PromisedRequest | None
    geometry: Literal["straight", "roads"]


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
    departure: float | DepartureRangeRequest | None
    robot_speed: float | None
    over_the_day: ArrayLike
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


class RobotsRequest(CoverageRequest, total=False):
    """Places that several robots share."""

    robots: Required[Sequence[RobotRequest]]
    over: Sequence[Literal["sum", "max"]]


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


class FleetChanges(TypedDict, total=False):
    """The changes since a fleet was planned."""

    plan: int | None
    now: float | None
    slack: float | None
    routes: Sequence[RouteOnTheWayRequest]
    add: Sequence[NewFleetStopRequest]
    remove: Sequence[int | str] | ArrayLike
    stops: Sequence[ChangedStopRequest] | Frame
    vehicles: Sequence[ChangedVehicleRequest]
    costs: Sequence[CostEntryRequest]


class ReplanFleetRequest(FleetChanges, SearchOptions, total=False):
    """The changes since a fleet was planned, and the options of the front of the rest."""

    changes: ChangesRequest | None
    geometry: Literal["straight", "roads"]


class OffersRequest(FleetChanges, total=False):
    """An order without a time, the slots to choose from, and what has changed since the plan."""

    order: Required[OfferedOrderRequest]
    slots: ArrayLike
    every: EverySlotRequest | None
    time_limit: float
