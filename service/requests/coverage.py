"""Requests of `POST /coverage`: their fields, and their parser."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from service.coverage.coverage import Coverage, Robot
from service.errors import invalid
from service.fleet.rules import Over
from service.instance import CLOSED, RouteEnds
from service.requests.arrays import Array, array_field, check_costs, cost_matrix
from service.requests.fields import (
    NO_WAY,
    Cost,
    CostRows,
    NonNegativeInteger,
    Number,
    Offered,
    OneForBoth,
    Pair,
    PlanePoint,
    PositiveNumber,
    SomeItems,
    StrictModel,
    Text,
    empty_list,
    unless_given,
)
from service.requests.limits import Limits, tours_within_limits
from service.requests.maps.day import MapDayFields
from service.requests.maps.fields import CostLayers, Layer, MapRequest, empty_rows, stacked
from service.requests.stop_fields import check_unique
from service.requests.task import SharedCoverage
from service.requests.validation import parse_json, too_many_cities

Matrix = Annotated[NDArray[np.float64], array_field(cost_matrix, CostRows)]
Cell = Pair[NonNegativeInteger]

MOST_ROBOTS = 100
DEFAULT_OVER: tuple[Over, Over] = ("sum", "max")
RobotPose = Annotated[list[Number], Field(min_length=2, max_length=3, fail_fast=True)]
# The fields that are about the tours of one robot, or about the network that builds them.
OF_ONE_ROBOT = (
    *("start", "end", "start_pose", "end_pose", "cost_layers", "detours", "initial_tours"),
    *("preferences", "repairs", "arrivals", "bound", "actor"),
)
ENDS = (("start", "start_pose"), ("end", "end_pose"))


class RobotItem(StrictModel):
    """A robot: where it starts and, where robots do not return, maybe where it ends."""

    id: Text = Field(description="comes back with its routes; no two robots share one")
    start: NonNegativeInteger = Field(
        default=0, description="the place where it starts, which needs no other visit"
    )
    start_pose: RobotPose = empty_list(
        "instead of start: x and y, and maybe yaw, in the frame of the map"
    )
    end: NonNegativeInteger = unless_given(
        0, "with closed false, the place where it ends; by default anywhere"
    )
    end_pose: RobotPose = empty_list("instead of end: where it ends, in the frame of the map")

    def robot(self, closed: bool) -> Robot:
        """Return the robot, which returns to its start where routes are closed."""
        given = self.model_fields_set
        return Robot(
            id=self.id,
            closed=closed,
            start=None if self.start_pose else self.start,
            end=self.end if "end" in given else None,
            start_pose=self.start_pose or None,
            end_pose=self.end_pose or None,
        )


class CoverageRequest(MapDayFields, MapRequest):
    """Places on a map, the objectives between them, and the options of their front."""

    robot_radius: Annotated[
        Cost, Offered(option="", label="Robot\u2019s radius, m", initial="")
    ] = Field(
        default=0.0,
        description="in metres; the centre of the robot stays farther than this from the centre of"
        " every obstacle cell",
    )
    places: SomeItems[Cell] = empty_list("row and column of each place to visit")
    spacing: Annotated[PositiveNumber, Offered(option="", label="Places apart, m")] = unless_given(
        0.0,
        "instead of places, in metres: places are laid out, one in each square of this"
        " side, over the region of the start pose or the largest free region",
    )
    start_pose: Annotated[
        RobotPose,
        Offered(option="Where the robot is: x and y in the frame of the map, such as -2.0,-0.5."),
    ] = empty_list(
        "instead of start: x and y, and maybe yaw, of the robot in the frame of the map; the tours"
        " begin in this cell, which is a place of its own if none is there"
    )
    end_pose: Annotated[
        RobotPose,
        Offered(option="Where the robot must end, in the same form; with --open."),
    ] = empty_list("instead of end, where routes are open: the pose at which they end")
    second_matrix: Matrix = empty_rows(
        f"the second objective: its costs from each place (row) to each (column), {NO_WAY}"
    )
    cost_layer: Layer = empty_rows(
        "or: the cost of a metre on each cell of the grid; costs are added up along the paths"
    )
    cost_layers: CostLayers = empty_list(
        "or: one to three such layers, each an objective with a name"
    )
    detours: Annotated[bool, Offered(option="", label="Longer paths where they cost less")] = Field(
        default=False,
        description="with cost layers: whether a path between two places may give up metres for"
        " cost; by default it is a shortest one",
    )
    second_coordinates: SomeItems[PlanePoint] = empty_list(
        "or: x and y of each place in a plane; its distances"
    )
    paths: Annotated[
        bool,
        Offered(option="With --json, add the path of each tour, in cells and metres."),
    ] = Field(
        default=False, description="whether each tour, or each route of a robot, has its path"
    )
    robots: Annotated[
        list[RobotItem], Field(min_length=1, max_length=MOST_ROBOTS, fail_fast=True)
    ] = empty_list(
        "several robots that share the places; the answer is a front of plans. They may do without"
        " a second objective: then both are metres"
    )
    over: OneForBoth[Over] = Field(
        default_factory=lambda: list(DEFAULT_OVER),
        description="for robots: whether the length of a plan in each objective is the sum over its"
        " routes or the longest route; max for one objective at most; by default sum and"
        " max",
    )

    @property
    def ends(self) -> RouteEnds:
        """Whether tours are closed, and where open routes start and end, if not at the pose."""
        given = super().ends
        return given._replace(start=None) if self.start_pose else given

    def coverage(self) -> Coverage:
        """Return the map and its places as a coverage task."""
        points = self.second_coordinates
        return Coverage(
            blocked=self.grid > 0,
            cell_size=self.cell_size,
            origin=self.origin or None,
            robot_radius=self.robot_radius,
            places=np.array(self.places, dtype=np.int64) if self.places else None,
            spacing=self.spacing or None,
            start=self.start or 0,
            ends=CLOSED if self.robots else self.ends,
            start_pose=self.start_pose or None,
            end_pose=self.end_pose or None,
            second_matrix=self.second_matrix if self.second_matrix.size else None,
            cost_layers=self._layers(),
            layers=tuple(item.objective for item in self.cost_layers),
            detours=self.detours,
            second_coordinates=np.array(points, dtype=np.float64) if points else None,
            robots=tuple(robot.robot(self.closed) for robot in self.robots),
            hours=self.hours(self._costs),
        )

    @property
    def _costs(self) -> int:
        """The number of different costs between places."""
        if self.cost_layers:
            return 1 + len(self.cost_layers)
        second = self.second_matrix.size or self.cost_layer.size or self.second_coordinates
        return 2 if second or not self.robots else 1

    def _layers(self) -> Array | None:
        """Return all cost layers, shape (layers, rows, columns); None without one."""
        return self.cost_layer[np.newaxis] if self.cost_layer.size else stacked(self.cost_layers)

    def shared(self) -> SharedCoverage:
        """Return the task that the robots share."""
        first, second = self.over
        return SharedCoverage(self.coverage(), (first, second))


def parse_coverage_request(
    body: bytes, limits: Limits, picture: bytes | None = None
) -> CoverageRequest:
    """Return the request in a JSON body, with the map of a picture where one came with it.

    Raises:
        Refusal: The body is not JSON, misses the schema, is over a limit or has no map.
    """
    request = parse_json(CoverageRequest, body).with_map(picture, limits.cells)
    check_unique([item.name for item in request.cost_layers], "cost_layers", "name")
    if request.cost_layer.size and request.cost_layers:
        raise invalid("cost_layers", "or-left-out", member="cost_layer")
    if request.detours and request.departure is not None:
        raise invalid("detours", "not-beside", member="departure")
    most = limits.most_places(shared=bool(request.robots))
    if len(request.places) > most:
        raise too_many_cities("places", most, len(request.places))
    _check_poses(request)
    if request.robots:
        _check_robots(request)
    elif "over" in request.model_fields_set:
        raise invalid("over", "of-robots")
    check_costs(request.second_matrix, "second_matrix")
    # With a spacing, the number of places is not known before the survey.
    return tours_within_limits(request, len(request.places) or most, limits)


def _check_poses(request: CoverageRequest) -> None:
    given = request.model_fields_set
    if request.initial_tours and not request.places:
        raise invalid("initial_tours", "tours-of-no-places")
    _check_ends(request)
    if request.initial_tours and {"start_pose", "end_pose"} & given:
        raise invalid("initial_tours", "tours-with-poses")
    if request.closed and request.end_pose:
        raise invalid("end_pose", "of-open-routes")


def _check_ends(item: CoverageRequest | RobotItem, part: str = "") -> None:
    """Raise a refusal where a start or an end is given as a place and as a pose."""
    for place, pose in ENDS:
        if getattr(item, place) is not None and {place, pose} <= item.model_fields_set:
            raise invalid(f"{part}{pose}", "or-left-out", member=place)


def _check_robots(request: CoverageRequest) -> None:
    """Raise a refusal where the robots of a request contradict its other fields, or each other."""
    given = request.model_fields_set
    for name in OF_ONE_ROBOT:
        if name in given and getattr(request, name) is not None:
            raise invalid(name, "with-robots")
    if request.over == ["max", "max"]:
        raise invalid("over/1", "two-max")
    check_unique([robot.id for robot in request.robots], "robots")
    for index, robot in enumerate(request.robots):
        _check_ends(robot, f"robots/{index}/")
        for name in ("end", "end_pose"):
            if request.closed and name in robot.model_fields_set:
                raise invalid(f"robots/{index}/{name}", "of-open-routes")
