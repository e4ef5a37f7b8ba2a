"""Serve the tools over stdin and stdout, to a client that started this process."""

import signal
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager, AsyncExitStack, nullcontext
from functools import partial

import anyio
from mcp.server.stdio import stdio_server
from paretour import AsyncClient
from starlette.applications import Starlette

from service.mcp.in_process import client_of_app, state_of_app
from service.mcp.server import make_server
from service.mcp.tools import Planner

_PATIENCE = 600.0  # seconds: the search may have to be compiled first


def serve_of_service(url: str, api_key: str | None, version: str) -> None:
    """Serve tools that call the service at a URL, until stdin ends."""
    client = AsyncClient(url, api_key=api_key)
    _run(lambda: nullcontext(Planner(client, url)), version)


def serve_of_app(app: Starlette, version: str) -> None:
    """Serve tools that call an application in this process, until stdin ends."""

    class Started(AsyncExitStack):
        """A block of code in which the application runs."""

        async def __aenter__(self) -> Planner:  # type: ignore[override]
            await super().__aenter__()
            await self.enter_async_context(app.router.lifespan_context(app))
            client = client_of_app(app, patience=_PATIENCE)
            return Planner(client, state=partial(state_of_app, app))

    _run(Started, version)


def _run(started: Callable[[], AbstractAsyncContextManager[Planner]], version: str) -> None:
    # The thread that reads stdin cannot be cancelled, so Ctrl-C must end the process by itself.
    # Nothing is lost: there is nothing to save.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    anyio.run(_serve, started, version)


async def _serve(started: Callable[[], AbstractAsyncContextManager[Planner]], version: str) -> None:
    # First stdio_server(), so that worker processes do not inherit the protocol's stdin and stdout.
    async with stdio_server() as (reading, writing), started() as planner:
        server = make_server(lambda _: nullcontext(planner), version)
        await server.run(reading, writing, server.create_initialization_options())
