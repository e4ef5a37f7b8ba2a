"""Both clients, called alike, so that a test of one is a test of the other."""

import asyncio
from collections.abc import AsyncIterator, Callable, Iterator
from typing import Any

from paretour import AsyncClient, AsyncJob


class Waiting:
    """An AsyncClient, or what it gave, of which every call waits."""

    def __init__(self, awaiting: AsyncClient | AsyncJob, runner: asyncio.Runner) -> None:
        self._awaiting = awaiting
        self._runner = runner

    def __getattr__(self, name: str) -> Any:
        value = getattr(self._awaiting, name)
        return self._waiting(value) if callable(value) else value

    def _waiting(self, method: Callable[..., Any]) -> Callable[..., Any]:
        def call(*arguments: Any, **named: Any) -> Any:
            answer = method(*arguments, **named)
            if isinstance(answer, AsyncIterator):
                return self._one_by_one(answer)
            if asyncio.iscoroutine(answer):
                answer = self._runner.run(answer)
            return Waiting(answer, self._runner) if isinstance(answer, AsyncJob) else answer

        return call

    def _one_by_one(self, items: AsyncIterator[Any]) -> Iterator[Any]:
        while (item := self._runner.run(_next(items))) is not None:
            yield item


async def _next(items: AsyncIterator[Any]) -> Any:
    return await anext(items, None)
