"""Reading what is asked for while the event loop goes on: a long body in a process of its own."""

import asyncio
from collections.abc import Mapping

from anyio import BrokenWorkerProcess, CapacityLimiter, to_process

from service.actor import ActorFacts
from service.jobs.messages import Work
from service.jobs.submission import Lost
from service.requests.asked import read
from service.requests.schemas import Limits
from service.requests.task import Task

_SHORT = 2**17  # bytes that are read within a few milliseconds; many megabytes take seconds
_TRIES = 2


class Reader:
    """Reads within these limits, for these actors.

    The process is started for the first long body, and again where it was lost. It reads one body
    at a time; whoever sends another waits.
    """

    def __init__(self, limits: Limits, actors: Mapping[str, ActorFacts]) -> None:
        self._limits = limits
        self._actors = dict(actors)
        self._one = CapacityLimiter(1)

    async def read(self, work: Work) -> Task:
        """The task in a piece of work.

        Raises:
            Refusal: there is none, it is over a limit, or no actor serves it.
            InvalidInstance: it cannot be planned.
            Lost: the process did not survive it, nor did the next.
        """
        if len(work.body) + len(work.upload or b"") <= _SHORT:
            return read(work, self._limits, self._actors)
        for _ in range(_TRIES):
            # To put it together took a while, and to hand it over will: others come in between.
            await asyncio.sleep(0)
            try:
                return await to_process.run_sync(
                    read, work, self._limits, self._actors, cancellable=True, limiter=self._one
                )
            except BrokenWorkerProcess:
                continue
        raise Lost
