"""The asynchronous client called as the synchronous one is, so that one test holds for both."""

import asyncio
from collections.abc import AsyncIterator, Callable, Iterator
from typing import Any

from paretour import AsyncClient, AsyncJob


class SyncAdapter:
    """An AsyncClient, or a job of one, whose coroutines are run to their end at each call."""

    def __init__(self, adapted: AsyncClient | AsyncJob, runner: asyncio.Runner) -> None:
        self._adapted = adapted
        self._runner = runner

    def __getattr__(self, name: str) -> Any:
        value = getattr(self._adapted, name)
        return self._blocking(value) if callable(value) else value

    def _blocking(self, method: Callable[..., Any]) -> Callable[..., Any]:
        def call(*arguments: Any, **named: Any) -> Any:
            answer = method(*arguments, **named)
            if isinstance(answer, AsyncIterator):
                return self._items(answer)
            if asyncio.iscoroutine(answer):
                answer = self._runner.run(answer)
            return SyncAdapter(answer, self._runner) if isinstance(answer, AsyncJob) else answer

        return call

    def _items(self, items: AsyncIterator[Any]) -> Iterator[Any]:
        while (item := self._runner.run(_next(items))) is not None:
            yield item


async def _next(items: AsyncIterator[Any]) -> Any:
    return await anext(items, None)
