"""Retries: pauses that grow, and finished records stored again until the store takes them."""

import asyncio
import logging
from collections.abc import Iterator

from service.errors import StoreUnavailable
from service.jobs.deadline import Deadline
from service.jobs.record import Record, as_failed
from service.jobs.sqlite_store import SqliteStore


def growing_pauses(shortest: float, longest: float) -> Iterator[float]:
    """Yield seconds to wait: the shortest pause, then each twice the last, up to the longest."""
    while True:
        yield shortest
        shortest = min(2 * shortest, longest)


_PATIENCE = 600.0  # seconds for which storing a front is tried
_SHORTEST_PAUSE = 0.25  # seconds between two tries
_LONGEST_PAUSE = 5.0
_LOG = logging.getLogger("paretour")


class UnsavedRecords:
    """Saves records that the store did not accept at first."""

    def __init__(self, store: SqliteStore, patience: float = _PATIENCE) -> None:
        self._store = store
        self._patience = patience
        self._ids: set[str] = set()

    def check_none(self) -> None:
        """Raise StoreUnavailable while the store has not accepted some record."""
        if self._ids:
            raise StoreUnavailable

    async def save(self, record: Record, error: Exception) -> None:
        """Try to store a finished record until the store accepts it.

        After some minutes the front is given up, and a failed record is stored instead.

        Args:
            record: The record.
            error: What the store raised at first.
        """
        self._ids.add(record.id)
        _LOG.error("front %s cannot be stored, and is tried again", record.id, exc_info=error)
        pauses = growing_pauses(_SHORTEST_PAUSE, _LONGEST_PAUSE)
        deadline = Deadline.after(self._patience)
        try:
            while not await self._is_saved(record):
                if deadline.over() and record.front.tours:
                    empty = record.front.without_tours()
                    record = as_failed(record, StoreUnavailable(), empty)
                await asyncio.sleep(next(pauses))
        finally:
            self._ids.discard(record.id)
        _LOG.info("front %s is stored", record.id)

    async def _is_saved(self, record: Record) -> bool:
        try:
            await self._store.put(record)
        except Exception:
            return False
        return True
