"""Coverage tasks: a map, robots, places to visit and a second objective between them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from service.coverage.frame import Array, Cells, MapFrame, Mask
from service.errors import CityNames, uncoverable
from service.instance import CLOSED, RouteEnds
from service.objectives import Objective

METRES, SECONDS = Objective("distance", "m"), Objective("time", "s")
COSTS = Objective("cost", None)


@dataclass(frozen=True, kw_only=True)
class Robot:
    """A robot with a start of its own.

    Args:
        id: The name that comes back with its routes.
        closed: Whether it returns to its start.
        start: The place where it starts.
        end: The place where it ends if it does not return; None allows any place.
        start_pose: Replaces the start, as in Coverage.
        end_pose: Replaces the end, in the same way.
    """

    id: str
    closed: bool = True
    start: int | None = None
    end: int | None = None
    start_pose: Sequence[float] | None = None
    end_pose: Sequence[float] | None = None

    def ends(self, part: str, poses: Mapping[str, int]) -> RouteEnds:
        """Return the places where it starts and ends.

        Args:
            part: Its part of the request, such as robots/0.
            poses: The place of each pose, by its part, such as robots/0/start_pose.
        """
        start = poses.get(f"{part}/start_pose", self.start)
        return RouteEnds(self.closed, start, poses.get(f"{part}/end_pose", self.end))


@dataclass(frozen=True, kw_only=True)
class RobotHours:
    """When robots leave, how fast they are, and how costs change over the day.

    Args:
        speed: Metres a second, before the factors of the first objective.
        earliest: The first second of the day at which a robot may leave.
        latest: The last one.
        factors: For each of the different costs, ascending seconds of the day, each with the factor
            that holds from then on. The first one holds before that too. There may be none.
    """

    speed: float
    earliest: float
    latest: float
    factors: tuple[tuple[tuple[float, float], ...], ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class Coverage:
    """A coverage task.

    The first objective is metres. Exactly one of `places` and `spacing` is given, and exactly one
    source of the other objectives: a matrix, layers or coordinates. A task with `robots` has two
    objectives and needs no such source: then both are metres.

    Args:
        blocked: Obstacles, shape (rows, columns).
        cell_size: The side of a cell, in metres.
        origin: The pose of the map's lower left corner, as in MapFrame; None if it is unknown.
        robot_radius: The radius of the robot, in metres.
        places: Rows and columns of the places, shape (n, 2).
        spacing: A distance in metres. The places cover the region of the first pose, or without
            poses the largest free region: one in each square of this side.
        start: The place from which all others must be reachable.
        ends: Whether tours are closed, and the places at which open routes start and end.
        start_pose: Replaces both starts: x and y in the frame of the map; further numbers are
            ignored. Its cell becomes a place, if it is not one already.
        end_pose: Replaces the end of open routes, in the same way.
        second_matrix: Costs between places, shape (n, n).
        cost_layers: Costs on the grid, shape (layers, rows, columns), one to three layers. Each is
            an objective.
        layers: The caller's names of the layers; empty if there are none.
        detours: Whether a path between two places may give up metres for what the layers cost.
        second_coordinates: Coordinates of the places in a plane, shape (n, 2).
        robots: The robots that share the places. Each has a start of its own, which replaces
            `start`, `ends` and both poses. Empty if one robot visits all places.
        hours: The day, if costs depend on the time. The first objective is then seconds.

    Raises:
        InvalidCoverage: A size is not positive, a cost layer does not fit the grid or has an
            invalid cost, both or neither of two alternatives are given, or detours without layers.
    """

    blocked: Mask
    cell_size: float
    origin: Sequence[float] | None = None
    robot_radius: float = 0.0
    places: Cells | None = None
    spacing: float | None = None
    start: int = 0
    ends: RouteEnds = CLOSED
    start_pose: Sequence[float] | None = None
    end_pose: Sequence[float] | None = None
    second_matrix: Array | None = None
    cost_layers: Array | None = None
    layers: tuple[Objective, ...] = ()
    detours: bool = False
    second_coordinates: Array | None = None
    robots: tuple[Robot, ...] = ()
    hours: RobotHours | None = None
    stops: ClassVar[None] = None  # a map has places

    def __post_init__(self) -> None:
        if not 0 < self.cell_size < np.inf:
            raise uncoverable("cell_size", "not-positive", came=self.cell_size)
        if not 0 <= self.robot_radius < np.inf:
            raise uncoverable("robot_radius", "negative", came=self.robot_radius)
        if (self.places is None) == (self.spacing is None):
            raise uncoverable("places", "not-places-or-spacing")
        if self.spacing is not None and not 0 < self.spacing < np.inf:
            raise uncoverable("spacing", "not-positive", came=self.spacing)
        second = (self.second_matrix, self.cost_layers, self.second_coordinates)
        given = sum(source is not None for source in second)
        if given > 1 or (given == 0 and not self.robots):
            raise uncoverable("second_matrix", "not-one-second")
        if self.frame is None:
            for name in self.poses:
                raise uncoverable(name, "no-origin")
        self._check_layers()

    @property
    def frame(self) -> MapFrame | None:
        """The frame of the map, if its origin is known."""
        if self.origin is None:
            return None
        return MapFrame(origin=self.origin, cell_size=self.cell_size, rows=len(self.blocked))

    @property
    def robot_parts(self) -> Iterator[tuple[str, Robot]]:
        """Each robot after its part of the request, such as robots/0."""
        return ((f"robots/{index}", robot) for index, robot in enumerate(self.robots))

    @property
    def poses(self) -> dict[str, Sequence[float]]:
        """The poses that are given, by part of the request, such as robots/0/start_pose."""
        poses = {"start_pose": self.start_pose, "end_pose": self.end_pose}
        for part, robot in self.robot_parts:
            poses[f"{part}/start_pose"] = robot.start_pose
            poses[f"{part}/end_pose"] = robot.end_pose
        return {name: pose for name, pose in poses.items() if pose is not None}

    @property
    def city_names(self) -> CityNames:
        """The names of its places in refusals."""
        return CityNames("place", part=None if self.places is None else "places")

    @property
    def objectives(self) -> int:
        """The number of objectives: metres, and the layers or the one other source."""
        return 2 if self.cost_layers is None else 1 + len(self.cost_layers)

    @property
    def names(self) -> tuple[Objective, ...]:
        """The names of all objectives; none where the caller gave none and they are metres."""
        if self.hours is not None:
            return (SECONDS, *(self.layers or (COSTS,)))
        return (METRES, *self.layers) if self.layers else ()

    @property
    def has_costs(self) -> bool:
        """Whether the second objective is not the metres of the first."""
        return self.has_costs_of_places_alone or self.cost_layers is not None

    @property
    def has_costs_of_places_alone(self) -> bool:
        """Whether the second objective has costs between the given places only."""
        return self.second_matrix is not None or self.second_coordinates is not None

    @property
    def size(self) -> str:
        """The size of the grid in words."""
        return size_of(self.blocked)

    @property
    def far_enough(self) -> str:
        """How far the robot has to be from obstacles, in words."""
        return f"farther than {self.robot_radius:g} m from every obstacle"

    def _check_layers(self) -> None:
        layers = self.cost_layers
        if layers is None:
            if self.detours:
                raise uncoverable("detours", "detours-of-no-layer")
            return
        for index, layer in enumerate(layers):
            part = f"cost_layers/{index}/layer" if self.layers else "cost_layer"
            check_layer(layer, part, self.blocked)


def check_layer(layer: Array, part: str, grid: NDArray[np.generic]) -> None:
    """Raise InvalidCoverage where a layer of this part of a request does not fit the grid."""
    if layer.shape != grid.shape:
        sizes = {"size": size_of(grid), "given": size_of(layer)}
        raise uncoverable(part, "other-size", like="grid", **sizes)
    costs = (layer >= 0) & (layer < np.inf)
    if not costs.all():
        row, column = np.unravel_index(costs.argmin(), costs.shape)
        raise uncoverable(f"{part}/{row}/{column}", "not-finite", came=float(layer[row, column]))


def size_of(cells: NDArray[np.generic]) -> str:
    """Return the size of a grid, shape (rows, columns), in words."""
    return f"{cells.shape[0]} x {cells.shape[1]} cells"
