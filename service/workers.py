"""A bounded number of plans at a time, and a bounded number that wait."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import BoundedSemaphore, Event, Thread
from typing import TypeVar

T = TypeVar("T")


class Busy(Exception):
    """As many wait as may wait."""


class Closed(Exception):
    """The service is shutting down."""


class Cold(Exception):
    """The search is still being compiled, which happens once, or loaded."""


class Workers:
    """Threads that plan, so that the event loop stays free to answer.

    Threads are enough: inference and search let go of the interpreter. What the search needs is
    warmed up in a thread of its own, so that the network can be asked in the meantime.
    """

    def __init__(self, workers: int, queue: int, warm_up: Callable[[], None]) -> None:
        self._threads = ThreadPoolExecutor(workers, thread_name_prefix="plan")
        self._places = BoundedSemaphore(workers + queue)
        self._closed = False
        self._warm = Event()
        Thread(target=self._warm_up, args=[warm_up], name="warm-up", daemon=True).start()

    def check_open(self) -> None:
        """Nothing, if work is taken.

        Raises:
            Closed: no more work is taken.
        """
        if self._closed:
            raise Closed

    def check_warm(self) -> None:
        """Nothing, if work may use compiled code.

        Raises:
            Cold: it is not there yet.
        """
        if not self._warm.is_set():
            raise Cold

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

    def _warm_up(self, warm_up: Callable[[], None]) -> None:
        warm_up()
        self._warm.set()

    def close(self) -> None:
        """Take no more work, and drop what still waits."""
        self._closed = True
        self._threads.shutdown(wait=False, cancel_futures=True)
