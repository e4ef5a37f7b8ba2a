"""End asyncio tasks for certain."""

import asyncio
from collections.abc import Iterable
from typing import Any

_AGAIN = 1.0  # seconds


async def cancel_all(tasks: Iterable[asyncio.Task[Any]]) -> None:
    """Cancel tasks, again and again until each has ended. What they raise is dropped.

    A task can miss its cancellation, and to wait for it would then take forever: in Python 3.11
    asyncio.wait_for() returns a result that comes just then, and redis-py sends commands by it.
    """
    left = {task for task in tasks if not task.done()}
    while left:
        for task in left:
            task.cancel()
        done, left = await asyncio.wait(left, timeout=_AGAIN)
        for task in done:
            if not task.cancelled():
                task.exception()
