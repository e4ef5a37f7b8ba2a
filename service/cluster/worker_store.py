"""Redis as a worker reads and writes it, and whether this machine's worker takes work."""

from contextlib import suppress
from socket import gethostname
from time import monotonic, sleep, time
from typing import Any

from redis import Redis
from redis.backoff import NoBackoff
from redis.commands.core import Script
from redis.retry import Retry

from service.cluster.celery_app import QUEUE
from service.cluster.records import (
    GONE,
    LEASE,
    REASONS,
    SCRIPT,
    Argument,
    StoredRecord,
    arguments,
    kept_in,
    progress_arguments,
)
from service.errors import Cancelled, DeadlineExceeded
from service.jobs.messages import Snapshot
from service.jobs.record import Record

_SECONDS = 2.0  # that one answer of Redis may take
_PATIENCE = 60.0  # seconds that Redis may be away without anything being lost
_PAUSE = 0.1  # seconds between two tries


class TakenOver(Exception):
    """Another worker has the record now."""


def script_at(url: str) -> Script:
    """What is done with records at this Redis, which is asked once."""
    redis = Redis.from_url(
        url, retry=Retry(NoBackoff(), 0), socket_timeout=_SECONDS, socket_keepalive=True
    )
    return redis.register_script(SCRIPT)


class WorkerStore:
    """One worker's side of the records. `worker` is its name, which no other has."""

    def __init__(self, url: str, worker: str) -> None:
        self._worker = worker
        self._script = script_at(url)

    def present(self) -> None:
        """Say that this worker is there; nothing, if Redis does not answer."""
        self._try("present", self._worker)

    def begin(self, id: str, known_lost: bool) -> StoredRecord | None:  # noqa: A002
        """The record to work on; none where there is nothing to do, or another worker is at it.

        It may be known that whoever was at it is lost.
        """
        known = "lost" if known_lost else ""
        hashes = self._do("begin", id, self._worker, LEASE, known)
        return kept_in(*hashes) if hashes else None

    def reason(self, id: str) -> type[Cancelled | DeadlineExceeded | TakenOver] | None:  # noqa: A002
        """Why the work on a record is to stop, if it is; and this worker is still at it."""
        said = self._try("seen", id, self._worker)
        return TakenOver if said == b"taken" else REASONS.get(said)

    def tell(self, id: str, snapshot: Snapshot) -> None:  # noqa: A002
        """Keep how far the work has come; nothing, if Redis does not answer."""
        self._try("progress", id, self._worker, *progress_arguments(snapshot))

    def finish(self, record: Record) -> None:
        """Keep what became of a record, unless something has already."""
        self._do("finish", record.id, *arguments(record))

    def hand_back(self, id: str) -> None:  # noqa: A002
        """Leave a record to another worker."""
        self._do("hand_back", id, self._worker)

    def _do(self, verb: str, *about: Argument) -> Any:
        deadline = monotonic() + _PATIENCE
        while True:
            try:
                return self._call(verb, *about)
            except GONE:
                if monotonic() > deadline:
                    raise
                sleep(_PAUSE)

    def _try(self, verb: str, *about: Argument) -> Any:
        with suppress(*GONE):
            return self._call(verb, *about)

    def _call(self, verb: str, *about: Argument) -> Any:
        return self._script(args=[verb, time(), *about])


_LOST_AFTER = LEASE + 1  # until a process that was lost counts as one no more
_LOOK_EVERY = 0.25  # seconds between two looks


def takes_work(redis_url: str) -> bool:
    """Whether it does, or would: where Redis does not answer, that is no fault of the worker."""
    look = script_at(redis_url)
    deadline = monotonic() + _LOST_AFTER
    try:
        here, waiting, idle = look(args=["idle", time(), gethostname(), QUEUE])
        while here and waiting and idle and monotonic() < deadline:
            sleep(_LOOK_EVERY)
            here, waiting, still = look(args=["idle", time(), gethostname(), QUEUE])
            idle = set(idle).intersection(still)
    except GONE:
        return True
    return bool(here) and not (waiting and idle)
