"""What travels over HTTP, and every limit on it."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationError,
)
from pydantic.json_schema import SkipJsonSchema

from service.instance import Instance
from service.planner import Demand, Termination
from service.preferences import fan
from service.problems import Fault, Refusal, refused_by

# Between these, lengths and hypervolumes neither overflow nor vanish.
_LARGEST = 1e150
_SMALLEST = 1e-150


def _whole(given: object) -> object:
    # JSON has one kind of number, and its schemas call 3.0 an integer.
    return int(given) if isinstance(given, float) and given.is_integer() else given


Coordinate = Annotated[float, Field(ge=-_LARGEST, le=_LARGEST, allow_inf_nan=False)]
Row = Annotated[list[Coordinate], Field(min_length=4, max_length=4, fail_fast=True)]
Angle = Annotated[float, Field(ge=0, le=90, allow_inf_nan=False)]
Positive = Annotated[float, Field(ge=_SMALLEST, le=_LARGEST, allow_inf_nan=False)]
# The validator comes last: before it, the bounds would be lost to the OpenAPI document.
Count = Annotated[int, Field(ge=1, le=2**31 - 1), BeforeValidator(_whole)]
Whole = Annotated[int, Field(ge=0, le=2**31 - 1), BeforeValidator(_whole)]


@dataclass(frozen=True, kw_only=True)
class Limits:
    """The most that a request may bring or ask for."""

    body_bytes: int
    cities: int
    preferences: int
    size: int
    seconds: float


class FrontRequest(BaseModel):
    """Cities under two objectives, and what is asked of their front.

    An empty list can only be a default: none is given.
    """

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    coordinates: Annotated[list[Row], Field(min_length=1, fail_fast=True)] = Field(
        default_factory=list,
        description="a row for each city: x and y in plane 1, x and y in plane 2",
    )
    matrices: SkipJsonSchema[Any] = None
    preferences: Annotated[
        Annotated[Count, Tag("[count]")]
        | Annotated[list[Angle], Field(min_length=1, fail_fast=True), Tag("[angles]")],
        Discriminator(lambda given: "[angles]" if isinstance(given, list) else "[count]"),
    ] = Field(
        default=100, description="angles in degrees to look along, or how many, evenly spread"
    )
    time_limit: float = Field(
        default=1.0,
        ge=0,
        allow_inf_nan=False,
        description="seconds of improvement after the network; 0 asks for its tours alone",
    )
    size: Count = Field(default=100, description="the most tours to return")
    start: Whole = Field(default=0, description="the city that every tour is reported from")
    reference_point: list[Positive] = Field(
        default_factory=list,
        min_length=2,
        max_length=2,
        description="of the hypervolume; by default the number of cities times the scale",
    )
    initial_tours: Annotated[list[list[Whole]], Field(min_length=1, fail_fast=True)] = Field(
        default_factory=list, description="tours that the front shall dominate or equal"
    )
    bound: bool = Field(
        default=False,
        description="whether to prove, in up to 5 s, how large any front's hypervolume can be",
    )
    actor: str = Field(default="pa-one", description="the network that builds the tours")
    seed: Whole = Field(default=0, description="of everything random in the improvement")

    def instance(self) -> Instance:
        """The cities."""
        return Instance(coordinates=np.array(self.coordinates, dtype=np.float64))

    def demand(self) -> Demand:
        """What is asked of the front."""
        looked = self.preferences
        return Demand(
            angles=fan(looked) if isinstance(looked, int) else np.array(looked),
            size=self.size,
            start=self.start,
            reference_point=np.array(self.reference_point) if self.reference_point else None,
            time_limit=self.time_limit,
            initial_tours=np.array(self.initial_tours) if self.initial_tours else None,
            bound=self.bound,
            seed=self.seed,
        )


class TourQuery(BaseModel):
    """Which tour of which front."""

    model_config = ConfigDict(extra="forbid")

    angle: Angle = Field(description="the trade-off wanted, in degrees")
    front: str | SkipJsonSchema[None] = Field(
        default=None, description="the front's id; by default the latest"
    )


class TourItem(BaseModel):
    """A tour and where it stands."""

    angle: float = Field(description="direction of the scaled lengths, in degrees")
    lengths: Annotated[list[float], Field(min_length=2, max_length=2)]
    tour: list[int]


class TourAnswer(TourItem):
    """A tour of a front."""

    front: str = Field(description="the front's id")


class ActorName(BaseModel):
    """The network that built a front."""

    name: str
    digest: str = Field(description="SHA-256 of its file")


class FrontAnswer(BaseModel):
    """A front of tours, by ascending first length."""

    id: str
    cities: int
    front: list[TourItem]
    points: int = Field(description="nondominated points found; front holds at most `size`")
    hypervolume: float = Field(description="of the front returned, 0 to 1")
    hypervolume_bound: float | None = Field(
        description="what no front of this instance exceeds, where `bound` asked for it"
    )
    reference_point: Annotated[list[float], Field(min_length=2, max_length=2)]
    scale: Annotated[list[float], Field(min_length=2, max_length=2)]
    actor: ActorName
    timings_ms: dict[str, float]
    terminated: Termination


class ActorItem(ActorName):
    """A network and what its file says of it."""

    inputs: str = Field(description="the kind of instance that it reads")
    commit: str
    sizes: Any = Field(description="numbers of cities that it was trained on")
    angles: Any = Field(description="angles that it was trained on")
    config: Any
    figures: Any = Field(description="what was measured of it")


class ActorsAnswer(BaseModel):
    """The networks to choose from."""

    actors: list[ActorItem]


class HealthAnswer(BaseModel):
    """How the service is."""

    status: str


def request_schema(limits: Limits, actors: Iterable[str]) -> dict[str, Any]:
    """The JSON schema of a front request where these limits hold and these actors are loaded."""
    schema = FrontRequest.model_json_schema()
    fields = schema["properties"]
    schema["required"] = ["coordinates"]
    fields["coordinates"]["maxItems"] = limits.cities
    count, angles = fields["preferences"]["oneOf"]
    count["maximum"] = angles["maxItems"] = limits.preferences
    fields["size"]["maximum"] = limits.size
    for name, default in _defaults_within(limits).items():
        fields[name]["default"] = default
    fields["start"]["maximum"] = limits.cities - 1
    fields["actor"]["enum"] = sorted(actors)
    fields["time_limit"]["maximum"] = limits.seconds
    fields["initial_tours"]["maxItems"] = limits.size
    return schema


def parse_front_request(body: bytes, limits: Limits) -> FrontRequest:
    """The request in a body.

    Raises:
        Refusal: it is not JSON, not a front request, over a limit, or asks for what there is not.
    """
    try:
        request = FrontRequest.model_validate_json(body)
    except ValidationError as error:
        errors = error.errors(include_url=False)
        if errors[0]["type"] == "json_invalid":
            reason = errors[0]["ctx"]["error"]
            raise Refusal(400, "malformed-json", f"the body must be JSON: {reason}") from None
        raise refused_by(errors) from None
    _check_available(request)
    _check_limits(request, limits)
    defaults = _defaults_within(limits).items()
    given = request.model_fields_set
    return request.model_copy(update={name: v for name, v in defaults if name not in given})


def _defaults_within(limits: Limits) -> dict[str, float]:
    """The defaults that a limit may lower: who asks for nothing is never over a limit."""
    most = {
        "preferences": limits.preferences,
        "size": limits.size,
        "time_limit": limits.seconds,
    }
    fields = FrontRequest.model_fields
    return {name: min(fields[name].default, limit) for name, limit in most.items()}


def _check_available(request: FrontRequest) -> None:
    given = bool(request.coordinates)
    if given == (request.matrices is not None):
        came = "both" if given else "neither"
        raise _invalid("/coordinates", f"either coordinates or matrices are required, got {came}")
    if not given:
        raise _not_available("/matrices", "matrices cannot be planned yet: give coordinates")


def _check_limits(request: FrontRequest, limits: Limits) -> None:
    n = len(request.coordinates)
    if n > limits.cities:
        raise Refusal(
            413,
            "too-many-cities",
            f"coordinates must have at most {limits.cities} rows, got {n}",
            errors=[Fault(pointer="/coordinates", detail="too many rows")],
            limit=limits.cities,
            actual=n,
        )
    if request.start >= n:
        sentence = f"start must be a city, 0 to {n - 1}, got {request.start}"
        raise _invalid("/start", sentence)
    if "preferences" in request.model_fields_set:
        looked = request.preferences
        k = looked if isinstance(looked, int) else len(looked)
        _check_most("preferences", limits.preferences, k)
    if "size" in request.model_fields_set:
        _check_most("size", limits.size, request.size)
    if "time_limit" in request.model_fields_set:
        _check_most("time_limit", limits.seconds, request.time_limit)
    _check_most("initial_tours", limits.size, len(request.initial_tours))
    for index, tour in enumerate(request.initial_tours):
        if sorted(tour) != list(range(n)):
            sentence = f"initial_tours/{index} must visit each city, 0 to {n - 1}, once"
            raise _invalid(f"/initial_tours/{index}", sentence)


def _check_most(name: str, limit: float, actual: float) -> None:
    if actual > limit:
        fault = Fault(
            pointer=f"/{name}", detail=f"{name} must be at most {limit:g}, got {actual:g}"
        )
        raise Refusal(422, "over-limit", fault.detail, errors=[fault], limit=limit, actual=actual)


def _invalid(pointer: str, detail: str) -> Refusal:
    return Refusal(422, "invalid-request", detail, errors=[Fault(pointer=pointer, detail=detail)])


def _not_available(pointer: str, detail: str) -> Refusal:
    return Refusal(422, "not-available", detail, errors=[Fault(pointer=pointer, detail=detail)])
