"""The members of requests, as types of dictionaries."""

import json
from collections.abc import Callable, Mapping, Sequence
from inspect import cleandoc
from pkgutil import get_data
from typing import Any, Literal, Protocol, Required, TypedDict, TypeVar

from numpy.typing import ArrayLike

# A row for each city, with its costs to all cities; None or infinity if there is no way.
Costs = ArrayLike | Sequence[Sequence[float | None]]


Function = TypeVar("Function", bound=Callable[..., Any])
# The lines of the help on each type below, from the service: `python -m tests.guide` writes them.
_HELP = json.loads(get_data("paretour", "members.json") or b"")


class Frame(Protocol):
    """A DataFrame of any library."""

    def to_numpy(self) -> Any:
        """Return its cells as an array."""


class PlanOptions(TypedDict, total=False):
    """The members that every request to plan may have; the service's /docs explains them."""

    preferences: int | ArrayLike
    time_limit: float
    size: int
    repairs: int
    reference_point: ArrayLike
    arrivals: bool
    bound: bool
    actor: str
    seed: int


class PlanRequest(PlanOptions, total=False):
    """The members that every request to plan new cities may have."""

    closed: bool
    initial_tours: ArrayLike


class StopRequest(TypedDict, total=False):
    """A stop: an id that the caller chooses, and maybe longitude and latitude in degrees."""

    id: Required[str]
    location: ArrayLike | None


class ServedStopRequest(StopRequest, total=False):
    """A stop of a front over the day, and the seconds of a visit."""

    service: float


# Written as a call because `from` is a keyword. It is great_circle, road_time or road_distance.
# With a speed in km/h, great_circle is seconds, not metres.
ObjectiveRequest = TypedDict(
    "ObjectiveRequest",
    {
        "name": Required[str],
        "unit": str | None,
        "matrix": Costs,
        "coordinates": ArrayLike,
        "from": str,
        "speed": float | None,
        "over_the_day": ArrayLike,
        "slices": Sequence[Mapping[str, Any]],
    },
    total=False,
)


# The source of travel times that are not an objective.
ClockRequest = TypedDict(
    "ClockRequest",
    {
        "name": str,
        "unit": str | None,
        "matrix": Costs,
        "coordinates": ArrayLike,
        "from": str,
        "speed": float | None,
    },
    total=False,
)


class FrontRequest(PlanRequest, total=False):
    """The members of a request to POST /front: coordinates, matrices, or stops with objectives.

    With stops, `start` and `initial_tours` may name them by id. `augment` has no effect. Where
    there is no way from one city to another, its cost is None or infinite.
    """

    coordinates: ArrayLike
    matrices: ArrayLike | Sequence[Costs]
    stops: Sequence[ServedStopRequest] | Frame
    objectives: Sequence[ObjectiveRequest]
    start: int | str | None
    end: int | str | None
    departure: float | Mapping[str, float]
    clock: str
    augment: int
    geometry: Literal["straight", "roads"]


# Coordinates, matrices or stops.
Instance = ArrayLike | Sequence[Costs] | Sequence[ServedStopRequest] | Frame


class FleetStopRequest(StopRequest, total=False):
    """A stop of a fleet, with its demands on the vehicle that visits it."""

    demand: Sequence[int]
    service: float
    window: ArrayLike | None
    windows: Sequence[ArrayLike]
    prize: float | None
    due: float | None
    release: float
    skills: Sequence[str]
    vehicle: str | None


class ShipmentRequest(TypedDict):
    """Two stops, by index or id, that one vehicle visits in this order."""

    pickup: int | str
    delivery: int | str


class BreakRequest(TypedDict):
    """A break of a vehicle's driver: when it may begin, from and to, and how long it takes."""

    window: ArrayLike
    length: float


