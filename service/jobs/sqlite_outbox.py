"""Keep deliveries to webhooks in the store's SQLite file. The caller opens the transaction."""

import sqlite3

from service.jobs.outbox import MOST_DELIVERIES, Delivery
from service.jobs.record import Status
from service.jobs.store import UnreadableRecord, log_dropped
from service.jobs.webhook import Webhook

_ADD = """
INSERT OR REPLACE INTO delivery (id, webhook, status, ended, attempts, due)
VALUES (?, ?, ?, ?, 0, ?)
"""
_TRIM = "DELETE FROM delivery WHERE id IN (SELECT id FROM delivery ORDER BY due LIMIT -1 OFFSET ?)"
_TAKE = """
UPDATE delivery SET attempts = attempts + 1, due = ?
WHERE id IN (SELECT id FROM delivery WHERE due <= ? ORDER BY due LIMIT ?)
RETURNING id, webhook, status, ended, attempts
"""


class SqliteOutbox:
    """The table of deliveries. Times are in seconds since 1970."""

    def __init__(self, database: sqlite3.Connection) -> None:
        self._database = database

    def add(self, id: str, webhook: Webhook, status: Status, ended: float) -> None:
        """Add the delivery of a job that has just ended; it is due at once."""
        self._database.execute(_ADD, (id, webhook.json(), status, ended, ended))
        self._database.execute(_TRIM, (MOST_DELIVERIES,))

    def take(self, most: int, now: float, seconds: float) -> list[Delivery]:
        """Take deliveries that are due, which are due again after some seconds."""
        found = []
        for row in self._database.execute(_TAKE, (now + seconds, now, most)).fetchall():
            try:
                found.append(Delivery.read(*row))
            except (TypeError, ValueError) as error:
                log_dropped(str(row[0])[:80], UnreadableRecord(error))
                self.remove(row[0])
        return found

    def postpone(self, id: str, due: float) -> None:
        """Have the delivery of a job tried again at a time."""
        self._database.execute("UPDATE delivery SET due = ? WHERE id = ?", (due, id))

    def remove(self, id: str) -> None:
        """Remove the delivery of a job."""
        self._database.execute("DELETE FROM delivery WHERE id = ?", (id,))
