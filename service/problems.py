"""Refusals, as problem documents (RFC 9457), and the identity that every request carries.

A refusal names the thing, the demand and what came; its code is stable, its sentence is not.
"""

import asyncio
import logging
import re
import uuid
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from http import HTTPStatus
from typing import Any

from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, Field
from pydantic_core import ErrorDetails, to_json
from starlette.datastructures import Headers, MutableHeaders
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.coverage import InvalidCoverage, TooManyPlaces
from service.engine import Busy, Closed, Cold
from service.instance import InvalidInstance
from service.order import Lost, Overdue, Stopped
from service.store import Mismatch, Unavailable

MEDIA_TYPE = "application/problem+json"
ANONYMOUS = "anonymous"
_SAFE_ID = re.compile(r"[A-Za-z0-9._-]{1,64}")
_MOST_FAULTS = 20
_BUG = "this is a fault of the service, not of the request"


class Fault(BaseModel):
    """One thing wrong with a request."""

    detail: str
    pointer: str | None = Field(default=None, description="JSON pointer into the body (RFC 6901)")
    parameter: str | None = Field(default=None, description="name of the query parameter")


class Problem(BaseModel):
    """Why a request was refused (RFC 9457)."""

    type: str = Field(description="always about:blank; the code tells problems apart")
    title: str
    status: int
    code: str = Field(description="stable; the one member to branch on")
    detail: str
    request_id: str
    errors: list[Fault] | None = None
    limit: float | None = Field(default=None, description="the most that is allowed")
    actual: float | None = Field(default=None, description="what came, where it is known")


class Refusal(Exception):
    """A request that will not be served; everything its problem document says."""

    def __init__(
        self,
        status: int,
        code: str,
        detail: str,
        *,
        errors: Sequence[Fault] = (),
        limit: float | None = None,
        actual: float | None = None,
    ) -> None:
        super().__init__(detail)
        self._made = partial(
            Refusal, status, code, detail, errors=errors, limit=limit, actual=actual
        )
        self.status = status
        self.headers = {"Retry-After": "1"} if status == HTTPStatus.SERVICE_UNAVAILABLE else {}
        self.members: dict[str, Any] = {
            "type": "about:blank",
            "title": HTTPStatus(status).phrase,
            "status": status,
            "code": code,
            "detail": detail,
            "errors": [fault.model_dump(exclude_none=True) for fault in errors] or None,
            "limit": limit,
            "actual": actual,
        }

    def __reduce__(self) -> tuple[Callable[[], "Refusal"], tuple[()]]:
        """How it travels from one process to another."""
        return self._made, ()

    def document(self, request_id: str) -> dict[str, Any]:
        """The problem document."""
        members = {name: value for name, value in self.members.items() if value is not None}
        return {**members, "request_id": request_id}

    def response(self, request_id: str) -> Response:
        """The answer."""
        document = to_json(self.document(request_id))
        return Response(document, self.status, headers=self.headers, media_type=MEDIA_TYPE)


def refused_by(errors: Sequence[ErrorDetails], parameters: bool = False) -> Refusal:
    """What pydantic found wrong with a body, or with query parameters, as one refusal."""
    faults = [_fault(error, parameters) for error in errors[:_MOST_FAULTS]]
    more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
    return Refusal(422, "invalid-request", faults[0].detail + more, errors=faults)


