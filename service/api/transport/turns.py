"""Turns of the event loop: each network takes one step at a time, and others come in between."""

import asyncio
from collections import deque
from collections.abc import Callable

Step = Callable[[], None]


class Turns:
    """Runs the steps of each network one after another: one in each turn of the event loop.

    However many connections a network has, and however much they have sent, it takes one step
    between two of anybody else.
    """

    def __init__(self) -> None:
        self._lines: dict[str, deque[Step]] = {}  # by network

    def wait(self, network: str, step: Step) -> None:
        """Run a step in a later turn, after the steps of this network that wait already."""
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
