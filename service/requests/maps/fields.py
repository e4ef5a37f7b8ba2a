"""The fields of a coverage request about its map, and the grid of obstacles that they make.

A map is the rows of `grid`, a picture beside the JSON, or an occupancy grid of ROS. The fields of a
picture go by the names of the keys of a map.yaml, so that one becomes a request by copying them.
"""

from collections.abc import Sequence
from typing import Annotated, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from service.coverage.coverage import size_of
from service.errors import invalid
from service.objectives import MOST_OBJECTIVES, Objective
from service.requests.arrays import Array, array_field, check_grid, rectangular_array
from service.requests.fields import (
    ArrayRows,
    AsInteger,
    Number,
    Offered,
    PlanRequest,
    PositiveNumber,
    Share,
    StrictModel,
    Text,
    empty_list,
    optional,
    shared_values,
    unless_given,
)
from service.requests.maps.occupancy_grid import OccupancyGrid
from service.requests.maps.pictures import (
    UNKNOWN,
    Interpretation,
    Mode,
    Occupancy,
    occupancy,
    read_picture,
)
from service.requests.validation import too_many_cells

Layer = Annotated[NDArray[np.float64], array_field(rectangular_array, ArrayRows)]
_Pose = Annotated[list[Number], Field(min_length=3, max_length=3, fail_fast=True)]

_OF_PICTURE = ("mode", "negate", "occupied_thresh", "free_thresh")
# The forms of a map in JSON, and the fields that do not apply to each.
USELESS = {
    "grid": (*_OF_PICTURE, "obstacle_from", "unknown"),
    "occupancy_grid": (*_OF_PICTURE, "cell_size", "origin"),
}


def empty_rows(description: str) -> Any:
    """Return a field that is an empty array where it was not given: no caller can give one."""
    return Field(default_factory=lambda: np.empty((0, 0)), description=description)


class LayerItem(StrictModel):
    """A cost layer with its name: an objective of its own."""

    name: Text = Field(description="comes back with the objective; no two layers share one")
    unit: Text | None = optional("comes back with the objective")
    layer: ArrayRows = Field(description="the cost of a metre on each cell of the grid")

    @property
    def objective(self) -> Objective:
        """Its name and its unit."""
        return Objective(self.name, self.unit)

    def array(self, index: int) -> Array:
        """Return its costs, shape (rows, columns); it is the layer of this index in its request.

        Raises:
            Refusal: The layer is empty, or its rows differ in length.
        """
        return rectangular_array(self.layer, f"cost_layers/{index}/layer")


def stacked(items: Sequence[LayerItem]) -> Array | None:
    """Return cost layers as an array, shape (layers, rows, columns); None without one.

    Raises:
        Refusal: They differ in size.
    """
    layers = [item.array(index) for index, item in enumerate(items)]
    for index, layer in enumerate(layers):
        if layer.shape != layers[0].shape:
            sizes = {"size": size_of(layers[0]), "given": " x ".join(map(str, layer.shape))}
            raise invalid(f"cost_layers/{index}/layer", "other-size", like="the first", **sizes)
    return np.stack(layers) if layers else None


CostLayers = Annotated[
    list[LayerItem], Field(min_length=1, max_length=MOST_OBJECTIVES - 1, fail_fast=True)
]


def _no_occupancy_grid() -> OccupancyGrid:
    return OccupancyGrid.model_construct()


