"""Requests of `POST /front`: their fields, their JSON schema and their parser."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, GetPydanticSchema
from pydantic_core.core_schema import no_info_after_validator_function

from service.errors import Refusal
from service.instance import MAX_SYMMETRIES, OBJECTIVES, Instance, Kind
from service.planner import PlanOptions
from service.requests.arrays import check_costs, stack_matrices
from service.requests.limits import Limits, check_limits, limited_schema, lower_defaults
from service.requests.npy import read_npy
from service.requests.schemas import LARGEST, ArrayRows, AsInteger, Number, PlanRequest
from service.requests.validation import invalid, parse_json, too_many_cities

_COLUMNS = 2 * OBJECTIVES  # x and y in the plane of each objective
City = Annotated[list[Number], Field(min_length=_COLUMNS, max_length=_COLUMNS, fail_fast=True)]
_MatrixRows = Annotated[
    list[ArrayRows], Field(min_length=OBJECTIVES, max_length=OBJECTIVES, fail_fast=True)
]
Matrices = Annotated[
    NDArray[np.float64],
    GetPydanticSchema(
        lambda _, handler: no_info_after_validator_function(stack_matrices, handler(_MatrixRows))
    ),
]


class FrontRequest(PlanRequest):
    """Cities under two objectives, by coordinates or matrices, and the options of their front."""

    # An empty default means that the field was not given: no caller can give an empty array.
    coordinates: Annotated[list[City], Field(min_length=1, fail_fast=True)] = Field(
        default_factory=list,
        description="a row for each city: x and y in plane 1, x and y in plane 2",
    )
    matrices: Matrices = Field(
        default_factory=lambda: np.empty((OBJECTIVES, 0, 0)),
        description="instead of coordinates, for each objective the costs from each city (row) to"
        " each (column); the diagonal is disregarded",
    )
    augment: Annotated[int, Field(ge=1, le=MAX_SYMMETRIES), AsInteger] = Field(
        default=1,
        description="how many times the network is called: each time it sees the coordinates under"
        " another symmetry of the square, and aims between the angles of the other calls",
    )

    @property
    def kind(self) -> Kind:
        """The kind of instance that an actor has to read."""
        return "coordinates" if self.coordinates else "matrices"

    @property
    def n(self) -> int:
        """The number of cities."""
        return len(self.coordinates) or self.matrices.shape[1]

    def instance(self) -> Instance:
        """Return the cities as an instance."""
        if self.kind == "matrices":
            return Instance(matrices=self.matrices)
        return Instance(coordinates=np.array(self.coordinates, dtype=np.float64))

    def options(self) -> PlanOptions:
        """Return the options for the planner."""
        return replace(super().options(), augment=self.augment)


def front_schema(limits: Limits, actors: Iterable[str]) -> dict[str, Any]:
    """Return the JSON schema of a request under these limits, with these actors to choose from."""
    schema = limited_schema(FrontRequest, limits, actors)
    fields = schema["properties"]
    schema["oneOf"] = [{"required": ["coordinates"]}, {"required": ["matrices"]}]
    schema["dependentSchemas"] = {"matrices": {"properties": {"augment": {"const": 1}}}}
    fields["coordinates"]["maxItems"] = limits.cities
    rows = fields["matrices"]["items"]
    rows["minItems"], rows["maxItems"] = 1, limits.cities
    return schema


def parse_front_request(body: bytes, limits: Limits, npy: bytes | None = None) -> FrontRequest:
    """Return the request in a JSON body, with the matrices of a .npy file where one came with it.

    Raises:
        Refusal: The body is not JSON, misses the schema or is over a limit.
    """
    request = parse_json(FrontRequest, body)
    if npy is not None:
        if "matrices" in request.model_fields_set:
            raise invalid("matrices", "must come once, got them as a part as well")
        request = request.model_copy(update={"matrices": read_npy(npy, limits.cities)})
    _check_cities(request, limits)
    check_limits(request, request.n, limits)
    return lower_defaults(request, limits)


def _check_cities(request: FrontRequest, limits: Limits) -> None:
    sources = {"coordinates", "matrices"} & request.model_fields_set
    if len(sources) != 1:
        came = "both" if sources else "neither"
        sentence = f"either coordinates or matrices are required, got {came}"
        raise Refusal("invalid-request", detail=sentence, pointer="/coordinates")
    if request.kind == "matrices" and request.augment > 1:
        demand = "must be 1 for matrices, which cannot be turned or mirrored"
        raise invalid("augment", f"{demand}, got {request.augment}")
    if request.n > limits.cities:
        raise too_many_cities(request.kind, limits.cities, request.n)
    if request.kind == "matrices":
        for m, matrix in enumerate(request.matrices):
            check_costs(matrix, f"matrices/{m}", LARGEST)
