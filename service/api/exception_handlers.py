"""Exception handlers: turn refusals and errors of the framework into problem documents."""

from http import HTTPStatus

from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response

from service.api.responses import problem_response, root_path_of
from service.errors import Refusal
from service.errors.faults import shorten
from service.requests.validation import refusal_of

HANDLED = (Refusal, HTTPException, RequestValidationError)


async def answer_refusal(request: Request, error: Exception) -> Response:
    """Return the response to an exception of one of the kinds HANDLED."""
    refusal = _refusal(request, error)
    response = problem_response(refusal, request.scope)
    if isinstance(error, HTTPException):
        response.headers.update(error.headers or {})
        if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
            response.headers["Allow"] = _allowed_methods(request, error)
    return response


def _refusal(request: Request, error: Exception) -> Refusal:
    path = shorten(request.url.path)
    match error:
        case Refusal():
            return error
        case RequestValidationError():
            return refusal_of(error.errors(), parameters=True)
        case HTTPException(status_code=404):
            docs = f"{root_path_of(request.scope)}/docs"
            return Refusal("no-such-path", path=path, docs=docs)
        case HTTPException(status_code=405):
            allowed, came = _allowed_methods(request, error), shorten(request.method)
            return Refusal("method-not-allowed", path=path, allowed=allowed, came=came)
        case HTTPException():
            refusal = Refusal("refused", detail=error.detail)
            refusal.status = error.status_code
            return refusal
        case _:
            return Refusal("internal-error")


def _allowed_methods(request: Request, error: HTTPException) -> str:
    """Return all methods of the path; the framework names only those of its first route."""
    documented = request.app.openapi()["paths"]
    methods = documented.get(getattr(request.scope.get("route"), "path", None))
    if methods is None:
        return (error.headers or {}).get("Allow", "")
    return ", ".join(sorted(method.upper() for method in methods))
