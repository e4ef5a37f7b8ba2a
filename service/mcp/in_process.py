"""Connect the Python client with an application in this process, as if over HTTP."""

from collections.abc import Mapping

import httpx
from paretour import AsyncClient
from starlette.types import ASGIApp

_MOST_BYTES = 2**23  # of an answer: it is parsed in the event loop


class _Transport(httpx.ASGITransport):
    """A transport to an application that adds headers to each request."""

    def __init__(self, app: ASGIApp, client: tuple[str, int], headers: Mapping[str, str]) -> None:
        super().__init__(app, client=client)
        self._headers = headers

    async def handle_async_request(self, request: httpx.Request) -> httpx.Response:
        """Have the application answer a request."""
        request.headers.update(self._headers)
        return await super().handle_async_request(request)


def client_of_app(
    app: ASGIApp,
    *,
    client: tuple[str, int] = ("127.0.0.1", 0),
    headers: Mapping[str, str] | None = None,
    patience: float = 60.0,
) -> AsyncClient:
    """Return a client of an application in this process.

    Args:
        app: The application, which has started.
        client: The address and port that the application sees requests come from.
        headers: Headers of each request.
        patience: Seconds, in all, to wait and retry when the application asks for it.
    """
    # Not compressed: nothing is sent anywhere.
    plain = {"Accept-Encoding": "identity", **(headers or {})}
    return AsyncClient(
        "http://paretour",
        patience=patience,
        most_bytes=_MOST_BYTES,
        transport=_Transport(app, client, plain),
    )
