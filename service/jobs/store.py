"""The interface of stores, and the stored form of a record, which all of them share.

The names of the columns are read by other releases and stay as they are.
"""

import json
import zlib
from collections.abc import Mapping
from typing import Any, Protocol

from pydantic_core import to_json

from service.jobs.front_document import FrontDocument
from service.jobs.record import Record
from service.requests.task import TaskSource


class Store(Protocol):
    """Keeps records. Unfinished ones are never dropped."""

    async def put(self, record: Record) -> None:
        """Store a record, in place of an earlier one with its id."""

    async def admit(self, record: Record) -> Record:
        """Store a new record and return it, or return the one that has its idempotency key.

        A failed record gives up its key, so that a repeat is a new try.

        Raises:
            IdempotencyMismatch: The caller used the key for another body.
        """

    async def get(self, caller: str, id: str) -> Record:  # noqa: A002
        """Return the caller's record with this id.

        Raises:
            NotFound: The caller never had one, or it was deleted.
            Expired: It was dropped.
        """

    async def latest(self, caller: str) -> Record:
        """Return the caller's record that was finished last.

        Raises:
            NotFound: The caller never had one.
            Expired: It was dropped.
        """

    async def delete(self, record: Record) -> None:
        """Delete a record, and leave no trace of it."""

    async def unfinished(self) -> list[Record]:
        """Return all unfinished records with their sources, the oldest first."""

    async def close(self) -> None:
        """Close the file or the connections."""


FRONT_COLUMNS = ("members", "tours", "ends", "angles")
SOURCE_COLUMNS = ("kind", "body", "upload")
COLUMNS = (
    *("id", "caller", "request_id", "status", "key", "digest", "problem"),
    *FRONT_COLUMNS,
    *SOURCE_COLUMNS,
)
_LEVEL = 1  # of compression: digits shrink to half of their size, quickly


def record_columns(record: Record) -> dict[str, Any]:
    """Return a record as columns, in their order; those without a value are None."""
    source = record.source
    return {
        "id": record.id,
        "caller": record.caller,
        "request_id": record.request_id,
        "status": record.status,
        "key": record.key,
        "digest": record.digest,
        "problem": to_json(record.problem),
        **front_columns(record.front),
        "kind": source and source.kind,
        "body": source and source.body,
        "upload": source and source.upload,
    }


def front_columns(front: FrontDocument) -> dict[str, bytes]:
    """Return a front as columns."""
    return {
        "members": to_json(front.members()),
        "tours": zlib.compress(front.tours, _LEVEL),
        "ends": front.ends,
        "angles": front.angles,
    }


def record_from(columns: Mapping[str, Any]) -> Record:
    """Return the record in these columns, of which those that are None may be missing."""
    kind = columns.get("kind")
    return Record(
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
            angles=columns["angles"],
        ),
        source=TaskSource(kind, columns["body"], columns.get("upload")) if kind else None,
    )
