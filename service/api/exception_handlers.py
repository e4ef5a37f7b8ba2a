"""Whatever is raised on the way to a front, as the refusal that it is answered with."""

from http import HTTPStatus
from typing import Any

from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response

from service.coverage.survey import InvalidCoverage, TooManyPlaces
from service.errors import MOST_FAULTS, Fault, Refusal, bug
from service.instance import InvalidInstance
from service.jobs.engine import Busy, Closed, Cold
from service.jobs.store import Mismatch, Unavailable
from service.jobs.submission import Lost, Overdue, Stopped
from service.requests.validation import refused_by, shortened

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
    return refusal_of(error).document(request_id)


def refusal_of(error: Exception) -> Refusal:
    """What is answered for work that ended with this error."""
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
            return bug()


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


def _as_refusal(request: Request, error: Exception) -> Refusal:
    path = shortened(request.url.path)
    match error:
        case RequestValidationError():
            return refused_by(error.errors(), parameters=True)
        case HTTPException(status_code=404):
            return Refusal(404, "no-such-path", f"there is nothing at {path}; /docs says what is")
        case HTTPException(status_code=405):
            allowed, came = _allowed(request, error), shortened(request.method)
            sentence = f"{path} must be asked with {allowed}, got {came}"
            return Refusal(405, "method-not-allowed", sentence)
        case HTTPException():
            return Refusal(error.status_code, "refused", error.detail)
        case _:
            return refusal_of(error)


def _invalid_coverage(error: InvalidCoverage) -> Refusal:
    faults = [Fault(detail=f"{part} {demand}", pointer=f"/{part}") for part, demand in error.faults]
    more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
    sentence, shown = faults[0].detail + more, faults[:MOST_FAULTS]
    if isinstance(error, TooManyPlaces):
        limits = {"limit": error.limit, "actual": error.actual}
        return Refusal(413, "too-many-cities", sentence, errors=shown, **limits)
    return Refusal(422, "invalid-request", sentence, errors=shown)
