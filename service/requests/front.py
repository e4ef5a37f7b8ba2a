"""Requests of `POST /front`: their fields, and their parser."""

from functools import cached_property
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from service.errors import Fault, Refusal, invalid
from service.instance import PLANE, Kind
from service.objectives import MOST_OBJECTIVES, OBJECTIVES
from service.reliability.spread import Spread
from service.requests.arrays import array_field, check_costs, stack_matrices
from service.requests.day_fields import DayFields, DayObjectiveItem, StopItem, read_hours
from service.requests.fields import (
    AT_END,
    AT_START,
    END,
    GEOMETRY,
    NO_WAY,
    START,
    AsInteger,
    CostRows,
    Geometry,
    Items,
    Number,
    Offered,
    OneEach,
    PlanRequest,
    SomeItems,
    empty_list,
    one_of,
    optional,
)
from service.requests.limits import Limits, check_breakpoints, check_router, tours_within_limits
from service.requests.npy import read_npy
from service.requests.spread_fields import read_spreads
from service.requests.stop_fields import (
    StopReference,
    find_index,
    read_objectives,
    read_sources,
    read_stops,
)
from service.requests.stops import (
    Hours,
    Labels,
    Matrix,
    Plane,
    Source,
    Stops,
    kind_of,
    locations_of,
)
from service.requests.validation import parse_json, too_many_cities

_LEAST_COLUMNS, _MOST_COLUMNS = PLANE * OBJECTIVES, PLANE * MOST_OBJECTIVES
_MOST_SYMMETRIES = 8  # the most that earlier versions allowed
FORMS = ("coordinates", "matrices", "stops")  # of a request, each named by its member
_REFERENCES = {"start", "end", "initial_tours"}  # the fields that may name stops by their ids
City = Annotated[
    list[Number], Field(min_length=_LEAST_COLUMNS, max_length=_MOST_COLUMNS, fail_fast=True)
]
_MatrixRows = OneEach[CostRows]
Matrices = Annotated[NDArray[np.float64], array_field(stack_matrices, _MatrixRows)]


class FrontRequest(DayFields, PlanRequest):
    """Cities or stops under two to four objectives, and the options of their front.

    It has exactly one of coordinates, matrices, and stops with objectives.
    """

    model_config = one_of(
        "coordinates",
        "matrices",
        "stops+objectives",
        stops={"required": ["objectives"]},
        objectives={"required": ["stops"]},
        departure={"required": ["stops"]},
        clock={"required": ["stops"]},
    )

    # A request is complete only after `parse_front_request` has checked it.
    # An empty default means that the field was not given: no caller can give an empty array.
    coordinates: SomeItems[City] = empty_list(
        "a row for each city: for each objective x and y in its plane"
    )
    matrices: Matrices = Field(
        default_factory=lambda: np.empty((OBJECTIVES, 0, 0)),
        description="instead of coordinates, for each objective the costs from each city (row) to"
        f" each (column), {NO_WAY}",
    )
    stops: SomeItems[StopItem] = empty_list("the cities, by ids that come back with every tour")
    objectives: OneEach[DayObjectiveItem] = empty_list(
        "two to four, each with the costs between the stops"
    )
    # In a checked request these hold only indexes, as in every PlanRequest.
    start: Annotated[StopReference | None, AT_START] = Field(  # type: ignore[assignment]
        default=0, description=f"{START}; by index or id"
    )
    end: Annotated[StopReference | None, AT_END] = optional(  # type: ignore[assignment]
        f"{END}; by index or id"
    )
    initial_tours: SomeItems[Items[StopReference]] = empty_list(  # type: ignore[assignment]
        "tours that the front must dominate or equal, by indexes or ids"
    )
    augment: Annotated[int, Field(ge=1, le=_MOST_SYMMETRIES), AsInteger, Offered(option="")] = (
        Field(
            default=1,
            description="without effect; repairs find better tours in less time",
            json_schema_extra={"deprecated": True},
        )
    )
    geometry: Geometry = Field(default="straight", description=GEOMETRY)

    @property
    def kind(self) -> Kind:
        """The kind of instance that an actor has to read."""
        if self.departure is not None or self.spreads:
            return "matrices"
        if self.stops:
            return kind_of(self.sources)
        return "coordinates" if self.coordinates else "matrices"

    @property
    def n(self) -> int:
        """The number of cities."""
        return len(self.stops) or len(self.coordinates) or self.matrices.shape[1]

    @property
    def objective_count(self) -> int:
        """The number of objectives."""
        if self.stops:
            return len(self.objectives)
        return len(self.coordinates[0]) // PLANE if self.coordinates else len(self.matrices)

    @cached_property
    def labels(self) -> Labels | None:
        """The names of stops and objectives; None if they have none."""
        if not self.stops:
            return None
        return Labels(read_stops(self.stops), read_objectives(self.objectives))

    @cached_property
    def sources(self) -> tuple[Source, ...]:
        """The source of the costs of each objective."""
        if not self.matrices.size and self.labels is not None:
            return tuple(read_sources(self.objectives, self.labels.stops))
        if self.coordinates:
            cities = np.array(self.coordinates, np.float64)
            starts = range(0, cities.shape[1], PLANE)
            return tuple(Plane(cities[:, m : m + PLANE]) for m in starts)
        for m, item in enumerate(self.objectives):
            if item.sources:
                given = " and ".join(item.sources)
                raise invalid(f"objectives/{m}", "source-beside-matrices", given=given)
        matrices = [Matrix(matrix) for matrix in self.matrices]
        if not self.objectives:
            return tuple(matrices)
        # Not strict: _check_objectives() refuses another number of matrices.
        each = zip(self.objectives, matrices, strict=False)
        return tuple(item.factored(f"objectives/{m}", base) for m, (item, base) in enumerate(each))

    @cached_property
    def hours(self) -> Hours | None:
        """The times at which tours may begin, if costs change over the day."""
        for name in ("departure", "clock"):
            if name in self.model_fields_set and not self.stops:
                raise invalid(name, "needs-stops")
        objectives = () if self.labels is None else self.labels.objectives
        hours = read_hours(self, self.stops, self.objectives, objectives)
        if hours is not None and self.bound:
            raise invalid("bound", "bound-of-the-day")
        return hours

    @cached_property
    def spreads(self) -> tuple[Spread | None, ...]:
        """How the costs of each objective spread; empty if none do."""
        timed = self.departure is not None
        return read_spreads(self.objectives, self.n, timed=timed, bound=self.bound)

    @property
    def subject(self) -> Stops:
        """The stops of a checked request, in which the ends of tours are indexes."""
        stops = () if self.labels is None else self.labels.stops
        locations = locations_of(stops) if stops else np.full((self.n, 2), np.nan)
        return Stops(locations, self.sources, self.ends, self.hours, self.spreads)


