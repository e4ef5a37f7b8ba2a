"""A worker's access to the records in Redis, and the check whether this machine takes work."""

import asyncio
from contextlib import suppress
from dataclasses import replace
from socket import gethostname
from typing import Any

from redis.asyncio import Redis

from service.cluster.celery_app import QUEUE
from service.cluster.records import (
    REASON_OF,
    TAKEN_OVER,
    Argument,
    StoredRecord,
    record_arguments,
    report_arguments,
)
from service.cluster.script import LEASE, RecordScript, connect_redis
from service.errors import Cancelled, StoreUnavailable
from service.jobs.deadline import Deadline
from service.jobs.record import Record, StopReason
from service.kinds.front_document import FrontDocument
from service.watch import Progress

_PATIENCE = 60.0  # seconds for which a call is tried again while Redis is away
_PAUSE = 0.1  # seconds between two tries


class TakenOver(Cancelled):
    """Another worker runs the record now."""


class WorkerStore(RecordScript):
    """The records, for a worker that plans one at a time. `worker` is its name, which is unique."""

    def __init__(self, redis: Redis, worker: str) -> None:
        super().__init__(redis)
        self._worker = worker

    async def send_heartbeat(self) -> None:
        """Register this worker as alive, if Redis answers."""
        await self._call_once("present", self._worker)

    async def begin(self, id: str, known_lost: bool) -> StoredRecord | None:
        """Take the next record for this worker and return it.

        A message stands for a turn, which goes to the next client. If the worker that had the
        message before is lost, the record is the one that it had.

        Args:
            id: The id in the message.
            known_lost: Whether the message was delivered before, to a worker that is lost.

        Returns None if no record waits, or if the next cannot be read and was dropped.
        """
        known = "lost" if known_lost else ""
        reply = await self._call_until_answered("begin", id, self._worker, LEASE, known)
        return await self.read(*reply, whole=True) if reply else None

    async def stop_reason(self, id: str) -> StopReason | None:
        """Renew the lease of a record, and return why it is to be stopped, if it is."""
        reason = await self._call_once("seen", id, self._worker)
        return TakenOver if reason == TAKEN_OVER else REASON_OF.get(reason)

    async def report(
        self, id: str, process: int | None, progress: Progress | None, front: FrontDocument | None
    ) -> None:
        """Store which process plans a record, its progress and best front, if Redis answers."""
        arguments = report_arguments(process, progress, front)
        await self._call_once("progress", id, self._worker, *arguments)

    async def finish(self, record: Record) -> None:
        """Store a finished record, unless it was finished before."""
        # Its task is in Redis already.
        arguments = record_arguments(replace(record, task=None))
        await self._call_until_answered("finish", record.id, *arguments)

    async def hand_back(self, id: str) -> None:
        """Queue a record again, for another worker."""
        await self._call_until_answered("hand_back", id, self._worker)

    async def _call_until_answered(self, verb: str, *arguments: Argument) -> Any:
        deadline = Deadline.after(_PATIENCE)
        while True:
            try:
                return await self.call(verb, *arguments)
            except StoreUnavailable:
                if deadline.over():
                    raise
                await asyncio.sleep(_PAUSE)

    async def _call_once(self, verb: str, *arguments: Argument) -> Any:
        with suppress(StoreUnavailable):
            return await self.call(verb, *arguments)


_LOST_AFTER = LEASE + 1  # seconds after which a process without a sign of life counts as lost
_CHECK_EVERY = 0.25  # seconds between two checks


async def takes_work(redis_url: str) -> bool:
    """Return whether this machine has a worker, none of whose processes is idle while jobs wait.

    The check takes up to LEASE + 1 seconds. If Redis does not answer, the worker is not at fault,
    and the result is True.
    """
    script = RecordScript(connect_redis(redis_url))
    deadline = Deadline.after(_LOST_AFTER)
    try:
        workers, waiting, idle = await script.call("idle", gethostname(), QUEUE)
        # A machine that was asleep has no worker until that one's next heartbeat.
        while not workers or (waiting and idle):
            if deadline.over():
                return False
            await asyncio.sleep(_CHECK_EVERY)
            workers, waiting, still = await script.call("idle", gethostname(), QUEUE)
            idle = set(idle).intersection(still)
    except StoreUnavailable:
        return True
    finally:
        await script.close()
    return True
