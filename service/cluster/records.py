"""Records as Redis keeps them: fields of hashes, and one script for all that is done with them."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from service.columns import WORK, columns, record_of
from service.record import Record

SCRIPT = (Path(__file__).parent / "records.lua").read_text()
Argument = str | bytes | float

_TEXTS = ("id", "caller", "request_id", "status", "key", "digest", "kind")


def arguments(record: Record) -> list[Argument]:
    """A record for the script: how many arguments are its fields, these, and those of its work."""
    given = {name: value for name, value in columns(record).items() if value is not None}
    work = flat({name: given.pop(name) for name in WORK if name in given})
    fields = flat(given)
    return [len(fields), *fields, *work]


def flat(fields: Mapping[str, Argument]) -> list[Argument]:
    """Names and values in turn, as Redis takes them."""
    return [part for field in fields.items() for part in field]


def fields(flat: Iterable[bytes]) -> dict[str, Any]:
    """What Redis gives as names and values in turn."""
    parts = iter(flat)
    found: dict[str, Any] = {name.decode(): value for name, value in zip(parts, parts, strict=True)}
    return found | {name: found[name].decode() for name in _TEXTS if name in found}


def record_in(*hashes: Iterable[bytes]) -> Record:
    """The record in one hash, or in one and that of its work."""
    return record_of({name: value for each in hashes for name, value in fields(each).items()})