def responses(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """What the OpenAPI document says of a path's refusals."""
    schema = {"$ref": "#/components/schemas/Problem"}
    return {
        status: {
            "description": HTTPStatus(status).phrase,
            "content": {MEDIA_TYPE: {"schema": schema}},
        }
        for status in statuses
    }


async def answer_refusal(request: Request, error: Exception) -> Response:
    """The exception handler for everything that may be the caller's fault."""
    response = _as_refusal(request, error).response(request.scope["request_id"])
    if isinstance(error, HTTPException):
        response.headers.update(error.headers or {})
        if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
            response.headers["Allow"] = _allowed(request, error)
    return response


def _allowed(request: Request, error: HTTPException) -> str:
    """All methods of this path; the framework names those of the first route to it alone."""
    documented = request.app.openapi()["paths"]
    methods = documented.get(getattr(request.scope.get("route"), "path", None))
    if methods is None:
        return (error.headers or {}).get("Allow", "")
    return ", ".join(sorted(method.upper() for method in methods))


_SENTENCES: dict[type[Exception], tuple[int, str, str]] = {
    Busy: (503, "queue-full", "the queue must have a free place, and all are taken: ask again"),
    Closed: (503, "shutting-down", "the server is shutting down"),
    Lost: (503, "worker-lost", "the work must leave its worker alive, and two were lost over it"),
    Stopped: (503, "stopped", "the work was stopped before there was a front"),
    Mismatch: (422, "idempotency-mismatch", "an Idempotency-Key must be of one body, got another"),
    Unavailable: (503, "store-unavailable", "what fronts are kept in must answer, and does not"),
    Overdue: (504, "overdue", "the work must end in time, and there was no front yet"),
    Cold: (
        503,
        "warming-up",
        "the search is being compiled, once: ask again, or for the network alone with time_limit 0",
    ),
}
REFUSALS = (Refusal, HTTPException, RequestValidationError, InvalidInstance, *_SENTENCES)


def problem_of(error: Exception, request_id: str) -> dict[str, Any]:
    """The problem document of work that failed."""
    return _of_work(error).document(request_id)


def _of_work(error: Exception) -> Refusal:
    match error:
        case Refusal():
            return error
        case InvalidCoverage():
            return _invalid_coverage(error)
        case InvalidInstance():
            return Refusal(422, "invalid-instance", str(error))
        case _ if type(error) in _SENTENCES:
            return Refusal(*_SENTENCES[type(error)])
        case _:
            return Refusal(500, "internal-error", _BUG)


class RequestIds:
    """Gives each request an identity and turns a bug into a problem document that carries it.

    Until it has shown a key, its caller is anonymous.
    The caller's own X-Request-ID is kept where it is short and plain enough to log.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._log = logging.getLogger("paretour")

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        given = Headers(scope=scope).get("x-request-id", "")
        request_id = given if _SAFE_ID.fullmatch(given) else uuid.uuid4().hex
        scope["request_id"] = request_id
        scope["caller"] = ANONYMOUS
        started = False

        async def send_with_id(message: Message) -> None:
            nonlocal started
            if message["type"] == "http.response.start":
                started = True
                MutableHeaders(scope=message)["X-Request-ID"] = request_id
            await send(message)

        try:
            await self._app(scope, receive, send_with_id)
        except asyncio.CancelledError:
            # Only a server that shuts down cancels; nobody else waits for this task.
            if not started:
                closed = Refusal(503, "shutting-down", "the server is shutting down")
                await closed.response(request_id)(scope, receive, send_with_id)
        except Exception:
            self._log.exception("request %s failed", request_id)
            if started:
                raise
            bug = Refusal(500, "internal-error", _BUG)
            await bug.response(request_id)(scope, receive, send_with_id)


def _as_refusal(request: Request, error: Exception) -> Refusal:
    path = _cut(request.url.path)
    match error:
        case RequestValidationError():
            return refused_by(error.errors(), parameters=True)
        case HTTPException(status_code=404):
            return Refusal(404, "no-such-path", f"there is nothing at {path}; /docs says what is")
        case HTTPException(status_code=405):
            allowed, came = _allowed(request, error), _cut(request.method)
            sentence = f"{path} must be asked with {allowed}, got {came}"
            return Refusal(405, "method-not-allowed", sentence)
        case HTTPException():
            return Refusal(error.status_code, "refused", error.detail)
        case InvalidCoverage():
            return _invalid_coverage(error)
        case _:
            return _of_work(error)


def _invalid_coverage(error: InvalidCoverage) -> Refusal:
    faults = [Fault(detail=f"{part} {demand}", pointer=f"/{part}") for part, demand in error.faults]
    more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
    sentence, shown = faults[0].detail + more, faults[:_MOST_FAULTS]
    if isinstance(error, TooManyPlaces):
        limits = {"limit": error.limit, "actual": error.actual}
        return Refusal(413, "too-many-cities", sentence, errors=shown, **limits)
    return Refusal(422, "invalid-request", sentence, errors=shown)


def _fault(error: ErrorDetails, parameters: bool) -> Fault:
    # FastAPI puts "query" first; brackets mark a branch of a union, which the caller never wrote.
    parts = [str(part) for part in error["loc"] if not str(part).startswith("[")]
    if parameters:
        name = _cut(".".join(parts[1:]))
        return Fault(detail=f"{name} {_demand(error)}", parameter=name)
    pointer = _cut("".join("/" + part.replace("~", "~0").replace("/", "~1") for part in parts))
    return Fault(detail=f"{pointer.lstrip('/') or 'the body'} {_demand(error)}", pointer=pointer)


def _demand(error: ErrorDetails) -> str:
    bounds: Mapping[str, Any] = error.get("ctx", {})
    match error["type"]:
        case "missing":
            return "is required"
        case "extra_forbidden":
            return "is not a field that this request has"
        case "too_short":
            return f"must have {bounds['min_length']} items or more, got {len(error['input'])}"
        case "too_long":
            return f"must have {bounds['max_length']} items or fewer, got {len(error['input'])}"
        case "greater_than_equal":
            return f"must be at least {bounds['ge']:.16g}, got {_shown(error['input'])}"
        case "less_than_equal":
            return f"must be at most {bounds['le']:.16g}, got {_shown(error['input'])}"
    demand = re.sub(r"^Input should be", "must be", error["msg"])
    return f"{demand}, got {_shown(error['input'])}"


def _shown(value: object) -> str:
    match value:
        case list():
            return f"a list of {len(value)}"
        case dict():
            return "an object"
        case int() if abs(value) >= 10**40:
            return "an integer of more than 40 digits"
        case _:
            return _cut(to_json(value, inf_nan_mode="constants").decode())


def _cut(text: str) -> str:
    return text if len(text) <= 80 else f"{text[:79]}…"
