"""Serve the tools over stdin and stdout, for a client that starts this process."""

import signal
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager, AsyncExitStack, nullcontext

import anyio
from mcp.server.stdio import stdio_server
from paretour import AsyncClient
from starlette.applications import Starlette

from service.mcp.in_process import client_of_app
from service.mcp.server import make_server
from service.mcp.tools import Planner

_PATIENCE = 600.0  # seconds: the search may have to be compiled first


def serve_of_service(url: str, api_key: str | None, version: str) -> None:
    """Serve until stdin ends, with a service at a URL that plans."""
    client = AsyncClient(url, api_key=api_key)
    _run(lambda: nullcontext(Planner(client, url)), version)


def serve_of_app(app: Starlette, version: str) -> None:
    """Serve until stdin ends, with an application in this process that plans."""

    class Started(AsyncExitStack):
        """The application from its start to its end."""

        async def __aenter__(self) -> Planner:  # type: ignore[override]
            await super().__aenter__()
            await self.enter_async_context(app.router.lifespan_context(app))
            return Planner(client_of_app(app, patience=_PATIENCE))

    _run(Started, version)


def _run(started: Callable[[], AbstractAsyncContextManager[Planner]], version: str) -> None:
    # A thread that reads stdin cannot be cancelled: Ctrl-C ends the process, as nothing is kept.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    anyio.run(_serve, started, version)


async def _serve(started: Callable[[], AbstractAsyncContextManager[Planner]], version: str) -> None:
    # In this order, so that worker processes do not inherit the stdin and stdout of the protocol.
    async with stdio_server() as (reading, writing), started() as planner:
        server = make_server(lambda _: nullcontext(planner), version)
        await server.run(reading, writing, server.create_initialization_options())
