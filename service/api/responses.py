"""Answers and problem documents: their schemas for OpenAPI, and how they become responses.

The schemas only document the answers: a front is written as JSON once, by the worker that found
it.
"""

import asyncio
import gzip
from collections.abc import Mapping
from dataclasses import replace
from http import HTTPStatus
from typing import Annotated, Any

from pydantic import BaseModel, Field
from pydantic_core import to_json
from starlette.requests import Request
from starlette.responses import Response

from service.api.problem import Problem
from service.api.request_headers import accepts_gzip
from service.errors import Refusal
from service.front import Termination
from service.jobs.record import Record, Status
from service.objectives import MOST_OBJECTIVES, OBJECTIVES
from service.requests.fields import Maybe, empty_list, optional
from service.requests.stop_fields import NamedStop
from service.requests.task import KindName

PROBLEM_JSON = "application/problem+json"
LEAST_COMPRESSED = 2**16  # bytes; shorter answers are sent as they are
_GZIP_LEVEL = 1  # 6 MB of tours in a tenth of a second, to two fifths; 6 takes four times as long
Lengths = Annotated[list[float], Field(min_length=OBJECTIVES, max_length=MOST_OBJECTIVES)]
OF_TWO = "of two objectives: 0 at the front's least first length, 1 at its least second"
OF_MORE = (
    "of more objectives: each length in the front's own box, 0 at its least and 1 at its greatest"
)
Balance = Annotated[
    float, Field(description="0 at the front's least first length, 1 at its least second")
]


class TourItem(BaseModel):
    """A tour and where it stands."""

    angle: Maybe[float] = optional("of two objectives: direction of the scaled lengths, in degrees")
    balance: Maybe[float] = optional(OF_TWO)
    losses: Maybe[Lengths] = optional(OF_MORE)
    kept: Maybe[float] = optional(
        "only in a front that was replanned: the share of the driven tour's remaining legs that"
        " this tour keeps, in either direction if costs are symmetric"
    )
    departure: Maybe[float] = optional(
        "where costs change over the day: when the tour begins, in seconds of the day"
    )
    lengths: Lengths
    means: Maybe[Lengths] = optional(
        "where costs spread: the mean lengths; those in `lengths` may be percentiles"
    )
    p90: Maybe[Lengths] = optional(
        "where costs spread: the lengths that nine days of ten do not exceed"
    )
    tour: list[int]
    arrivals: Maybe[list[Lengths]] = optional(
        "only if `arrivals` is true: all lengths up to each stop, and up to the return of a closed"
        " tour"
    )
    times: Maybe[list[float]] = optional(
        "where costs change over the day: when it reaches each stop, in seconds of the day, and"
        " when it ends"
    )
    stops: Maybe[list[str]] = optional("the ids of its stops, if the request has ids")


class TourAnswer(TourItem):
    """A tour of a front."""

    front: str = Field(description="the front's id")


class ActorName(BaseModel):
    """The network that built a front."""

    name: str
    digest: str = Field(description="SHA-256 of its file, or of its package's name and version")


class ObjectiveName(BaseModel):
    """An objective of a front."""

    name: str
    unit: str | None


class RequestNote(BaseModel):
    """A note on a request that was planned: something in it is likely to be a mistake."""

    code: str = Field(
        description="tells notes apart: place, swapped, far, outlier, large-costs or prizes"
    )
    text: str
    pointer: Maybe[str] = optional("JSON pointer to the part of the request that it is about")


class FrontAnswer(BaseModel):
    """A front of tours, by ascending first length."""

    id: str
    status: Status
    problem: Maybe[Problem] = optional("why it failed")
    kind: KindName = Field(description="front, coverage, fleet or robots: what was planned")
    cities: int
    front: list[TourItem]
    points: int = Field(description="nondominated points found; front holds at most `size`")
    hypervolume: float = Field(description="of the front returned, 0 to 1")
    hypervolume_bound: float | None = Field(
        description="an upper bound for every front of this instance, if `bound` is true"
    )
    reference_point: Lengths | None = Field(
        description="null, like the scale, until the costs are measured"
    )
    scale: Lengths | None
    actor: ActorName | None = Field(description="null where no network built tours, or none yet")
    timings_ms: dict[str, float]
    terminated: Termination | None = Field(
        description="how the search ended, null while it goes on. `converged`: up to eleven cities"
        " all tours were compared, and the front is exact; beyond, the search has long found"
        " nothing better in its neighbourhoods, which proves nothing. Where `time_limit` is 0 there"
        " was no search, and it says that all tours asked for were built"
    )
    closed: Maybe[bool] = optional("false where tours are open routes, left out where closed")
    objectives: Maybe[list[ObjectiveName]] = optional("as the request names them")
    stops: Maybe[list[NamedStop]] = optional("as the request has them")
    notes: Maybe[list[RequestNote]] = optional(
        "what is likely to be a mistake in the request, if anything is"
    )


class ListedFrontItem(BaseModel):
    """A front in a list."""

    id: str
    status: Status
    kind: KindName
    stored_at: str = Field(
        description="when it was submitted or, once it is finished, when it was finished (RFC 3339)"
    )
    cities: int = Field(description="its cities, stops or places")
    points: int
    hypervolume: float
    objectives: Maybe[list[ObjectiveName]] = optional("as the request names them")


class FrontsAnswer(BaseModel):
    """A page of the caller's fronts, the newest first; `Link` leads to the next page."""

    fronts: list[ListedFrontItem]


