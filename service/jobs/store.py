"""The interface of stores, and the columns in which they keep a record."""

import json
import zlib
from collections.abc import Mapping
from typing import Any, Protocol

from pydantic_core import to_json

from service.jobs.front_document import FrontDocument
from service.jobs.record import Record
from service.requests.task import Work


class Store(Protocol):
    """Keeps records. What is not finished never makes way."""

    async def put(self, record: Record) -> None:
        """Keep a record, in place of an earlier one with its id."""

    async def admit(self, record: Record) -> Record:
        """Keep a new record, or give the one that the caller has already under its key.

        One that failed gives up its key, so that a repeat is a new try.

        Raises:
            IdempotencyMismatch: that one is of another body.
        """

    async def get(self, caller: str, id: str) -> Record:  # noqa: A002
        """The caller's record with this id.

        Raises:
            NotFound: there was none.
            Expired: it has made way.
        """

    async def latest(self, caller: str) -> Record:
        """The caller's record that was finished last.

        Raises:
            NotFound: there never was one.
            Expired: it has made way.
        """

    async def forget(self, record: Record) -> None:
        """Keep the record no longer, and nothing in its place."""

    async def unfinished(self) -> list[Record]:
        """All records that still need work, the oldest first."""

    async def close(self) -> None:
        """Let go of what the store is kept in."""


FRONT = ("members", "tours", "ends", "angles")
WORK = ("kind", "body", "upload")
COLUMNS = (
    *("id", "caller", "request_id", "status", "key", "digest", "problem"),
    *FRONT,
    *WORK,
)
_LEVEL = 1  # of compression: digits shrink to half of their size, quickly


def columns(record: Record) -> dict[str, Any]:
    """The columns in their order; what there is not is None."""
    work = record.work
    return {
        "id": record.id,
        "caller": record.caller,
        "request_id": record.request_id,
        "status": record.status,
        "key": record.key,
        "digest": record.digest,
        "problem": to_json(record.problem),
        **front_columns(record.front),
        "kind": work and work.kind,
        "body": work and work.body,
        "upload": work and work.upload,
    }


def front_columns(front: FrontDocument) -> dict[str, bytes]:
    """The columns of a record's front."""
    return {
        "members": to_json(front.members),
        "tours": zlib.compress(front.tours, _LEVEL),
        "ends": front.ends,
        "angles": front.angles,
    }


def record_of(columns: Mapping[str, Any]) -> Record:
    """The record in these columns, of which those that are None may be missing."""
    kind = columns.get("kind")
    return Record(
        id=columns["id"],
        caller=columns["caller"],
        request_id=columns["request_id"],
        status=columns["status"],
        key=columns.get("key"),
        digest=columns["digest"],
        problem=json.loads(columns["problem"]),
        front=FrontDocument(
            json.loads(columns["members"]),
            zlib.decompress(columns["tours"]),
            columns["ends"],
            columns["angles"],
        ),
        work=Work(kind, columns["body"], columns.get("upload")) if kind else None,
    )
