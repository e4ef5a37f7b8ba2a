"""Retries: pauses that grow, and finished records stored again until the store takes them."""

import asyncio
import logging

from service.errors import StoreUnavailable
from service.jobs.deadline import Deadline
from service.jobs.record import Record, as_failed
from service.jobs.sqlite_store import SqliteStore


class GrowingPause:
    """A pause that doubles each time, from the shortest to the longest, in seconds."""

    def __init__(self, shortest: float, longest: float) -> None:
        self._shortest = shortest
        self._longest = longest
        self._seconds = shortest

    async def wait(self) -> None:
        """Wait; the next pause is longer."""
        seconds, self._seconds = self._seconds, min(2 * self._seconds, self._longest)
        await asyncio.sleep(seconds)

    def reset(self) -> None:
        """Begin with the shortest again."""
        self._seconds = self._shortest


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
        pause = GrowingPause(_SHORTEST_PAUSE, _LONGEST_PAUSE)
        deadline = Deadline.after(self._patience)
        try:
            while not await self._is_saved(record):
                if deadline.over() and record.front.tours:
                    empty = record.front.without_tours()
                    record = as_failed(record, StoreUnavailable(), empty)
                await pause.wait()
        finally:
            self._ids.discard(record.id)
        _LOG.info("front %s is stored", record.id)

    async def _is_saved(self, record: Record) -> bool:
        try:
            await self._store.put(record)
        except Exception:
            return False
        return True