class AcceptedAnswer(BaseModel):
    """The id and the status of a front that was submitted."""

    id: str
    status: Status


class PathItem(BaseModel):
    """A way over the map, through all places in the order of a tour."""

    cells: list[list[int]] = Field(
        description="row and column of each; a closed tour ends with its first cell"
    )
    metres: float
    points: Maybe[list[list[float]]] = optional(
        "x and y of each cell's middle in the frame of the map, in metres, if its origin is known"
    )
    yaws: Maybe[list[float]] = optional(
        "with points: the direction in radians in which the robot leaves each cell, and at the last"
        " cell the one in which it arrives"
    )
    visits: list[list[int]] = empty_list(
        "for each place of the tour in order, back to the first if it is closed: the index of its"
        " cell in cells, and the place; all other cells are on the way"
    )


class UncoveredRegionItem(BaseModel):
    """A region of free cells that no path leads to."""

    cells: int
    cell: list[int] = Field(description="row and column of a cell in it")
    box: list[list[int]] = Field(
        description="row and column of the first and of the last cell of its bounding box"
    )


class UncoveredItem(BaseModel):
    """The free cells that no path leads to, as a room that is closed off."""

    cells: int
    square_metres: float
    regions: list[UncoveredRegionItem] = Field(
        description="the largest, at most 20, the largest first"
    )


class CoverageItem(TourItem):
    """A tour through places on a map."""

    path: Maybe[PathItem] = optional("if `paths` is true")


class MapAnswer(FrontAnswer):
    """A front of anything on a map."""

    places: list[list[int]] = Field(description="row and column of each")
    uncovered: Maybe[UncoveredItem] = optional(
        "the free cells that no path leads to, once the map is surveyed"
    )


class CoverageAnswer(MapAnswer):
    """A front of tours through places on a map, by ascending length."""

    front: list[CoverageItem]  # type: ignore[assignment]  # a list for reading only


class ActorItem(ActorName):
    """A network, as its file describes it."""

    inputs: str = Field(description="the kind of instance that it reads")
    commit: str
    sizes: Any = Field(description="numbers of cities that it was trained on")
    angles: Any = Field(description="angles that it was trained on")
    config: Any
    figures: Any = Field(description="what was measured of it")
    repairs: bool = Field(description="whether it can repair its tours")
    most_objectives: int = Field(description="the most objectives that it takes")


class ActorsAnswer(BaseModel):
    """The networks to choose from."""

    actors: list[ActorItem]


class CompilingAnswer(BaseModel):
    """The progress of compiling code. Some requests need this code, and wait for it."""

    share: float = Field(description="what is done, 0 to 1")
    seconds_left: float = Field(description="about how long the rest takes")


class HealthAnswer(BaseModel):
    """The state of the service."""

    status: str
    compiling: CompilingAnswer | None = None


def json_response(answer: Any, status: int = 200) -> Response:
    """Return an answer as a response; it is not checked against its schema."""
    return json_bytes(to_json(answer), status)


def json_bytes(answer: bytes, status: int = 200) -> Response:
    """Return an answer that is already JSON as a response."""
    return Response(answer, status, media_type="application/json")


async def compressed(request: Request, response: Response) -> Response:
    """Return a response, compressed if it is long and the request accepts gzip."""
    if len(response.body) < LEAST_COMPRESSED:
        return response
    response.headers.add_vary_header("Accept-Encoding")
    if accepts_gzip(request):
        body = bytes(response.body)
        response.body = await asyncio.to_thread(gzip.compress, body, _GZIP_LEVEL, mtime=0)
        response.headers["Content-Encoding"] = "gzip"
        response.headers["Content-Length"] = str(len(response.body))
    return response


def root_path_of(scope: Mapping[str, Any]) -> str:
    """Return the path under which the client sees the service, such as /tours; mostly empty."""
    return str(scope.get("root_path", ""))


def problem_under(root_path: str, document: Mapping[str, Any]) -> dict[str, Any]:
    """Return a problem document whose `type` is a path as the client sees it."""
    # Those that earlier releases stored have about:blank.
    prefix = root_path if document["type"].startswith("/") else ""
    return {**document, "type": prefix + document["type"]}


def record_under(root_path: str, record: Record) -> Record:
    """Return a record whose problem document, if it has one, is as the client sees it."""
    if record.problem is None:
        return record
    return replace(record, problem=problem_under(root_path, record.problem))


def problem_response(refusal: Refusal, scope: Mapping[str, Any]) -> Response:
    """Return the problem document of a refusal as the response to the request with this scope."""
    document = problem_under(root_path_of(scope), refusal.document(scope["request_id"]))
    return problem_bytes(document, refusal.headers)


def problem_bytes(
    document: Mapping[str, Any], headers: Mapping[str, str] | None = None
) -> Response:
    """Return a problem document as a response; a 503 asks the client to retry in a second."""
    status: int = document["status"]
    retry = {"Retry-After": "1"} if status == HTTPStatus.SERVICE_UNAVAILABLE else {}
    return Response(to_json(document), status, {**retry, **(headers or {})}, PROBLEM_JSON)


def problem_responses(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return the entries of an operation's refusals in the OpenAPI document."""
    schema = {"$ref": "#/components/schemas/Problem"}
    return {
        status: {
            "description": HTTPStatus(status).phrase,
            "content": {PROBLEM_JSON: {"schema": schema}},
        }
        for status in statuses
    }
