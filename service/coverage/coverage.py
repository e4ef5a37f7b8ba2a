"""Coverage tasks: a map, a robot, places to visit and a second objective between them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.coverage.frame import MapFrame
from service.coverage.robots import Robot, poses_of
from service.errors import InvalidCoverage
from service.instance import CLOSED, RouteEnds

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Cells = NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Coverage:
    """A coverage task: a grid, a robot, places to visit, and a second objective.

    Exactly one of `places` and `spacing` is given, and exactly one source of the second objective:
    a matrix, a layer or coordinates. Robots may do without, and have both their objectives in
    metres.

    Args:
        blocked: Obstacles, shape (rows, columns).
        cell_size: The side of a cell, in metres.
        origin: The pose of the map's lower left corner, as MapFrame has it; None if nobody knows.
        robot_radius: In metres.
        places: Rows and columns of the places, shape (n, 2).
        spacing: In metres. The places cover the region of the start pose, or without one the
            largest free region: one in each square of this side.
        start: The place from which all others must be reachable.
        ends: Whether tours are closed, and the places at which open routes start and end.
        start_pose: Instead of both starts, x and y in the frame of the map, and maybe more, which
            is disregarded: a place of its own, if none is there.
        end_pose: Instead of the end of open routes, likewise.
        second_matrix: Costs between places, shape (n, n).
        cost_layer: Costs on the grid, shape (rows, columns).
        second_coordinates: Coordinates of the places in a plane, shape (n, 2).
        robots: Those that share the places, each with a start of its own instead of `start`, `ends`
            and both poses; none where one robot visits all places.

    Raises:
        InvalidCoverage: A size is not positive, a cost layer does not fit the grid or has an
            invalid cost, or both or neither of two alternatives are given.
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
    cost_layer: Array | None = None
    second_coordinates: Array | None = None
    robots: tuple[Robot, ...] = ()

    def __post_init__(self) -> None:
        if not 0 < self.cell_size < np.inf:
            raise InvalidCoverage(("cell_size", f"must be positive, got {self.cell_size:g}"))
        if not 0 <= self.robot_radius < np.inf:
            demand = f"must not be negative, got {self.robot_radius:g}"
            raise InvalidCoverage(("robot_radius", demand))
        if (self.places is None) == (self.spacing is None):
            raise InvalidCoverage(("places", "or spacing is required, and not both"))
        if self.spacing is not None and not 0 < self.spacing < np.inf:
            raise InvalidCoverage(("spacing", f"must be positive, got {self.spacing:g}"))
        second = (self.second_matrix, self.cost_layer, self.second_coordinates)
        given = sum(source is not None for source in second)
        if given > 1 or (given == 0 and not self.robots):
            demand = "or cost_layer or second_coordinates is required, and only one of them"
            raise InvalidCoverage(("second_matrix", demand))
        for name in self.poses:
            if self.frame is None:
                raise InvalidCoverage((name, "must be in the frame of a map with an origin"))
        self._check_layer()

    @property
    def frame(self) -> MapFrame | None:
        """The frame that the map lies in, where its origin is known."""
        if self.origin is None:
            return None
        return MapFrame(origin=self.origin, cell_size=self.cell_size, rows=len(self.blocked))

    @property
    def poses(self) -> dict[str, Sequence[float]]:
        """The poses at which tours start and end, by name, as far as they are given."""
        poses = {"start_pose": self.start_pose, "end_pose": self.end_pose}
        given = {name: pose for name, pose in poses.items() if pose is not None}
        return {**given, **poses_of(self.robots)}

    @property
    def has_costs(self) -> bool:
        """Whether the second objective is not the metres of the first."""
        return self.has_costs_of_places_alone or self.cost_layer is not None

    @property
    def has_costs_of_places_alone(self) -> bool:
        """Whether the second objective has no costs of other cells than the places."""
        return self.second_matrix is not None or self.second_coordinates is not None

    @property
    def size(self) -> str:
        """The size of the grid in words."""
        return size_of(self.blocked)

    @property
    def far_enough(self) -> str:
        """How far the robot has to be from obstacles, in words."""
        return f"farther than {self.robot_radius:g} m from every obstacle"

    def _check_layer(self) -> None:
        layer = self.cost_layer
        if layer is None:
            return
        if layer.shape != self.blocked.shape:
            demand = f"must be as large as grid, {self.size}, got {size_of(layer)}"
            raise InvalidCoverage(("cost_layer", demand))
        costs = (layer >= 0) & (layer < np.inf)
        if not costs.all():
            row, column = np.unravel_index(costs.argmin(), costs.shape)
            demand = f"must be finite and not negative, got {layer[row, column]:g}"
            raise InvalidCoverage((f"cost_layer/{row}/{column}", demand))


def size_of(cells: NDArray[np.generic]) -> str:
    """Return the size of a grid, shape (rows, columns), in words."""
    return f"{cells.shape[0]} x {cells.shape[1]} cells"
