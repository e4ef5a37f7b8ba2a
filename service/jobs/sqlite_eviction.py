"""Choose the records to drop from the SQLite store: those too old, too long, or too many."""

import sqlite3

from service.jobs.sqlite_schema import UNFINISHED

FINISHED = f"NOT {UNFINISHED}"
_SUMS = f"SELECT count(*), total(size), min(kept), max(size) FROM front WHERE {FINISHED}"
# The records dropped by dropping the oldest of the client with most again and again.
_FIRST_OUT = f"""
SELECT number FROM (
    SELECT number, row_number() OVER (PARTITION BY client ORDER BY number DESC) AS place
    FROM front WHERE {FINISHED}
) ORDER BY place DESC, number LIMIT ?
"""
# The oldest of the client that takes most bytes; if nobody has two, of those with one.
_LARGEST_OUT = f"""
SELECT min(number) FROM front WHERE {FINISHED} GROUP BY client
ORDER BY count(*) > 1 DESC, sum(size) DESC, min(number) LIMIT 1
"""
Condition = tuple[str] | tuple[str, float] | tuple[str, float, float]


def next_out(
    database: sqlite3.Connection, oldest: float, entries: int, max_bytes: int
) -> Condition | None:
    """Return the finished records to drop next, as a condition with its values; None for none.

    Args:
        database: The store's file.
        oldest: The time before which no record may have been kept.
        entries: How many records there may be.
        max_bytes: The most bytes of all together, and so of each.
    """
    count, size, first, longest = database.execute(_SUMS).fetchone()
    if count and (first < oldest or longest > max_bytes):
        return f"{FINISHED} AND (kept < ? OR size > ?)", oldest, max_bytes
    if count > entries:
        return f"number IN ({_FIRST_OUT})", count - entries
    return (f"number = ({_LARGEST_OUT})",) if size > max_bytes else None
