"""The interface of stores that requests use, and the form in which every store keeps a record.

The names of the columns are read by other releases and stay as they are.
"""

import json
import logging
import zlib
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any, Protocol, get_args

import numpy as np
from pydantic_core import to_json

from service.jobs.listing import ListedFront
from service.jobs.outbox import Outbox
from service.jobs.record import Record, Status
from service.jobs.webhook import Webhook
from service.kinds.front_document import FrontDocument


class UnreadableRecord(Exception):
    """A stored record that cannot be decoded."""


class Store(Outbox, Protocol):
    """Keeps records. Unfinished ones are never dropped, unless they cannot be decoded.

    Finished ones are returned without their task, which only `task` reads.

    When finished records are too many or too large together, the oldest one of the client with the
    most is dropped. A client loses its last one only if no client has two, or if that record alone
    is too large for the store. A client is a caller with a key, or an address.
    """

    async def get(self, caller: str, id: str) -> Record:
        """Return the caller's record with this id.

        Raises:
            NotFound: The caller never had one, or it was deleted.
            Expired: It was dropped, or cannot be decoded and is dropped now.
        """

    async def task(self, record: Record) -> bytes | None:
        """Return the task of a finished record; None if it is not kept.

        Tasks are not kept for failed records, nor if they are larger than one task's share of the
        store.
        """

    async def latest(self, caller: str, client: str) -> Record:
        """Return the caller's record that was finished last for this client.

        Raises:
            NotFound: The client never had one.
            Expired: It was dropped.
        """

    async def fronts(self, caller: str, client: str, below: int, most: int) -> list[ListedFront]:
        """Return the caller's newest records for this client, unfinished ones too.

        Args:
            caller: The name of the API key.
            client: The caller or, without keys, an address.
            below: Only records with a number below this are returned.
        """

    async def delete(self, record: Record) -> None:
        """Delete a record. Afterwards it is unknown, as if it had never been there."""

    async def close(self) -> None:
        """Close the file or the connections."""


STORE_BYTES = 2**28  # of finished records, by default
TASK_SHARE = 4  # the task of a finished record may take up to a quarter of a store
FRONT_COLUMNS = ("members", "tours", "ends", "angles")
TASK_COLUMNS = ("kind", "body")
COLUMNS = (
    *("id", "caller", "request_id", "status", "key", "digest", "problem"),
    *FRONT_COLUMNS,
    *TASK_COLUMNS,
)
_KIND = "task"  # of what stands in `body`: version 0.1 stored requests there
SHORT = 2**16  # bytes of tours that are not compressed, as there is little to gain
_LEVEL = 1  # of compression, the fastest: digits shrink to half of their size


def record_columns(record: Record) -> dict[str, Any]:
    """Return a record as columns, in their order; those without a value are None."""
    return {
        "id": record.id,
        "caller": record.caller,
        "request_id": record.request_id,
        "status": record.status,
        "key": record.key,
        "digest": record.digest,
        "problem": to_json(record.problem),
        **front_columns(record.front),
        "kind": record.task and _KIND,
        "body": record.task,
    }


def front_columns(front: FrontDocument) -> dict[str, bytes]:
    """Return a front as columns."""
    return {
        "members": front.stored(),
        "tours": zlib.compress(front.tours, _LEVEL if len(front.tours) > SHORT else 0),
        "ends": front.ends,
        "angles": front.directions.tobytes(),  # for the version before
    }


def record_size(columns: Mapping[str, Any]) -> int:
    """Return the bytes that a record takes, given its columns."""
    return sum(
        len(value.encode() if isinstance(value, str) else value)
        for value in columns.values()
        if value is not None
    )


def record_from(columns: Mapping[str, Any], webhook: str | None = None) -> Record:
    """Return the record in these columns. Columns that would be None may be missing.

    Args:
        webhook: The JSON of its webhook, if it has one.

    Raises:
        UnreadableRecord: They are damaged, or of another program.
    """
    try:
        record = _decode(columns)
        return replace(record, webhook=Webhook.read(webhook)) if webhook else record
    # All that parsers may raise for damaged bytes.
    except Exception as error:
        raise UnreadableRecord(f"{type(error).__name__}: {error}"[:200]) from error


def listed_from(
    number: int, stored_at: float, id: str, status: Status, members: bytes
) -> ListedFront:
    """Return what a list says of a record, given some of its columns.

    Raises:
        UnreadableRecord: They are damaged, or of another program.
    """
    try:
        _check_status(status)
        front = FrontDocument.from_members(json.loads(members))
        time = datetime.fromtimestamp(stored_at, UTC)
        return ListedFront(number=number, stored_at=time, id=id, status=status, front=front)
    # All that parsers may raise for damaged bytes.
    except Exception as error:
        raise UnreadableRecord(f"{type(error).__name__}: {error}"[:200]) from error


def task_from(columns: Mapping[str, Any]) -> bytes | None:
    """Return the task in these columns; None where there is none."""
    return columns.get("body") if columns.get("kind") == _KIND else None


def log_dropped(id: str, error: UnreadableRecord) -> None:
    """Log that a record that cannot be decoded was dropped."""
    logging.getLogger("paretour").warning("front %s cannot be read and is dropped: %s", id, error)


def _decode(columns: Mapping[str, Any]) -> Record:
    record = Record(
        id=columns["id"],
        caller=columns["caller"],
        request_id=columns["request_id"],
        status=columns["status"],
        key=columns.get("key"),
        digest=columns["digest"],
        problem=json.loads(columns["problem"]),
        front=FrontDocument.from_members(
            json.loads(columns["members"]),
            tours=zlib.decompress(columns["tours"]),
            ends=columns["ends"],
        ),
        task=task_from(columns),
    )
    _check(record)
    return record


def _check(record: Record) -> None:
    """Raise ValueError where a record could not be used later."""
    front = record.front
    texts = (record.id, record.caller, record.request_id, record.status, record.digest)
    if not all(isinstance(text, str) for text in texts):
        raise ValueError("id, caller, request_id, status and digest are not texts")
    ends = np.frombuffer(front.ends, np.int64)
    _check_status(record.status)
    if not isinstance(record.problem, dict | None):
        raise ValueError("problem is not an object")
    if len(front.lengths) != len(ends):
        raise ValueError("lengths and ends differ in number")
    if (int(ends[-1]) if len(ends) else 0) != len(front.tours) or (np.diff(ends) < 1).any():
        raise ValueError("ends are not those of the tours")


def _check_status(status: str) -> None:
    if status not in get_args(Status):
        raise ValueError(f"status is {status!r}")
