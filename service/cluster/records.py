"""Records as Redis keeps them: fields of hashes, and one script for all that is done with them."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic_core import to_json
from redis import exceptions

from service.errors import Cancelled, DeadlineExceeded
from service.jobs.messages import Snapshot
from service.jobs.record import Record
from service.jobs.store import WORK, columns, front_columns, record_of

SCRIPT = (Path(__file__).parent / "records.lua").read_text()
LEASE = 5.0  # seconds after which a worker that was not seen is lost
# Why work is to stop, as it is written to Redis: replicas and workers of other versions read it.
STOP_REASONS: Mapping[type[Cancelled | DeadlineExceeded], bytes] = {
    Cancelled: b"Stopped",
    DeadlineExceeded: b"Overdue",
}
REASONS = {said: why for why, said in STOP_REASONS.items()}

# What says that it does not answer, or is full.
GONE = (exceptions.ConnectionError, exceptions.TimeoutError, exceptions.OutOfMemoryError)

Argument = str | bytes | float
_PROGRESS = ("seconds", "hypervolume", "points")
_TEXTS = ("id", "caller", "request_id", "status", "key", "digest", "kind")


@dataclass(frozen=True, eq=False, kw_only=True)
class StoredRecord:
    """A record as it stands in Redis, and what Redis knows besides.

    `asked` is when it was asked for, in seconds since 1970.
    """

    record: Record
    asked: float
    attempts: int
    progress: Snapshot | None


def arguments(record: Record) -> list[Argument]:
    """A record for the script: how many arguments are its fields, these, and those of its work."""
    given = {name: value for name, value in columns(record).items() if value is not None}
    work = flat({name: given.pop(name) for name in WORK if name in given})
    if record.front.gained is not None:
        given["gained"] = record.front.gained
    fields = flat(given)
    return [len(fields), *fields, *work]


def progress_arguments(snapshot: Snapshot) -> list[Argument]:
    """The fields that a worker changes while it goes on."""
    progress = {name: getattr(snapshot, name) for name in _PROGRESS}
    return flat({**front_columns(snapshot.front), "progress": to_json(progress)})


def flat(fields: Mapping[str, Argument]) -> list[Argument]:
    """Names and values in turn, as Redis takes them."""
    return [part for field in fields.items() for part in field]


def kept_in(*hashes: Iterable[bytes]) -> StoredRecord:
    """What is in one hash, or in one and that of its work."""
    found = {name: value for each in hashes for name, value in _fields(each).items()}
    record = record_of(found)
    if "gained" in found:
        front = replace(record.front, gained=float(found["gained"]))
        record = replace(record, front=front)
    progress = found.get("progress")
    return StoredRecord(
        record=record,
        asked=float(found["kept"]),
        attempts=int(found.get("attempts", 0)),
        progress=Snapshot(**json.loads(progress), front=record.front) if progress else None,
    )


def _fields(flat: Iterable[bytes]) -> dict[str, Any]:
    parts = iter(flat)
    found: dict[str, Any] = {name.decode(): value for name, value in zip(parts, parts, strict=True)}
    return found | {name: found[name].decode() for name in _TEXTS if name in found}
