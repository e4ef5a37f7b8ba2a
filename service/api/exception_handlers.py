"""Exception handlers: every exception as the problem document that it is answered with."""

from http import HTTPStatus

from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response

from service.api.responses import problem_response
from service.errors import Refusal
from service.requests.validation import refused_by, shortened

HANDLED = (Refusal, HTTPException, RequestValidationError)


async def answer_refusal(request: Request, error: Exception) -> Response:
    """Answer an exception of one of the kinds HANDLED."""
    refusal = _as_refusal(request, error)
    response = problem_response(refusal, request.scope["request_id"])
    if isinstance(error, HTTPException):
        response.headers.update(error.headers or {})
        if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
            response.headers["Allow"] = _allowed(request, error)
    return response


def _as_refusal(request: Request, error: Exception) -> Refusal:
    path = shortened(request.url.path)
    match error:
        case Refusal():
            return error
        case RequestValidationError():
            return refused_by(error.errors(), parameters=True)
        case HTTPException(status_code=404):
            return Refusal("no-such-path", path=path)
        case HTTPException(status_code=405):
            allowed, came = _allowed(request, error), shortened(request.method)
            return Refusal("method-not-allowed", path=path, allowed=allowed, came=came)
        case HTTPException():
            refusal = Refusal("refused", detail=error.detail)
            refusal.status = error.status_code
            return refusal
        case _:
            return Refusal("internal-error")


def _allowed(request: Request, error: HTTPException) -> str:
    """All methods of this path; the framework names those of the first route to it alone."""
    documented = request.app.openapi()["paths"]
    methods = documented.get(getattr(request.scope.get("route"), "path", None))
    if methods is None:
        return (error.headers or {}).get("Allow", "")
    return ", ".join(sorted(method.upper() for method in methods))
