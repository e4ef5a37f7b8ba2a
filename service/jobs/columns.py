"""A record in columns of text and bytes, as stores keep it."""

import json
import zlib
from collections.abc import Mapping
from typing import Any

from pydantic_core import to_json

from service.jobs.front_document import Rendered
from service.jobs.messages import Work
from service.jobs.record import Record

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


def front_columns(front: Rendered) -> dict[str, bytes]:
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
        front=Rendered(
            json.loads(columns["members"]),
            zlib.decompress(columns["tours"]),
            columns["ends"],
            columns["angles"],
        ),
        work=Work(kind, columns["body"], columns.get("upload")) if kind else None,
    )
