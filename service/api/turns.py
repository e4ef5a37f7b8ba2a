"""Turns at a process that does one thing at a time: clients that wait get them in turn."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass

from service.errors import QueueFull
from service.jobs.fair_queue import FairQueue


@dataclass(frozen=True, eq=False)
class _Waiting:
    """A client that waits for a turn, until the future has a result."""

    client: str
    came: asyncio.Future[None]


class FairTurns:
    """One turn at a time, for the client whose latest turn is longest ago.

    A client without a turn so far is next. Several of one client come in their order.

    Args:
        most: How many may wait.
        most_of_client: How many of one client may wait, so that others find a place.
    """

    def __init__(self, most: int, most_of_client: int) -> None:
        self._most, self._most_of_client = most, most_of_client
        self._queue = FairQueue[_Waiting]()
        self._taken = False

    @asynccontextmanager
    async def turn(self, client: str, seconds: float) -> AsyncIterator[None]:
        """Wait for a turn, which lasts as long as the context.

        Raises:
            QueueFull: Too many wait, or the turn did not come within these seconds.
        """
        await self._wait(client, seconds)
        try:
            yield
        finally:
            self._pass_on()

    async def _wait(self, client: str, seconds: float) -> None:
        mine = sum(each.client == client for each in self._queue)
        if self._taken and (len(self._queue) >= self._most or mine >= self._most_of_client):
            raise QueueFull
        waiting = _Waiting(client, asyncio.get_running_loop().create_future())
        self._queue.append(waiting)
        if not self._taken:
            self._pass_on()
        try:
            async with asyncio.timeout(seconds):
                await waiting.came
        except BaseException as error:
            self._give_up(waiting)
            if isinstance(error, TimeoutError):
                raise QueueFull from None
            raise

    def _give_up(self, waiting: _Waiting) -> None:
        """Take back a place in the queue, or a turn that came at the same moment."""
        if waiting.came.done() and not waiting.came.cancelled():
            self._pass_on()
        else:
            self._queue.remove(waiting)

    def _pass_on(self) -> None:
        """Give the turn to the next that waits."""
        following = self._queue.next(able=lambda each: not each.came.done())
        self._taken = following is not None
        if following is not None:
            self._queue.take(following)
            following.came.set_result(None)
