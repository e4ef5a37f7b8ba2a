"""A bounded number of plans at a time, and a bounded number that wait."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import BoundedSemaphore
from typing import TypeVar

T = TypeVar("T")


class Busy(Exception):
    """As many wait as may wait."""


class Closed(Exception):
    """The service is shutting down."""


class Workers:
    """Threads that plan, so that the event loop stays free to answer.

    Threads are enough: inference lets go of the interpreter.
    """

    def __init__(self, workers: int, queue: int) -> None:
        self._threads = ThreadPoolExecutor(workers, thread_name_prefix="plan")
        self._places = BoundedSemaphore(workers + queue)
        self._closed = False

    def check_open(self) -> None:
        """Nothing, if work is taken.

        Raises:
            Closed: no more work is taken.
        """
        if self._closed:
            raise Closed

    async def run(self, work: Callable[[], T]) -> T:
        """What the work returns.

        Raises:
            Busy: the queue is full.
            Closed: no more work is taken.
        """
        self.check_open()
        if not self._places.acquire(blocking=False):
            raise Busy
        future = self._threads.submit(work)
        # Whoever waits may stop waiting; the work keeps its place until it is done.
        future.add_done_callback(lambda _: self._places.release())
        return await asyncio.wrap_future(future)

    def close(self) -> None:
        """Take no more work, and drop what still waits."""
        self._closed = True
        self._threads.shutdown(wait=False, cancel_futures=True)
