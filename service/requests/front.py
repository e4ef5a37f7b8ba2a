"""Requests of `POST /front`: their fields, and the plan that they ask for."""

from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, GetPydanticSchema
from pydantic_core.core_schema import no_info_after_validator_function

from service.errors import invalid
from service.instance import OBJECTIVES, PLANE, Kind
from service.requests.arrays import stack_matrices
from service.requests.schemas import (
    END,
    GEOMETRY,
    NO_WAY,
    START,
    AsInteger,
    CostRows,
    Geometry,
    Number,
    PlanRequest,
)
from service.requests.stop_fields import (
    ObjectiveItem,
    StopItem,
    StopReference,
    read_objectives,
    read_stops,
)
from service.requests.stops import (
    Labels,
    Matrix,
    Plane,
    Source,
    Stop,
    Stops,
    kind_of,
    locations_of,
)

_COLUMNS = 2 * OBJECTIVES  # x and y in the plane of each objective
_MOST_SYMMETRIES = 8  # that earlier versions showed the network
FORMS = ("coordinates", "matrices", "stops")  # of a request, each named by its member
City = Annotated[list[Number], Field(min_length=_COLUMNS, max_length=_COLUMNS, fail_fast=True)]
_MatrixRows = Annotated[
    list[CostRows], Field(min_length=OBJECTIVES, max_length=OBJECTIVES, fail_fast=True)
]
Matrices = Annotated[
    NDArray[np.float64],
    GetPydanticSchema(
        lambda _, handler: no_info_after_validator_function(stack_matrices, handler(_MatrixRows))
    ),
]


class FrontRequest(PlanRequest):
    """Stops or stops under two objectives, and the options of their front.

    A request is complete only after `parse_front_request` has checked it.
    """

    # An empty default means that the field was not given: no caller can give an empty array.
    coordinates: Annotated[list[City], Field(min_length=1, fail_fast=True)] = Field(
        default_factory=list,
        description="a row for each city: x and y in plane 1, x and y in plane 2",
    )
    matrices: Matrices = Field(
        default_factory=lambda: np.empty((OBJECTIVES, 0, 0)),
        description="instead of coordinates, for each objective the costs from each city (row) to"
        f" each (column), {NO_WAY}",
    )
    stops: Annotated[list[StopItem], Field(min_length=1, fail_fast=True)] = Field(
        default_factory=list, description="the cities, by ids that come back with every tour"
    )
    objectives: Annotated[
        list[ObjectiveItem],
        Field(min_length=OBJECTIVES, max_length=OBJECTIVES, fail_fast=True),
    ] = Field(default_factory=list, description="both, each with the costs between the stops")
    # In a checked request these hold only indexes, as in every PlanRequest.
    start: StopReference | None = Field(  # type: ignore[assignment]
        default=0, description=f"{START}; by index or id"
    )
    end: StopReference | None = Field(  # type: ignore[assignment]
        default=None, description=f"{END}; by index or id"
    )
    initial_tours: Annotated[
        list[Annotated[list[StopReference], Field(fail_fast=True)]],
        Field(min_length=1, fail_fast=True),
    ] = Field(  # type: ignore[assignment]
        default_factory=list,
        description="tours that the front shall dominate or equal, of indexes or ids",
    )
    augment: Annotated[int, Field(ge=1, le=_MOST_SYMMETRIES), AsInteger] = Field(
        default=1,
        description="without effect; repairs find better tours in less time",
        json_schema_extra={"deprecated": True},
    )
    geometry: Geometry = Field(default="straight", description=GEOMETRY)

    @property
    def kind(self) -> Kind:
        """The kind of instance that an actor has to read."""
        if self.stops:
            return kind_of(self.sources)
        return "coordinates" if self.coordinates else "matrices"

    @property
    def n(self) -> int:
        """The number of cities."""
        return len(self.stops) or len(self.coordinates) or self.matrices.shape[1]

    @cached_property
    def labels(self) -> Labels | None:
        """The names of stops and objectives; None if they have none."""
        if not self.stops:
            return None
        return Labels(read_stops(self.stops), read_objectives(self.objectives))

    @cached_property
    def sources(self) -> tuple[Source, ...]:
        """The source of the costs of each objective."""
        if self.labels is not None:
            return self._sources(self.labels.stops)
        if self.coordinates:
            cities = np.array(self.coordinates, np.float64)
            return tuple(Plane(cities[:, m : m + PLANE]) for m in range(0, _COLUMNS, PLANE))
        return tuple(Matrix(matrix) for matrix in self.matrices)

    @property
    def subject(self) -> Stops:
        """The stops to plan; those of a checked request have the indexes of their ends."""
        stops = () if self.labels is None else self.labels.stops
        locations = locations_of(stops) if stops else np.full((self.n, 2), np.nan)
        return Stops(locations, self.sources, self.ends)

    def _sources(self, stops: tuple[Stop, ...]) -> tuple[Source, ...]:
        """Return the source of each objective; with a file, its matrices are the sources."""
        if not self.matrices.size:
            items = enumerate(self.objectives)
            return tuple(item.source(f"objectives/{m}", stops) for m, item in items)
        for m, item in enumerate(self.objectives):
            if item.sources:
                demand = "must have no source where the part matrices holds both, got"
                raise invalid(f"objectives/{m}", f"{demand} {' and '.join(item.sources)}")
        return tuple(Matrix(matrix) for matrix in self.matrices)