class VehicleRequest(TypedDict, total=False):
    """A number of equal vehicles."""

    id: Required[str]
    count: int
    start: int | str | None
    end: int | str | None
    capacity: Sequence[int]
    shift: ArrayLike | None
    shifts: Sequence[ArrayLike]
    max_overtime: float
    longest: float | None
    fixed: float
    skills: Sequence[str]
    max_stops: int | None
    reload: Sequence[int | str]
    max_trips: int | None
    initial_load: Sequence[int]
    breaks: Sequence[BreakRequest]


class FleetObjectiveRequest(ObjectiveRequest, total=False):
    """An objective: the sum of costs, those of the longest route, or another measure."""

    over: Literal["sum", "max"]
    measure: Literal["vehicles", "unassigned", "overtime", "lateness"]


class FleetRequest(TypedDict, total=False):
    """The members of a request to POST /fleet; the service's /docs explains them."""

    stops: Required[Sequence[FleetStopRequest] | Frame]
    vehicles: Required[Sequence[VehicleRequest]]
    objectives: Required[Sequence[FleetObjectiveRequest]]
    shipments: Sequence[ShipmentRequest]
    clock: str | ClockRequest | None
    time_limit: float
    size: int
    reference_point: ArrayLike
    geometry: Literal["straight", "roads"]
    seed: int


class LayerRequest(TypedDict, total=False):
    """A cost layer on a map: an objective with a name."""

    name: Required[str]
    unit: str
    layer: Required[ArrayLike]


class CoverageRequest(PlanRequest, total=False):
    """The members of a request to POST /coverage: map, places, and costs beside the metres."""

    grid: ArrayLike
    occupancy_grid: Mapping[str, Any]
    start: int | None
    end: int | None
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
    """A robot: where it starts, and with `closed` false also where it ends."""

    id: Required[str]
    start: int
    start_pose: ArrayLike
    end: int
    end_pose: ArrayLike


class RobotsRequest(CoverageRequest, total=False):
    """The members of a request to POST /coverage for several robots that share the places."""

    robots: Required[Sequence[RobotRequest]]
    over: Sequence[Literal["sum", "max"]]


class RouteRequest(TypedDict, total=False):
    """A route of the plan that is driven, whose vehicle has left."""

    route: Required[int]
    done: Sequence[int | str]
    position: int | str | Mapping[str, Any] | None
    broken_down: bool


class ReplanFleetRequest(TypedDict, total=False):
    """The members of a request to POST /front/{id}/replan about a fleet."""

    plan: int | None
    now: float | None
    routes: Sequence[RouteRequest]
    add: Sequence[Mapping[str, Any]]
    remove: Sequence[int | str]
    costs: Sequence[Mapping[str, Any]]
    time_limit: float
    size: int
    reference_point: ArrayLike
    geometry: Literal["straight", "roads"]
    seed: int


class ReplanRequest(PlanOptions, total=False):
    """The members of a request to POST /front/{id}/replan: what has changed since.

    Stops are named by their ids, or by their indexes in the front. On a map, a new place and the
    position of the robot are given as row and column.
    """

    done: Sequence[int | str] | ArrayLike
    position: int | str | Mapping[str, Any] | ArrayLike
    add: Sequence[Mapping[str, Any]] | ArrayLike
    remove: Sequence[int | str] | ArrayLike
    costs: Sequence[Mapping[str, Any]]
    objectives: Sequence[ObjectiveRequest]
    now: float
    tour: Sequence[int | str] | ArrayLike
    min_kept: float
    geometry: Literal["straight", "roads"]
    pose: ArrayLike
    grid: ArrayLike
    blocked: ArrayLike
    freed: ArrayLike
    cost_layer: ArrayLike
    cost_layers: Sequence[LayerRequest]
    paths: bool


def explaining(*requests: type) -> Callable[[Function], Function]:
    """Return a decorator that adds what the members of these requests are to a function's help."""

    def decorate(function: Function) -> Function:
        sections = [cleandoc(function.__doc__ or "")]
        for request in requests:
            title = f"Members of the request ({request.__name__}):"
            sections.append("\n    ".join((title, *_HELP[request.__name__])))
        function.__doc__ = "\n\n".join(sections)
        return function

    return decorate
