"""Clients that wait for a process have turns, and none takes every place in the queue."""

import asyncio
from collections.abc import Awaitable, Callable

import pytest

from service.api.turns import FairTurns
from service.errors import QueueFull


async def settled() -> None:
    for _ in range(5):
        await asyncio.sleep(0)


class Line:
    """Jobs that take their turns one by one, each ended by the test."""

    def __init__(self, turns: FairTurns) -> None:
        self.turns = turns
        self.begun: list[str] = []
        self.tasks: dict[str, asyncio.Task[None]] = {}
        self.ends: dict[str, asyncio.Event] = {}

    async def come(self, *names: str, seconds: float = 60) -> None:
        """Let jobs come, each named after its client and its number."""
        for name in names:
            self.ends[name] = asyncio.Event()
            self.tasks[name] = asyncio.create_task(self._job(name, seconds))
            await settled()

    async def _job(self, name: str, seconds: float) -> None:
        async with self.turns.turn(name[0], seconds):
            self.begun.append(name)
            await self.ends[name].wait()

    async def end_all(self) -> None:
        """End the jobs, each once it has begun."""
        while any(not task.done() for task in self.tasks.values()):
            for name in self.begun:
                self.ends[name].set()
            await settled()

    def refused(self) -> list[str]:
        return [
            n
            for n, each in self.tasks.items()
            if each.done() and not each.cancelled() and each.exception()
        ]


def run(scenario: Callable[[], Awaitable[None]]) -> None:
    async def bounded() -> None:
        async with asyncio.timeout(30):
            await scenario()

    asyncio.run(bounded())


@pytest.mark.parametrize(
    ("came", "begun"),
    [
        ("a1 a2 a3 b1", "a1 b1 a2 a3"),
        ("a1 a2 a3 b1 b2 c1", "a1 b1 c1 a2 b2 a3"),
        ("a1 a2 b1 a3 b2", "a1 b1 a2 b2 a3"),
        ("a1 a2 a3", "a1 a2 a3"),
    ],
)
def test_a_client_that_waits_is_served_before_the_next_of_another(came: str, begun: str) -> None:
    async def scenario() -> None:
        line = Line(FairTurns(16, 8))
        await line.come(*came.split())
        await line.end_all()
        assert line.begun == begun.split()

    run(scenario)


def test_a_client_leaves_places_to_others() -> None:
    async def scenario() -> None:
        line = Line(FairTurns(4, 2))
        await line.come("a1", "a2", "a3", "a4", "b1", "c1", "d1")
        assert line.refused() == ["a4", "d1"]
        assert isinstance(line.tasks["a4"].exception(), QueueFull)
        await line.end_all()
        assert line.begun == ["a1", "b1", "c1", "a2", "a3"]

    run(scenario)


def test_who_waits_too_long_or_leaves_gives_the_place_back() -> None:
    async def scenario() -> None:
        line = Line(FairTurns(2, 2))
        await line.come("a1")
        await line.come("b1", seconds=0.01)
        await line.come("c1")
        await asyncio.sleep(0.05)
        assert isinstance(line.tasks["b1"].exception(), QueueFull)
        line.tasks["c1"].cancel()
        await settled()
        await line.come("d1", "e1")
        await line.end_all()
        assert line.begun == ["a1", "d1", "e1"]

    run(scenario)


def test_a_turn_that_comes_as_its_client_leaves_is_passed_on() -> None:
    async def scenario() -> None:
        line = Line(FairTurns(4, 4))
        await line.come("a1", "b1", "c1")
        line.ends["a1"].set()
        await asyncio.sleep(0)  # the job ends, and b has the turn but not begun
        line.tasks["b1"].cancel()
        await line.end_all()
        assert line.begun[-1] == "c1"

    run(scenario)
