"""The route of agents: `POST /mcp`, streamable HTTP of the Model Context Protocol.

Each message is answered on its own, so that any replica may answer it and no session takes memory.
A tool asks the application itself, with the key and the address of the message: authentication,
rates, limits and the queue are those of every other request.
"""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial

from fastapi import APIRouter
from mcp.server.streamable_http_manager import StreamableHTTPSessionManager
from starlette.requests import Request
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.api.auth import client_of
from service.api.body import receive_message
from service.api.body_budget import BodyAllowance, BodyBudget
from service.api.disconnect import unless_disconnected
from service.mcp.in_process import client_of_app, state_of_app
from service.mcp.server import make_server
from service.mcp.tools import Planner

_MOST_BYTES = 2**21  # of a message: it is parsed in the event loop
_PROGRESS = b'"progressToken"'  # in a message whose client asks for progress


class AgentRoute:
    """The route of agents.

    Args:
        app: The application, which the tools ask.
        budget: The budget for the bodies of all requests.
        most_bytes: The most bytes of a body.
        version: The version of the service.
    """

    def __init__(self, app: ASGIApp, budget: BodyBudget, most_bytes: int, version: str) -> None:
        self._app = app
        self._budget = budget
        self._most_bytes = min(most_bytes, _MOST_BYTES)
        server = make_server(self._connect, version)
        # Progress is told by a stream of events; all other answers are JSON.
        self._plain, self._streaming = (
            StreamableHTTPSessionManager(
                server,
                json_response=json_response,
                stateless=True,
                max_request_body_size=self._most_bytes,
            )
            for json_response in (True, False)
        )

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Return the context in which messages are answered."""
        async with self._plain.run(), self._streaming.run():
            yield

    def router(self) -> APIRouter:
        """Return the route; its messages are documented by the protocol, not in OpenAPI."""
        router = APIRouter()
        router.post("/mcp", include_in_schema=False, response_class=Response)(self.answer)
        return router

    async def answer(self, request: Request) -> Response:
        """Answer a message of the protocol."""
        with self._budget.open(client_of(request)) as allowance:
            body = await receive_message(request, self._most_bytes, allowance)
            streams = _PROGRESS in body and "text/event-stream" in request.headers.get("accept", "")
            manager = self._streaming if streams else self._plain
            return _Answer(manager, body, allowance.hand_over())

    @asynccontextmanager
    async def _connect(self, request: Request) -> AsyncIterator[Planner]:
        """Yield a planner that asks the application as the client of a message."""
        headers = {"X-Request-ID": request.scope["request_id"]}
        if key := request.headers.get("authorization"):
            headers["Authorization"] = key
        address = (request.client.host, request.client.port) if request.client else ("", 0)
        client = client_of_app(self._app, client=address, headers=headers)
        try:
            yield Planner(client, str(request.base_url), partial(state_of_app, self._app))
        finally:
            await client.close()


class _Answer(Response):
    """The answer of the protocol's server to a message that was received."""

    def __init__(
        self, manager: StreamableHTTPSessionManager, body: bytes, allowance: BodyAllowance
    ) -> None:
        super().__init__()
        self._manager = manager
        self._message: Message = {"type": "http.request", "body": body, "more_body": False}
        self._allowance = allowance

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the answer, unless the client goes away before."""
        messages = asyncio.Queue[Message]()  # the body; nothing follows, as the end is watched here
        messages.put_nowait(self._message)

        with self._allowance:
            answering = self._manager.handle_request(scope, messages.get, send)
            await unless_disconnected(Request(scope, receive), answering)
