"""The form of a record in Redis: the fields of its hashes, and the script that changes them.

Replicas and workers of different releases share one Redis. The names of fields and stop reasons,
the columns in `jobs.store` and the keys in `stored_records.lua` therefore stay as they are.
"""

import json
import logging
import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from pydantic_core import to_json
from redis import exceptions

from service.errors import Cancelled, DeadlineExceeded
from service.errors.printable import printable
from service.jobs.front_document import FrontDocument
from service.jobs.record import Record, StopReason
from service.jobs.store import (
    SOURCE_COLUMNS,
    UnreadableRecord,
    front_columns,
    record_columns,
    record_from,
    source_from,
)
from service.requests.task import TaskSource
from service.search.improve import Progress

SCRIPT = "".join(
    (Path(__file__).parent / name).read_text() for name in ("stored_records.lua", "records.lua")
)
LEASE = 5.0  # seconds without a sign of life after which a worker is lost
CHANNEL = "paretour:told"  # where the script publishes "id:status" after each change

# Fields beside the columns. The script sets the first two.
REQUESTED_AT = "kept"  # seconds since 1970
ATTEMPTS = "attempts"
GAINED = "gained"
PROGRESS = "progress"
CLIENT = "client"

STOP_REASONS: Mapping[StopReason, bytes] = {Cancelled: b"Stopped", DeadlineExceeded: b"Overdue"}
REASON_OF = {name: reason for reason, name in STOP_REASONS.items()}
TAKEN_OVER = b"taken"

# Redis does not answer, is full, or is a read-only replica.
UNAVAILABLE = (
    exceptions.ConnectionError,
    exceptions.TimeoutError,
    exceptions.OutOfMemoryError,
    exceptions.ReadOnlyError,
)
# How errors begin where Redis cannot write to its disk, or to enough copies.
REFUSES_WRITES = ("MISCONF", "NOREPLICAS")

# The script's error where a key holds foreign data, with the name of that key in JSON.
_DAMAGED = re.compile(r'damaged ("(?:[^"\\]|\\.)*")')

Argument = str | bytes | float
_TEXTS = ("id", "caller", "request_id", "status", "key", "digest", "kind", CLIENT)


@dataclass(frozen=True, eq=False, kw_only=True)
class StoredRecord:
    """A record as it stands in Redis. `requested_at` is in seconds since 1970."""

    record: Record
    requested_at: float
    attempts: int
    progress: Progress | None


def record_arguments(record: Record) -> list[Argument]:
    """Return a record as arguments of the script.

    They are the number of arguments for its hash, these arguments, and those for the hash of its
    source.
    """
    columns = {name: value for name, value in record_columns(record).items() if value is not None}
    source = {name: columns.pop(name) for name in SOURCE_COLUMNS if name in columns}
    if record.front.gained is not None:
        columns[GAINED] = record.front.gained
    if record.client:
        columns[CLIENT] = record.client
    fields = _names_and_values(columns)
    return [len(fields), *fields, *_names_and_values(source)]


def progress_arguments(progress: Progress, front: FrontDocument) -> list[Argument]:
    """Return the fields that a worker's report changes, as arguments of the script."""
    return _names_and_values({**front_columns(front), PROGRESS: to_json(asdict(progress))})


def damaged_key(error: exceptions.ResponseError) -> str | None:
    """Return the key with foreign data, if that is why the script has failed."""
    found = _DAMAGED.search(str(error))
    return None if found is None else str(json.loads(found[1]))


def log_repaired(key: str, error: exceptions.ResponseError) -> None:
    """Log that a key was put aside, because it held foreign data."""
    logging.getLogger("paretour").error(
        "key %s of Redis is damaged, put aside as paretour:damaged and made anew: %s",
        printable(key)[:200],
        error,
    )


def stored_record(*hashes: Iterable[bytes]) -> StoredRecord:
    """Return the record in a hash, and optionally that of its source, as HGETALL gives them.

    Raises:
        UnreadableRecord: They are damaged, or of another program.
    """
    try:
        return _decode(*hashes)
    except (ArithmeticError, LookupError, TypeError, ValueError) as error:
        raise UnreadableRecord(f"{type(error).__name__}: {error}"[:200]) from error


def stored_source(source: Iterable[bytes]) -> TaskSource | None:
    """Return the source in a hash, as HGETALL gives it; None where it is empty or damaged."""
    try:
        return source_from(_fields(source))
    except (LookupError, ValueError):
        return None


def _decode(*hashes: Iterable[bytes]) -> StoredRecord:
    fields = {name: value for each in hashes for name, value in _fields(each).items()}
    record = replace(record_from(fields), client=fields.get(CLIENT, ""))
    if GAINED in fields:
        front = replace(record.front, gained=float(fields[GAINED]))
        record = replace(record, front=front)
    progress = fields.get(PROGRESS)
    return StoredRecord(
        record=record,
        requested_at=float(fields[REQUESTED_AT]),
        attempts=int(fields.get(ATTEMPTS, 0)),
        progress=Progress(**json.loads(progress)) if progress else None,
    )


def _names_and_values(fields: Mapping[str, Argument]) -> list[Argument]:
    return [part for field in fields.items() for part in field]


def _fields(names_and_values: Iterable[bytes]) -> dict[str, Any]:
    parts = iter(names_and_values)
    fields: dict[str, Any] = {
        name.decode(): value for name, value in zip(parts, parts, strict=True)
    }
    return fields | {name: fields[name].decode() for name in _TEXTS if name in fields}
