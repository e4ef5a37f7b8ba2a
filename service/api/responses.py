"""Make responses of answers and problem documents, and the schemas of the short ones."""

import asyncio
import gzip
from collections.abc import Mapping
from dataclasses import replace
from http import HTTPStatus
from typing import Any

from pydantic import BaseModel, Field
from pydantic_core import to_json
from starlette.requests import Request
from starlette.responses import Response

from service.api.request_headers import accepts_gzip
from service.errors import Refusal
from service.jobs.record import Record, Status

PROBLEM_JSON = "application/problem+json"
LEAST_COMPRESSED = 2**16  # bytes; shorter answers are sent as they are
_GZIP_LEVEL = 1  # 6 MB of tours in a tenth of a second, to two fifths; 6 takes four times as long


class AcceptedAnswer(BaseModel):
    """The id and the status of a front that was submitted."""

    id: str
    status: Status


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
