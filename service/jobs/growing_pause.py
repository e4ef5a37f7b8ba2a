"""A pause that grows, between tries of something that fails."""

import asyncio


class GrowingPause:
    """A pause of so many seconds at first, twice as long each time, up to the longest."""

    def __init__(self, shortest: float, longest: float) -> None:
        self._shortest = shortest
        self._longest = longest
        self._seconds = shortest

    async def wait(self) -> None:
        """Wait, the longer the more often."""
        seconds, self._seconds = self._seconds, min(2 * self._seconds, self._longest)
        await asyncio.sleep(seconds)

    def reset(self) -> None:
        """Begin with the shortest again."""
        self._seconds = self._shortest