def parse_front_request(body: bytes, limits: Limits, npy: bytes | None = None) -> FrontRequest:
    """Return the request in a JSON body, with the matrices of a .npy file where one came with it.

    Raises:
        Refusal: The body is not JSON, misses the schema or is over a limit.
    """
    request = parse_json(FrontRequest, body)
    _check_form(request, npy is not None)
    if npy is not None:
        request = request.model_copy(
            update={"matrices": read_npy(npy, limits.most_cities("matrices"))}
        )
    _check_cities(request, limits)
    _check_objectives(request)
    request = _by_index(request)
    id_bytes = 0 if request.labels is None else request.labels.id_bytes
    return tours_within_limits(request, request.n, limits, id_bytes)


def _check_form(request: FrontRequest, with_file: bool) -> None:
    """Raise a refusal unless the cities come in one form; stops may have matrices in a file."""
    given = request.model_fields_set
    if with_file and "matrices" in given:
        raise invalid("matrices", "matrices-twice")
    forms = [form for form in FORMS if form in given]
    if with_file and "stops" not in forms:
        forms.append("matrices")
    if len(forms) != 1:
        known = f"{', '.join(FORMS[:-1])} and {FORMS[-1]}"
        values = {"forms": known, "given": " and ".join(forms) or "none"}
        fault = Fault("one-form", pointer=f"/{(forms or FORMS)[0]}", values=values)
        raise Refusal("invalid-request", errors=[fault])
    if ("stops" in given) != ("objectives" in given):
        missing, there = ("objectives", "stops") if "stops" in given else ("stops", "objectives")
        raise invalid(missing, "with-the-other", member=there)


def _check_cities(request: FrontRequest, limits: Limits) -> None:
    form = "stops" if request.stops else request.kind
    # The larger limit first: the kind of stops is known only after their costs are read.
    if request.n > limits.cities:
        raise too_many_cities(form, limits.cities, request.n)
    most = limits.most_cities("matrices")
    if request.n > most and request.kind == "matrices":
        code = "too-many-unless-planes" if request.stops else "too-many-rows"
        raise too_many_cities(form, most, request.n, code)
    if request.matrices.size:
        _check_matrices(request)
    if request.stops:
        check_breakpoints(request.sources, limits)
        check_router(request.sources, limits)


def _check_matrices(request: FrontRequest) -> None:
    rows = request.matrices.shape[1]
    if request.stops and rows != request.n:
        raise invalid("matrices", "row-each", stops=request.n, came=rows)
    for m, matrix in enumerate(request.matrices):
        check_costs(matrix, f"matrices/{m}")


def _check_objectives(request: FrontRequest) -> None:
    """Raise a refusal where parts are for different numbers of objectives."""
    m = request.objective_count
    for index, row in enumerate(request.coordinates):
        if len(row) != PLANE * m or len(row) % PLANE:
            part, came = f"coordinates/{index}", len(row)
            if index == 0:
                raise invalid(part, "plane-each", came=came)
            first = "/coordinates/0"
            raise invalid(part, "other-planes", numbers=PLANE * m, other=first, came=came)
    if request.stops and request.matrices.size and len(request.matrices) != m:
        raise invalid("matrices", "matrix-each", objectives=m, came=len(request.matrices))


def _by_index(request: FrontRequest) -> FrontRequest:
    """Return the request with the index of a stop in place of every id."""
    if not request.model_fields_set & _REFERENCES:
        return request
    stops = request.labels.stops if request.labels else ()
    ids = {stop.id: index for index, stop in enumerate(stops)}
    found: dict[str, Any] = {
        name: None if reference is None else find_index(reference, ids, name)
        for name, reference in (("start", request.start), ("end", request.end))
    }
    found["initial_tours"] = [
        [
            each if isinstance(each, int) else find_index(each, ids, f"initial_tours/{t}/{i}")
            for i, each in enumerate(tour)
        ]
        for t, tour in enumerate(request.initial_tours)
    ]
    given = request.model_fields_set
    return request.model_copy(update={name: found[name] for name in found if name in given})
