"""What people open in a browser: the page and the HTTP reference, as files."""

from collections.abc import Awaitable, Callable
from pathlib import Path

from starlette.requests import Request
from starlette.responses import FileResponse, Response
from starlette.routing import BaseRoute, Route
from starlette.staticfiles import StaticFiles

_HERE = Path(__file__).parents[1]
_PAGE = _HERE / "page"
_DOCS = _HERE / "reference"
_FRESH = {"Cache-Control": "no-cache"}  # asked for anew each time, answered by 304 where unchanged

_Endpoint = Callable[[Request], Awaitable[Response]]


def page_routes() -> list[BaseRoute]:
    """The page at `/`, the HTTP reference at `/docs`, and what they load."""
    return [
        Route("/", _index(_PAGE)),
        Route("/docs", _index(_DOCS)),
        Route("/page/{path:path}", _files(_PAGE)),
        Route("/docs/{path:path}", _files(_DOCS)),
        Route("/examples/{path}.json", _files(_HERE / "examples", ".json")),
    ]


def _index(folder: Path) -> _Endpoint:
    async def answer(_: Request) -> Response:
        return FileResponse(folder / "index.html", headers=_FRESH)

    return answer


def _files(folder: Path, suffix: str = "") -> _Endpoint:
    files = StaticFiles(directory=folder)

    async def answer(request: Request) -> Response:
        response = await files.get_response(request.path_params["path"] + suffix, request.scope)
        response.headers.update(_FRESH)
        return response

    return answer
