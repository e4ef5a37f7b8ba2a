"""A worker's access to the records in Redis, and the check whether this machine takes work."""

from contextlib import suppress
from dataclasses import replace
from socket import gethostname
from time import sleep, time
from typing import Any

from redis import Redis
from redis.backoff import NoBackoff
from redis.commands.core import Script
from redis.exceptions import ConnectionError as Unavailable
from redis.exceptions import ResponseError
from redis.retry import Retry

from service.cluster.celery_app import QUEUE
from service.cluster.records import (
    LEASE,
    REASON_OF,
    SCRIPT,
    TAKEN_OVER,
    UNAVAILABLE,
    Argument,
    StoredRecord,
    damaged_key,
    log_repaired,
    progress_arguments,
    record_arguments,
    stored_record,
)
from service.front import Progress
from service.jobs.deadline import Deadline
from service.jobs.record import Record, StopReason
from service.jobs.store import UnreadableRecord, log_dropped
from service.kinds.front_document import FrontDocument

_SECONDS = 2.0  # the longest that one reply of Redis may take
_PATIENCE = 60.0  # seconds for which a call is tried again while Redis is away
_PAUSE = 0.1  # seconds between two tries


class TakenOver(Exception):
    """Another worker runs the record now."""


def connect_script(url: str) -> Script:
    """Return the script of records at this Redis. A call is not tried again."""
    redis = Redis.from_url(
        url, retry=Retry(NoBackoff(), 0), socket_timeout=_SECONDS, socket_keepalive=True
    )
    return redis.register_script(SCRIPT)


class WorkerStore:
    """The records, for one worker process. `worker` is its name, which must be unique."""

    def __init__(self, url: str, worker: str) -> None:
        self._worker = worker
        self._script = connect_script(url)

    def send_heartbeat(self) -> None:
        """Register this worker as alive, if Redis answers."""
        self._call_once("present", self._worker)

    def begin(self, id: str, known_lost: bool) -> StoredRecord | None:  # noqa: A002
        """Take the next record for this worker and return it.

        A message stands for a turn, which goes to the next client. If the worker that had the
        message before is lost, the record is the one that it had.

        Args:
            id: The id in the message.
            known_lost: Whether the message was delivered before, to a worker that is lost.

        Returns None if no record waits, or if the next cannot be read and was dropped.
        """
        known = "lost" if known_lost else ""
        reply = self._call_until_answered("begin", id, self._worker, LEASE, known)
        if not reply:
            return None
        name, *hashes = reply
        try:
            stored = stored_record(*hashes)
            if stored.record.source is None:
                raise UnreadableRecord("what to plan is missing")
        except UnreadableRecord as error:
            log_dropped(name.decode(errors="replace")[:80], error)
            self._call_until_answered("drop", name)
            return None
        return stored

    def stop_reason(self, id: str) -> StopReason | type[TakenOver] | None:  # noqa: A002
        """Renew the lease of a record, and return why it is to be stopped, if it is."""
        reason = self._call_once("seen", id, self._worker)
        return TakenOver if reason == TAKEN_OVER else REASON_OF.get(reason)

    def report(self, id: str, progress: Progress, front: FrontDocument) -> None:  # noqa: A002
        """Store the progress of a record and its best front so far, if Redis answers."""
        self._call_once("progress", id, self._worker, *progress_arguments(progress, front))

    def finish(self, record: Record) -> None:
        """Store a finished record, unless it was finished before."""
        # Its source is in Redis already.
        arguments = record_arguments(replace(record, source=None))
        self._call_until_answered("finish", record.id, *arguments)

    def hand_back(self, id: str) -> None:  # noqa: A002
        """Queue a record again, for another worker."""
        self._call_until_answered("hand_back", id, self._worker)

    def _call_until_answered(self, verb: str, *arguments: Argument) -> Any:
        deadline = Deadline.after(_PATIENCE)
        while True:
            try:
                return self._call(verb, *arguments)
            except UNAVAILABLE:
                if deadline.over():
                    raise
                sleep(_PAUSE)

    def _call_once(self, verb: str, *arguments: Argument) -> Any:
        with suppress(*UNAVAILABLE):
            return self._call(verb, *arguments)

    def _call(self, verb: str, *arguments: Argument) -> Any:
        try:
            return self._script(args=[verb, time(), *arguments])
        except ResponseError as error:
            key = damaged_key(error)
            if key is None:
                raise
            log_repaired(key, error)
            self._script(args=["repair", time(), key])
            raise Unavailable(str(error)) from error  # and so the call is tried again


_LOST_AFTER = LEASE + 1  # seconds until a lost process is no longer counted
_CHECK_EVERY = 0.25  # seconds between two checks


def takes_work(redis_url: str) -> bool:
    """Return whether this machine has a worker, none of whose processes is idle while jobs wait.

    The check takes up to LEASE + 1 seconds. If Redis does not answer, the worker is not at fault,
    and the result is True.
    """
    script = connect_script(redis_url)
    deadline = Deadline.after(_LOST_AFTER)
    try:
        workers, waiting, idle = script(args=["idle", time(), gethostname(), QUEUE])
        while workers and waiting and idle and not deadline.over():
            sleep(_CHECK_EVERY)
            workers, waiting, still = script(args=["idle", time(), gethostname(), QUEUE])
            idle = set(idle).intersection(still)
    except UNAVAILABLE:
        return True
    return bool(workers) and not (waiting and idle)
