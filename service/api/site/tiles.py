"""Map tiles under the stops on the page: where they come from, and the policy for browsers."""

import re
from dataclasses import dataclass
from urllib.parse import urlsplit

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

# No spaces, commas or semicolons: the server's name becomes part of a header.
_TEMPLATE = re.compile(r"https?://[A-Za-z0-9.{}:-]+/[A-Za-z0-9_.~/{}?&=%@+-]*")
_PARTS = ("{z}", "{x}", "{y}")


@dataclass(frozen=True)
class Tiles:
    """A server of map tiles, if there is one.

    Args:
        url: The template of a tile's address, with {z}, {x}, {y}, and optionally {s} for one of a,
            b and c in the server's name; None if there are no tiles.
        credit: The credit for the map, which its licence demands to be shown.
    """

    url: str | None = None
    credit: str = ""

    @property
    def source(self) -> str:
        """The tiles' server as a source of a content security policy; empty without one."""
        if self.url is None:
            return ""
        scheme, server, *_ = urlsplit(self.url)
        return f"{scheme}://{server.replace('{s}', '*')}"

    def route(self, roads: bool) -> Route:
        """Return the route that tells the page what it may draw on its map.

        Args:
            roads: Whether tours can be drawn along streets, which a routing engine knows.
        """
        answer = {"tiles": self.url, "credit": self.credit, "roads": roads}

        async def tell(_: Request) -> Response:
            return JSONResponse(answer, headers={"Cache-Control": "no-cache"})

        return Route("/page/map.json", tell)


def checked_template(url: str) -> str:
    """Return the template of a tile's address.

    Raises:
        ValueError: The text is not such a template.
    """
    server = urlsplit(url).netloc.removeprefix("{s}.") if _TEMPLATE.fullmatch(url) else "{"
    if "{" in server or not all(url.count(part) == 1 for part in _PARTS):
        raise ValueError("must be like https://tiles.example.org/{z}/{x}/{y}.png")
    return url
