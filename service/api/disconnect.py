"""Stop the work for clients that disconnect before they are answered."""

import asyncio
from collections.abc import Coroutine
from typing import Any, TypeVar

from starlette.requests import Request

from service.errors import Cancelled

_Result = TypeVar("_Result")


async def disconnected(request: Request) -> None:
    """Wait until the client goes away, once the body of its request was received."""
    while (await request.receive())["type"] != "http.disconnect":
        pass


async def unless_disconnected(request: Request, work: Coroutine[Any, Any, _Result]) -> _Result:
    """Return the result of work, which is cancelled when the client goes away.

    Raises:
        Cancelled: The client went away.
    """
    working = asyncio.create_task(work)
    gone = asyncio.create_task(disconnected(request))
    try:
        await asyncio.wait((working, gone), return_when=asyncio.FIRST_COMPLETED)
        if not working.done():
            raise Cancelled
        return working.result()
    finally:
        working.cancel()
        gone.cancel()
