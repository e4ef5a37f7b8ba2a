"""A bounded number of plans at a time, and a bounded number that wait."""

import asyncio
import contextlib
import threading

import pytest

from service.workers import Busy, Closed, Cold, Workers
from tests.serving import nothing


def test_what_fails_fails_for_whoever_asked() -> None:
    def fail() -> None:
        raise KeyError("city")

    with pytest.raises(KeyError, match="city"):
        asyncio.run(Workers(workers=1, queue=0, warm_up=nothing).run(fail))


def test_work_keeps_its_place_when_nobody_waits_for_it_any_more() -> None:
    workers = Workers(workers=1, queue=0, warm_up=nothing)
    may_end = threading.Event()

    async def leave_and_ask_again() -> None:
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(workers.run(may_end.wait), timeout=0.05)
        with pytest.raises(Busy):
            await workers.run(lambda: None)

    try:
        asyncio.run(leave_and_ask_again())
    finally:
        may_end.set()


def test_compiled_code_may_not_be_used_before_it_is_warm() -> None:
    may_end = threading.Event()
    workers = Workers(workers=1, queue=0, warm_up=may_end.wait)
    with pytest.raises(Cold):
        workers.check_warm()
    may_end.set()
    while True:
        with contextlib.suppress(Cold):
            workers.check_warm()
            break
    workers.close()


def test_after_the_close_no_work_is_taken() -> None:
    workers = Workers(workers=1, queue=0, warm_up=nothing)
    workers.check_open()
    workers.close()
    with pytest.raises(Closed):
        workers.check_open()
    with pytest.raises(Closed):
        asyncio.run(workers.run(lambda: None))
