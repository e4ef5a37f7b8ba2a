"""The parts of requests, such as stops, as types of dictionaries: made of the service's forms.

`python -m tests.guide` writes this module. Types are calls where a member is called `from`.
"""

from collections.abc import Sequence
from typing import Literal, Required, TypedDict

from numpy.typing import ArrayLike
from paretour.frames import Costs


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


class MatrixRequest(TypedDict, total=False):
    """The costs of one day."""

    matrix: Required[Costs]


# The source of costs.
CostsRequest = TypedDict(
    "CostsRequest",
    {
        "unit": str | None,
        "matrix": Costs,
        "coordinates": ArrayLike,
        "from": Literal["great_circle", "road_time", "road_distance"],
        "speed": float | None,
        "over_the_day": ArrayLike,
        "slices": Sequence[SliceRequest],
        "breakpoints": Sequence[Sequence[ArrayLike | None] | ArrayLike] | ArrayLike,
        "traffic": TrafficRequest | None,
        "days": Sequence[MatrixRequest],
    },
    total=False,
)


class ObjectiveRequest(CostsRequest, total=False):
    """An objective, whose costs may change over the day, or spread from day to day."""

    name: Required[str]
    spread: float | Costs | None
    percentile: int | None


class ServiceRequest(TypedDict, total=False):
    """How long the visit of a stop takes by a type of vehicles."""

    vehicle: Required[str]
    service: Required[float]


class OrderRequest(TypedDict, total=False):
    """A stop, and its demands on the vehicle that visits it, whenever that is."""

    id: Required[str]
    location: ArrayLike | None
    demand: ArrayLike
    pickup: ArrayLike
    service: float
    services: Sequence[ServiceRequest]
    due: float | ArrayLike | None
    release: float
    skills: Sequence[str]
    vehicle: str | None
    urgency: float


class FleetStopRequest(OrderRequest, total=False):
    """A stop, and its demands on the vehicle that visits it."""

    window: ArrayLike | None
    windows: ArrayLike
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
    min_stops: int | None
    reload: Sequence[int | str] | ArrayLike
    max_trips: int | None
    initial_load: ArrayLike
    longest: float | None
    shortest: float
    max_distance: float | None
    max_driving: float | None
    fixed: float
    per_distance: float
    per_time: float
    speed_factor: float
    service_factor: float
    profile: str | None


class ProfileMatrixRequest(TypedDict, total=False):
    """The costs of the legs to vehicles of a profile: a matrix, or one for each slice of a day."""

    profile: Required[str]
    matrix: Costs
    slices: Sequence[SliceRequest]


Measure = Literal[
    "vehicles",
    "unassigned",
    "overtime",
    "lateness",
    "imbalance",
    "load_distance",
    "earliness",
    "weighted_arrival",
    "overlap",
    "changes",
    "on_time",
]


class FleetObjectiveRequest(CostsRequest, total=False):
    """An objective by its name: costs with their source, or another measure of plans."""

    name: Required[str]
    matrices: Sequence[ProfileMatrixRequest]
    spread: float | None
    measure: Measure | None
    over: Literal["sum", "max"]
    percentile: int | None


class ShipmentRequest(TypedDict, total=False):
    """Two stops that one vehicle visits: the pick-up, and later the delivery."""

    pickup: Required[int | str]
    delivery: Required[int | str]


class ApartRequest(TypedDict, total=False):
    """Stops that must not ride with each other, or with others."""

    stops: Required[Sequence[int | str] | ArrayLike]
    others: Sequence[int | str] | ArrayLike


class BeforeRequest(TypedDict, total=False):
    """Stops that come first, and others that come then."""

    first: Required[Sequence[int | str] | ArrayLike]
    then: Required[Sequence[int | str] | ArrayLike]
    vehicles: Literal["one", "any"]
    gap: float


class ClockRequest(CostsRequest, total=False):
    """The source of travel times that are not an objective, maybe over the day."""

    name: str
    matrices: Sequence[ProfileMatrixRequest]
    spread: float | None


class PromisedRouteRequest(TypedDict, total=False):
    """A route of a plan that is driven or was promised, as answers have them."""

    vehicle: Required[str]
    shift: int
    stops: Required[Sequence[int | str] | ArrayLike]
    arrivals: ArrayLike


class PromisedRequest(TypedDict, total=False):
    """A plan that is driven or was promised."""

    routes: Required[Sequence[PromisedRouteRequest]]
    tolerance: float | None


class LayerRequest(TypedDict, total=False):
    """A cost layer with its name: an objective of its own."""

    name: Required[str]
    unit: str | None
    layer: Required[ArrayLike]


class RobotRequest(TypedDict, total=False):
    """A robot: where it starts and, where robots do not return, maybe where it ends."""

    id: Required[str]
    start: int
    start_pose: ArrayLike
    end: int
    end_pose: ArrayLike


# The costs of one objective between a new stop and all others.
StopCostsRequest = TypedDict(
    "StopCostsRequest",
    {
        "to": Required[Sequence[float | None] | ArrayLike],
        "from": Sequence[float | None] | ArrayLike,
    },
    total=False,
)


class ReachedRequest(TypedDict, total=False):
    """How to reach a new stop under each objective."""

    coordinates: Sequence[ArrayLike | None] | ArrayLike
    costs: Sequence[StopCostsRequest | None]


class NewStopRequest(ReachedRequest, total=False):
    """A stop that the front does not have, and how to reach it under each objective."""

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


class RouteOnTheWayRequest(TypedDict, total=False):
    """A route of the plan that is driven, whose vehicle has left."""

    route: Required[int]
    done: Sequence[int | str] | ArrayLike
    position: int | str | NewStopRequest | None
    leaves: float | None
    distance: float | None
    driving: float | None
    broken_down: bool


class NewFleetStopRequest(ReachedRequest, FleetStopRequest, total=False):
    """A new stop of a fleet, with its demands, and how to reach it under each objective."""


class ChangedStopRequest(TypedDict, total=False):
    """What is asked of a stop of the front from now on, in place of what was."""

    stop: Required[int | str]
    prize: float | None
    windows: ArrayLike


class ChangedVehicleRequest(TypedDict, total=False):
    """What vehicles of an id may do from now on."""

    vehicle: Required[str]
    more: int
    max_overtime: float | None


class ChangesRequest(TypedDict, total=False):
    """An objective that counts the stops which change vehicle, or are visited later."""

    name: str
    tolerance: float | None


class OfferedOrderRequest(ReachedRequest, OrderRequest, total=False):
    """An order whose time is not agreed yet: a stop without windows and without a prize."""


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
