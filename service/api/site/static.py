"""Static files: the page at `/`, the HTTP reference at `/docs`, and the examples."""

from collections.abc import Awaitable, Callable
from pathlib import Path

from starlette.middleware import Middleware
from starlette.middleware.gzip import GZipMiddleware
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute, Route
from starlette.staticfiles import StaticFiles

_SERVICE = Path(__file__).parents[2]
_PAGE = _SERVICE / "page"
_REFERENCE = _SERVICE / "reference"
_EXAMPLES = _SERVICE / "examples"
_COMPRESSED = [Middleware(GZipMiddleware)]  # plain text, which anybody may read
REVALIDATE = {"Cache-Control": "no-cache"}  # a browser asks each time, and gets 304 if unchanged

_Endpoint = Callable[[Request], Awaitable[Response]]


def static_routes() -> list[BaseRoute]:
    """Return the routes of the page, the HTTP reference, and the files that they load."""
    return [
        Route("/", files(_PAGE), middleware=_COMPRESSED),
        Route("/docs", files(_REFERENCE), middleware=_COMPRESSED),
        Route("/page/{path:path}", files(_PAGE), middleware=_COMPRESSED),
        Route("/docs/{path:path}", files(_REFERENCE), middleware=_COMPRESSED),
        Route("/examples/{path}.json", files(_EXAMPLES, ".json"), middleware=_COMPRESSED),
    ]


def files(folder: Path, suffix: str = "") -> _Endpoint:
    """Return an endpoint that serves the file of a folder named by `path` and the suffix.

    Without `path` it serves `index.html`.
    """
    static = StaticFiles(directory=folder)

    async def answer(request: Request) -> Response:
        path = request.path_params.get("path", "index.html") + suffix
        response = await static.get_response(path, request.scope)
        response.headers.update(REVALIDATE)
        return response

    return answer
