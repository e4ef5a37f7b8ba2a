"""Turns at a process that does one thing at a time: clients that wait get them in turn."""

import asyncio
from collections import deque
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

from service.errors import QueueFull

_REMEMBERED = 1000  # clients whose latest turn is remembered


class FairTurns:
    """One turn at a time, for the client whose latest turn is longest ago.

    A client without a turn so far is next. Several of one client come in their order.

    Args:
        most: How many may wait.
        most_of_client: How many of one client may wait, so that others find a place.
    """

    def __init__(self, most: int, most_of_client: int) -> None:
        self._most, self._most_of_client = most, most_of_client
        self._waiting: dict[str, deque[asyncio.Future[None]]] = {}
        self._latest: dict[str, int] = {}  # the number of each client's latest turn, ascending
        self._number = 0
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
        if not self._taken:
            self._taken = True
            self._note_turn(client)
            return
        mine = self._waiting.get(client, ())
        others = sum(map(len, self._waiting.values()))
        if others >= self._most or len(mine) >= self._most_of_client:
            raise QueueFull
        came: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.setdefault(client, deque()).append(came)
        try:
            async with asyncio.timeout(seconds):
                await came
        except BaseException as error:
            self._give_up(client, came)
            if isinstance(error, TimeoutError):
                raise QueueFull from None
            raise

    def _give_up(self, client: str, came: asyncio.Future[None]) -> None:
        """Take back a place in the queue, or a turn that came at the same moment."""
        if came.done() and not came.cancelled():
            self._pass_on()
            return
        with suppress(KeyError, ValueError):
            self._waiting[client].remove(came)
            if not self._waiting[client]:
                del self._waiting[client]

    def _pass_on(self) -> None:
        """Give the turn to the next that waits."""
        self._taken = False
        while self._waiting and not self._taken:
            client = min(self._waiting, key=lambda each: self._latest.get(each, -1))
            came = self._waiting[client].popleft()
            if not self._waiting[client]:
                del self._waiting[client]
            if not came.done():
                came.set_result(None)
                self._taken = True
                self._note_turn(client)

    def _note_turn(self, client: str) -> None:
        self._latest.pop(client, None)
        self._latest[client] = self._number
        self._number += 1
        if len(self._latest) > _REMEMBERED:
            del self._latest[next(iter(self._latest))]
