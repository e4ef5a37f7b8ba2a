"""Build the MCP server: it lists the tools, calls them, and returns errors as sentences."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager, suppress
from typing import Any

import httpx
from mcp.server.context import ServerRequestContext
from mcp.server.lowlevel import Server
from mcp.types import (
    CallToolRequestParams,
    CallToolResult,
    ListToolsResult,
    PaginatedRequestParams,
    TextContent,
    ToolAnnotations,
)
from mcp.types import Tool as ListedTool
from paretour import Refused, UnexpectedAnswer

from service.errors import Refusal
from service.mcp.summaries import refusal_text
from service.mcp.tools import TOOLS, Planner

# Returns the service for a call of a tool, given the HTTP request of the call; None over stdio.
Connect = Callable[[Any], AbstractAsyncContextManager[Planner]]
_MOST_ERROR = 2000  # characters
_PAUSE = 5.0  # seconds between two notifications: clients give up after a minute of silence
_INSTRUCTIONS = (
    "Paretour plans tours and fleets under two to four objectives and returns the Pareto front:"
    " every tour or plan that no other beats in everything. Plan first, explain what is traded, ask"
    " the person for a budget or a preference, then choose, or let them choose by `ask`. During the"
    " day, replan. Nothing is dispatched: the tools only plan and read."
)


def make_server(connect: Connect, version: str) -> Server[Any]:
    """Return a server with all tools.

    Args:
        connect: Returns the service for each call of a tool.
        version: The version that the server tells its clients.
    """

    async def list_tools(
        _context: ServerRequestContext[Any, Any], _params: PaginatedRequestParams | None
    ) -> ListToolsResult:
        return ListToolsResult(tools=_LISTED)

    async def call_tool(
        context: ServerRequestContext[Any, Any], params: CallToolRequestParams
    ) -> CallToolResult:
        tool = _BY_NAME.get(params.name)
        if tool is None:
            return _answer(f"tool must be one of {', '.join(_BY_NAME)}", is_error=True)
        try:
            async with connect(context.request) as planner, _progress(context, planner):
                return _answer(await tool.call(planner, params.arguments or {}))
        except Refused as error:
            return _answer(refusal_text(error), is_error=True)
        except (Refusal, ValueError) as error:
            return _answer(str(error), is_error=True)
        except UnexpectedAnswer as error:
            return _answer(f"the service's answer is wrong: {error}", is_error=True)
        except httpx.TransportError as error:
            return _answer(f"the service does not answer: {error}", is_error=True)

    return Server(
        "paretour",
        version=version,
        title="Paretour",
        instructions=_INSTRUCTIONS,
        on_list_tools=list_tools,
        on_call_tool=call_tool,
    )


@asynccontextmanager
async def _progress(
    context: ServerRequestContext[Any, Any], planner: Planner
) -> AsyncIterator[None]:
    """Tell a client that asked for it every few seconds that a tool still runs, and on what."""

    async def tell() -> None:
        seconds = 0.0
        while True:
            await asyncio.sleep(_PAUSE)
            seconds += _PAUSE
            message = await planner.state() if planner.state else "planning"
            await context.session.report_progress(seconds, message=message)

    telling = asyncio.create_task(tell())
    try:
        yield
    finally:
        telling.cancel()
        with suppress(asyncio.CancelledError):
            await telling


def _answer(text: str, *, is_error: bool = False) -> CallToolResult:
    shown = text[:_MOST_ERROR] if is_error else text
    return CallToolResult(content=[TextContent(type="text", text=shown)], is_error=is_error)


_BY_NAME = {tool.name: tool for tool in TOOLS}
_LISTED = [
    ListedTool(
        name=tool.name,
        description=tool.description,
        input_schema=tool.schema,
        annotations=ToolAnnotations(
            read_only_hint=tool.reads_only, destructive_hint=False, open_world_hint=False
        ),
    )
    for tool in TOOLS
]
