"""Let networks take turns in the event loop, one step at a time."""

import asyncio
from collections import deque
from collections.abc import Callable

Step = Callable[[], None]


class Turns:
    """Runs one step of each network in each turn of the event loop.

    A network with many connections, or with much to parse, gets no more steps than another.
    """

    def __init__(self) -> None:
        self._lines: dict[str, deque[Step]] = {}  # by network

    def wait(self, network: str, step: Step) -> None:
        """Run a step in a later turn, after those of this network that already wait."""
        if not self._lines:
            asyncio.get_running_loop().call_soon(self._run)
        self._lines.setdefault(network, deque()).append(step)

    def _run(self) -> None:
        """Run a step of each network, and leave the others to the next turn."""
        for network, line in list(self._lines.items()):
            line.popleft()()
            if not line:
                del self._lines[network]
        if self._lines:
            asyncio.get_running_loop().call_soon(self._run)
