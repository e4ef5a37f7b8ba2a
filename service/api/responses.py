"""What is answered over HTTP."""

from typing import Annotated, Any

from pydantic import BaseModel, Field
from pydantic.json_schema import SkipJsonSchema

from service.errors import Problem
from service.jobs.record import Status
from service.planner import Termination


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
    status: Status
    problem: Problem | SkipJsonSchema[None] = Field(default=None, description="why it failed")
    cities: int
    front: list[TourItem]
    points: int = Field(description="nondominated points found; front holds at most `size`")
    hypervolume: float = Field(description="of the front returned, 0 to 1")
    hypervolume_bound: float | None = Field(
        description="what no front of this instance exceeds, where `bound` asked for it"
    )
    reference_point: Annotated[list[float], Field(min_length=2, max_length=2)] | None = Field(
        description="null while the places on a map are looked for, as is the scale"
    )
    scale: Annotated[list[float], Field(min_length=2, max_length=2)] | None
    actor: ActorName
    timings_ms: dict[str, float]
    terminated: Termination | None = Field(description="null while the planning goes on")


class AcceptedAnswer(BaseModel):
    """Where a front will be found."""

    id: str
    status: Status


class PathItem(BaseModel):
    """A closed way over the map, through all places in the order of a tour."""

    cells: list[list[int]] = Field(description="row and column of each, the first also last")
    metres: float


class CoverageItem(TourItem):
    """A tour through places on a map."""

    path: PathItem | SkipJsonSchema[None] = Field(default=None, description="if `paths` asked")


class CoverageAnswer(FrontAnswer):
    """A front of tours through places on a map, by ascending length."""

    front: list[CoverageItem]  # type: ignore[assignment]  # a list for reading only
    places: list[list[int]] = Field(description="row and column of each")


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
