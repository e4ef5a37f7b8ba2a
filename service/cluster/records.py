"""The form of a record in Redis: the fields of its hashes.

Replicas and workers of different releases share one Redis. The names of fields and stop reasons,
the columns in `jobs.store` and the keys in `stored_records.lua` therefore stay as they are.
"""

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, cast

from pydantic_core import to_json

from service.errors import Cancelled, DeadlineExceeded
from service.jobs.engine import JobState
from service.jobs.listing import ListedFront
from service.jobs.outbox import Delivery
from service.jobs.record import Record, Status, StopReason
from service.jobs.store import (
    TASK_COLUMNS,
    UnreadableRecord,
    front_columns,
    listed_from,
    record_columns,
    record_from,
    task_from,
)
from service.kinds.front_document import FrontDocument
from service.watch import Progress

# Fields beside the columns. The script sets the first two.
REQUESTED_AT = "kept"  # seconds since 1970
ATTEMPTS = "attempts"
PROCESS = "process"  # the id of the process that plans, on the machine of the worker
GAINED = "gained"
PROGRESS = "progress"
CLIENT = "client"
WEBHOOK = "webhook"

STOP_REASONS: Mapping[StopReason, bytes] = {Cancelled: b"Stopped", DeadlineExceeded: b"Overdue"}
REASON_OF = {name: reason for reason, name in STOP_REASONS.items()}
TAKEN_OVER = b"taken"

Argument = str | bytes | float  # of the script
_TEXTS = ("id", "caller", "request_id", "status", "key", "digest", "kind", CLIENT, WEBHOOK)


@dataclass(frozen=True, eq=False, kw_only=True)
class StoredRecord(JobState):
    """A record as it stands in Redis. `requested_at` is in seconds since 1970."""

    requested_at: float
    attempts: int


def record_arguments(record: Record) -> list[Argument]:
    """Return a record as arguments of the script.

    They are the number of arguments for its hash, these arguments, and those for the hash of its
    task.
    """
    columns = {name: value for name, value in record_columns(record).items() if value is not None}
    task = {name: columns.pop(name) for name in TASK_COLUMNS if name in columns}
    if record.front.gained is not None:
        columns[GAINED] = record.front.gained
    if record.client:
        columns[CLIENT] = record.client
    if record.webhook is not None:
        columns[WEBHOOK] = record.webhook.json()
    fields = _names_and_values(columns)
    return [len(fields), *fields, *_names_and_values(task)]


def report_arguments(
    process: int | None, progress: Progress | None, front: FrontDocument | None
) -> list[Argument]:
    """Return the fields that a worker's report changes, as arguments of the script."""
    fields: dict[str, Argument] = {} if front is None else {**front_columns(front)}
    if progress is not None:
        fields[PROGRESS] = to_json(asdict(progress))
    return _names_and_values({**fields, PROCESS: process or ""})


def stored_record(*hashes: Iterable[bytes]) -> StoredRecord:
    """Return the record in a hash, and optionally that of its task, as HGETALL gives them.

    Raises:
        UnreadableRecord: They are damaged, or of another program.
    """
    try:
        return _decode(*hashes)
    except (ArithmeticError, LookupError, TypeError, ValueError) as error:
        raise UnreadableRecord(f"{type(error).__name__}: {error}"[:200]) from error


def listed_front(row: Iterable[bytes], members: bytes) -> ListedFront:
    """Return what a list says of a record: its id, number, time and status, and its members.

    Raises:
        UnreadableRecord: They are damaged, or of another program.
    """
    try:
        id_, number, kept, status = (each.decode() for each in row)
        return listed_from(int(number), float(kept), id_, cast(Status, status), members)
    except ValueError as error:
        raise UnreadableRecord(f"{type(error).__name__}: {error}"[:200]) from error


def stored_task(task: Iterable[bytes]) -> bytes | None:
    """Return the task in a hash, as HGETALL gives it; None where it is empty or damaged."""
    try:
        return task_from(_fields(task))
    except ValueError:
        return None


def delivery_from(parts: Iterable[bytes]) -> Delivery:
    """Return the delivery in its id, webhook, status, time of its end and number of attempts.

    Raises:
        UnreadableRecord: They are damaged.
    """
    try:
        return Delivery.read(*(each.decode() for each in parts))
    except (AttributeError, TypeError, ValueError) as error:
        raise UnreadableRecord(f"{type(error).__name__}: {error}"[:200]) from error


def _decode(*hashes: Iterable[bytes]) -> StoredRecord:
    fields = {name: value for each in hashes for name, value in _fields(each).items()}
    record = replace(record_from(fields, fields.get(WEBHOOK)), client=fields.get(CLIENT, ""))
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
