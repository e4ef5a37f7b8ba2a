"""Connect the Python client with an application in this process, without a network."""

import math
from collections.abc import Mapping

import httpx
from paretour import AsyncClient
from starlette.types import ASGIApp

_MOST_BYTES = 2**23  # of an answer: it is parsed in the event loop


class _Transport(httpx.ASGITransport):
    """A transport that gives requests to an application, with more headers."""

    def __init__(self, app: ASGIApp, client: tuple[str, int], headers: Mapping[str, str]) -> None:
        super().__init__(app, client=client)
        self._headers = headers

    async def handle_async_request(self, request: httpx.Request) -> httpx.Response:
        """Return the application's answer to a request."""
        request.headers.update(self._headers)
        return await super().handle_async_request(request)


def client_of_app(
    app: ASGIApp,
    *,
    client: tuple[str, int] = ("127.0.0.1", 0),
    headers: Mapping[str, str] | None = None,
    patience: float = 60.0,
) -> AsyncClient:
    """Return a client whose requests go to an application in this process.

    Args:
        app: The application. It must have started.
        client: The address and port of the caller, as the application sees them.
        headers: Headers that are added to each request.
        patience: The most seconds, in all, to wait and retry when the application asks for it.
    """
    # Answers are not compressed: they do not go over a network.
    plain = {"Accept-Encoding": "identity", **(headers or {})}
    return AsyncClient(
        "http://paretour",
        patience=patience,
        most_bytes=_MOST_BYTES,
        transport=_Transport(app, client, plain),
    )


async def state_of_app(app: ASGIApp) -> str:
    """Return in words what an application in this process does before it plans."""
    transport = httpx.ASGITransport(app)
    async with httpx.AsyncClient(transport=transport, base_url="http://paretour") as client:
        answer = await client.get("/health/ready")
    found = answer.json()
    if found.get("code") == "warming-up":
        left = int(answer.headers["Retry-After"])
        return f"compiling the search, which takes {left} s more or so"
    if compiling := found.get("compiling"):
        left = math.ceil(compiling["seconds_left"])
        return f"planning, maybe once more code is compiled, which takes {left} s more or so"
    return str(found.get("detail", "planning"))
