"""Coverage requests: what they may say under given limits, and what one says."""

from collections.abc import Iterable
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, GetPydanticSchema, ValidationInfo
from pydantic_core.core_schema import with_info_after_validator_function

from service.coverage.survey import Coverage
from service.instance import Kind
from service.requests.arrays import Array, check_costs, read_grid, rectangular, square
from service.requests.front import parsed, plan_schema
from service.requests.limits import Limits, within
from service.requests.schemas import LARGEST, PlanRequest, Positive, Rows, Whole
from service.requests.validation import invalid, too_many_cells, too_many_cities


def _as_layer(rows: list[list[float]], info: ValidationInfo) -> Array:
    return rectangular(rows, str(info.field_name))


def _as_square(rows: list[list[float]], info: ValidationInfo) -> Array:
    return square(rows, str(info.field_name))


Layer = Annotated[
    NDArray[np.float64],
    GetPydanticSchema(lambda _, h: with_info_after_validator_function(_as_layer, h(Rows))),
]
Square = Annotated[
    NDArray[np.float64],
    GetPydanticSchema(lambda _, h: with_info_after_validator_function(_as_square, h(Rows))),
]
Cell = Annotated[list[Whole], Field(min_length=2, max_length=2, fail_fast=True)]
Finite = Annotated[float, Field(ge=-LARGEST, le=LARGEST, allow_inf_nan=False)]
Point = Annotated[list[Finite], Field(min_length=2, max_length=2, fail_fast=True)]


def _none() -> Array:
    return np.empty((0, 0))


class CoverageRequest(PlanRequest):
    """Places on a map that are to be visited, and what is asked of the front.

    What is empty can only be a default: none is given.
    """

    grid: Layer = Field(
        default_factory=_none, description="the map, row by row: 0 where it is free, 1 an obstacle"
    )
    cell_size: Positive = Field(description="side of a cell, in metres")
    robot_radius: float = Field(
        default=0.0,
        ge=0,
        le=LARGEST,
        allow_inf_nan=False,
        description="in metres; the robot's middle stays farther than this from an obstacle's",
    )
    places: Annotated[list[Cell], Field(min_length=1, fail_fast=True)] = Field(
        default_factory=list, description="row and column of each place to visit"
    )
    spacing: Positive = Field(
        default=0.0,
        description="instead of places, in metres: one is laid in each square of this side over"
        " the largest free region",
    )
    second_matrix: Square = Field(
        default_factory=_none,
        description="the second objective: its costs from each place (row) to each (column)",
    )
    cost_layer: Layer = Field(
        default_factory=_none,
        description="or: on each cell of the grid, what a metre costs; added up along the paths",
    )
    second_coordinates: Annotated[list[Point], Field(min_length=1, fail_fast=True)] = Field(
        default_factory=list, description="or: x and y of each place in a plane; its distances"
    )
    paths: bool = Field(default=False, description="whether each tour comes with its path")

    @property
    def kind(self) -> Kind:
        """What an actor has to read."""
        return "matrices"

    def coverage(self) -> Coverage:
        """What is to be covered."""
        points = self.second_coordinates
        return Coverage(
            blocked=self.grid > 0,
            cell_size=self.cell_size,
            robot_radius=self.robot_radius,
            places=np.array(self.places, dtype=np.int64) if self.places else None,
            spacing=self.spacing or None,
            start=self.start,
            second_matrix=self.second_matrix if self.second_matrix.size else None,
            cost_layer=self.cost_layer if self.cost_layer.size else None,
            second_coordinates=np.array(points, dtype=np.float64) if points else None,
        )


def coverage_schema(limits: Limits, actors: Iterable[str]) -> dict[str, Any]:
    """The JSON schema of a request where these limits hold and these actors are loaded."""
    schema = plan_schema(CoverageRequest, limits, actors)
    fields = schema["properties"]
    fields["grid"]["items"]["items"] = {"enum": [0, 1]}
    del fields["spacing"]["default"]
    fields["places"]["maxItems"] = limits.cities
    schema["required"] = ["grid", "cell_size"]
    schema["allOf"] = [
        {"oneOf": [{"required": ["places"]}, {"required": ["spacing"]}]},
        {
            "oneOf": [
                {"required": [name]}
                for name in ("second_matrix", "cost_layer", "second_coordinates")
            ]
        },
    ]
    return schema


def parse_coverage_request(
    body: bytes, limits: Limits, image: bytes | None = None
) -> CoverageRequest:
    """The request in a body, with the map of a PNG file where one came with it.

    Raises:
        Refusal: it is not JSON, not a coverage request, over a limit, or about no map.
    """
    request = parsed(CoverageRequest, body)
    if image is not None:
        if "grid" in request.model_fields_set:
            raise invalid("grid", "must come once, got it as the part map as well")
        request = request.model_copy(update={"grid": read_grid(image, limits.cells)})
    _check_grid(request.grid, limits.cells)
    if len(request.places) > limits.cities:
        raise too_many_cities("places", limits.cities, len(request.places))
    if request.initial_tours and not request.places:
        raise invalid("initial_tours", "must be of places, and none are given")
    check_costs(request.second_matrix, "second_matrix", LARGEST)
    return within(limits, request, len(request.places) or limits.cities)


def _check_grid(grid: Array, most: int) -> None:
    if not grid.size:
        raise invalid("grid", "is required, as rows or as the part map")
    if grid.size > most:
        raise too_many_cells(most, grid.size, grid.size)
    binary = (grid == 0) | (grid == 1)
    if not binary.all():
        row, column = np.unravel_index(binary.argmin(), binary.shape)
        raise invalid(f"grid/{row}/{column}", f"must be 0 or 1, got {grid[row, column]:g}")
