"""Tasks that are cancelled end, also those that miss it at first."""

import asyncio
from contextlib import suppress

from service.jobs.cancelling import cancel_all


async def _goes_on_once() -> None:
    with suppress(asyncio.CancelledError):
        await asyncio.sleep(60)
    await asyncio.sleep(60)


async def _fails() -> None:
    try:
        await asyncio.sleep(60)
    finally:
        raise ValueError


def test_a_task_that_misses_its_cancellation_is_cancelled_again() -> None:
    async def test() -> list[asyncio.Task[None]]:
        tasks = [asyncio.create_task(each()) for each in (_goes_on_once, _fails)]
        await asyncio.sleep(0)  # they have begun
        await cancel_all(tasks)
        return tasks

    stubborn, failed = asyncio.run(test())
    assert stubborn.cancelled()
    assert isinstance(failed.exception(), ValueError)
