"""Map tiles under the stops on the page: where they come from, and the policy for browsers."""

from dataclasses import dataclass
from urllib.parse import urlsplit

from starlette.requests import Request
from starlette.responses import JSONResponse, Response

from service.api.site.routes import NamedRoute


@dataclass(frozen=True)
class Tiles:
    """A server of map tiles, if there is one.

    Args:
        url: The template of a tile's address, with {z}, {x}, {y}, and optionally {s} for one of a,
            b and c in the server's name; None for a map without tiles.
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

    def route(self, roads: bool, seconds: float) -> NamedRoute:
        """Return the route of the settings that the page needs: of its map, and of requests.

        Args:
            roads: Whether tours can be drawn along streets, which a routing engine knows.
            seconds: The most seconds of planning.
        """
        answer = {"tiles": self.url, "credit": self.credit, "roads": roads, "seconds": seconds}

        async def tell(_: Request) -> Response:
            return JSONResponse(answer, headers={"Cache-Control": "no-cache"})

        return NamedRoute("/page/settings.json", tell)