class MapRequest(PlanRequest):
    """A map, in one of three forms."""

    grid: Layer = empty_rows("the map, row by row from the top: 0 where it is free, 1 an obstacle")
    occupancy_grid: OccupancyGrid = Field(
        default_factory=_no_occupancy_grid,
        description="or: a message nav_msgs/OccupancyGrid, which brings cell_size and origin",
    )
    cell_size: Annotated[PositiveNumber, Offered(option="", label="Metres a cell")] = unless_given(
        0.0, "side of a cell, in metres; resolution in a map.yaml"
    )
    origin: _Pose = empty_list(
        "x, y and yaw of the map's lower left corner in its frame, in metres and radians"
        " counterclockwise; with it paths have points, and there may be poses"
    )
    mode: Mode = unless_given("trinary", "how map_server reads a picture; needs both thresholds")
    negate: bool = Field(default=False, description="whether in a picture black is free")
    occupied_thresh: Share = Field(
        default=0.5, description="a pixel darker than this, 0 white to 1 black, is an obstacle"
    )
    free_thresh: Share = unless_given(
        0.0,
        "a pixel lighter than this is free, those between are unknown; without it"
        " every pixel that is not an obstacle is free, except grey 205, which is unknown",
    )
    obstacle_from: Annotated[int, Field(ge=1, le=100), AsInteger] = Field(
        default=50,
        description="occupancy, 0 to 100, from which a cell is an obstacle: of an occupancy_grid,"
        " and of a picture in mode scale or raw",
    )
    unknown: Annotated[Literal["blocked", "free"], Offered(option="")] = Field(
        default="blocked", description="whether unknown cells are free for the robot, or blocked"
    )

    def with_map(self, picture: bytes | None, most_cells: int) -> Self:
        """Return the request with the grid, the cell_size and the origin of its map in any form.

        Raises:
            Refusal: Not exactly one map is given, or it cannot be read, or is too large; or a
                field is given that does not apply to this form.
        """
        return self.with_occupancy(picture, most_cells)[0]

    def with_occupancy(
        self, picture: bytes | None, most_cells: int
    ) -> tuple[Self, Occupancy | None]:
        """Return what `with_map` returns, and the occupancy that the map says.

        The occupancy has shape (rows, columns). It is None where the map came as rows of `grid`,
        which do not tell unknown cells from obstacles.
        """
        self._check_forms(picture)
        message = self.occupancy_grid
        update: dict[str, Any] = {}
        if picture is not None:
            values = occupancy(read_picture(picture, most_cells), self._interpretation())
        elif "occupancy_grid" in self.model_fields_set:
            values = message.occupancy(most_cells)
            update["cell_size"] = message.info.resolution
            update["origin"] = list(message.origin())
            update["occupancy_grid"] = _no_occupancy_grid()
        else:
            if self.grid.size > most_cells:
                raise too_many_cells(most_cells, self.grid.size, self.grid.size)
            check_grid(self.grid)
            return self, None
        return self.model_copy(update={"grid": self._blocked(values), **update}), values

    def _check_forms(self, picture: bytes | None) -> None:
        given = self.model_fields_set
        forms = [form for form in USELESS if form in given]
        if picture is not None:
            forms.append("the part map")
        if not forms:
            raise invalid("grid", "no-grid")
        if len(forms) > 1:
            raise invalid("grid", "grid-twice", given=" and as ".join(forms))
        for name in USELESS.get(forms[0], ()):
            if name in given:
                raise invalid(name, "useless-with-form", form=forms[0])
        if forms != ["occupancy_grid"] and "cell_size" not in given:
            raise invalid("cell_size", "missing")

    def _interpretation(self) -> Interpretation:
        given = self.model_fields_set
        mode = self.mode if {"mode", "free_thresh"} & given else None
        if mode in ("trinary", "scale"):
            self._check_thresholds()
        return Interpretation(**{**shared_values(self, Interpretation), "mode": mode})

    def _check_thresholds(self) -> None:
        for name in ("occupied_thresh", "free_thresh"):
            if name not in self.model_fields_set:
                raise invalid(name, "needed-by-mode", mode=self.mode)
        if self.free_thresh >= self.occupied_thresh:
            most, came = self.occupied_thresh, self.free_thresh
            raise invalid("free_thresh", "thresholds-crossed", limit=most, came=came)

    def _blocked(self, values: Occupancy) -> Array:
        blocked = values >= self.obstacle_from
        if self.unknown == "blocked":
            blocked |= values == UNKNOWN
        return blocked.astype(np.float64)
