"""Static files: the page at `/`, the HTTP reference at `/docs`, and the examples.

The page is made of more than a hundred files. Their addresses contain its version, a digest of them
all, so that a browser asks for them once, and not again at each visit. Its own scripts are sent
without their comments, which are a fifth of their bytes, and with their line numbers.
"""

import json
import os
import re
from collections.abc import Awaitable, Callable
from functools import lru_cache
from hashlib import sha256
from pathlib import Path

import paretour
from starlette.middleware import Middleware
from starlette.middleware.gzip import GZipMiddleware
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import BaseRoute
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

from service.api.site.routes import NamedRoute

_SERVICE = Path(__file__).parents[2]
_PAGE = _SERVICE / "page"
_VENDORED = _PAGE / "vendor"
_MEMBERS = Path(paretour.__file__).with_name("members.json")
_FIELDS = '<script id="fields-of-requests" type="application/json">'  # where the inputs come
_REFERENCE = _SERVICE / "reference"
_EXAMPLES = _SERVICE / "examples"
_COMPRESSED = [Middleware(GZipMiddleware)]  # plain text, which anybody may read
REVALIDATE = {"Cache-Control": "no-cache"}  # a browser asks each time, and gets 304 if unchanged
_KEEP = {"Cache-Control": "public, max-age=31536000, immutable"}  # a year
_VERSION = "version-"  # how the version begins in the address of a file
# Whole lines, and what follows code; in a string, a quotation mark would come after the slashes.
_COMMENT = re.compile(
    r"^[ \t]*(?:/\*(?:(?!\*/).)*\*/|//[^\n]*)$|[ \t]+(?:/\*[^\n]*\*/|// [^\n\"'`]*)$",
    re.DOTALL | re.MULTILINE,
)
_INDENTATION = re.compile(r"^[ \t]+", re.MULTILINE)
_COMMENTED = {".js": "text/javascript", ".css": "text/css"}

_Endpoint = Callable[[Request], Awaitable[Response]]


def static_routes() -> list[BaseRoute]:
    """Return the routes of the page, the HTTP reference, and the files that they load."""
    page = _Page()
    return [
        NamedRoute("/", page.index, middleware=_COMPRESSED),
        NamedRoute("/docs", files(_REFERENCE), middleware=_COMPRESSED),
        NamedRoute("/page/{path:path}", page.file, middleware=_COMPRESSED),
        NamedRoute("/docs/{path:path}", files(_REFERENCE), middleware=_COMPRESSED),
        NamedRoute("/examples/{path}.json", files(_EXAMPLES, ".json"), middleware=_COMPRESSED),
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


class _Page:
    """The files of the page, and their version when the page was last asked for."""

    def __init__(self) -> None:
        self._files = _PageFiles(directory=_PAGE)
        self._version = _version()

    async def index(self, request: Request) -> Response:
        """Answer with `index.html`, with the version of its files and the fields of requests."""
        self._version = _version()
        document = (_PAGE / "index.html").read_text(encoding="utf-8")
        headers = {**REVALIDATE, "ETag": f'"{self._version}"'}
        if headers["ETag"] in request.headers.get("If-None-Match", ""):
            return Response(status_code=304, headers=headers)
        inputs = json.dumps(json.loads(_MEMBERS.read_bytes())["inputs"])
        versioned = document.replace('="page/', f'="page/{self._version}/')
        versioned = versioned.replace(_FIELDS, _FIELDS + inputs)
        return HTMLResponse(versioned, headers=headers)

    async def file(self, request: Request) -> Response:
        """Answer with a file, with or without a version in its address."""
        path = request.path_params["path"]
        version, _, rest = path.partition("/")
        versioned = version.startswith(_VERSION)
        response = await self._files.get_response(rest if versioned else path, request.scope)
        # Of another version, which another replica may have, only the address is known.
        response.headers.update(_KEEP if version == self._version else REVALIDATE)
        return response


class _PageFiles(StaticFiles):
    """The files of the page; its scripts and style sheets without comments and indentation."""

    def file_response(
        self,
        full_path: str | os.PathLike[str],
        stat_result: os.stat_result,
        scope: Scope,
        status_code: int = 200,
    ) -> Response:
        found = super().file_response(full_path, stat_result, scope, status_code)
        path = Path(full_path)
        media_type = _COMMENTED.get(path.suffix)
        is_minified = path.suffix == ".js" and path.is_relative_to(_VENDORED)
        if found.status_code != 200 or media_type is None or is_minified:
            return found
        kept = {name: found.headers[name] for name in ("etag", "last-modified")}
        text = _shortened(path.read_text(encoding="utf-8"))
        return Response(text, headers=kept, media_type=media_type)


def _shortened(text: str) -> str:
    """Return a script or a style sheet without comments and indentation, line by line.

    A script with a string over several lines, whose indentation counts, keeps all of it.
    """
    code = _COMMENT.sub(lambda comment: "\n" * comment[0].count("\n"), text)
    has_long_strings = any(line.count("`") % 2 for line in code.splitlines())
    return code if has_long_strings else _INDENTATION.sub("", code)


def _version() -> str:
    """Return the version of the page. A developer changes its files while the service runs."""
    paths = [path for path in sorted(_PAGE.rglob("*")) if path.is_file()]
    stats = ((path, path.stat()) for path in [*paths, _MEMBERS])
    return _digest(tuple((path, stat.st_mtime_ns, stat.st_size) for path, stat in stats))


@lru_cache(maxsize=1)
def _digest(files: tuple[tuple[Path, int, int], ...]) -> str:
    contents = (os.path.relpath(path, _PAGE).encode() + path.read_bytes() for path, _, _ in files)
    return _VERSION + sha256(b"".join(contents)).hexdigest()[:16]
