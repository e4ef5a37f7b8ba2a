"""Files that say what is to be planned, as the members of a request."""

import csv
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from service.cli import tsplib
from service.cli.tsplib import UnreadableFile

Array = NDArray[np.float64]
Request = dict[str, Any]
T = TypeVar("T")
_TSPLIB = (".tsp", ".atsp")


def read_request(files: Sequence[Path], *, unrounded: bool = False) -> Request:
    """What one file says, or two that say it for one objective each.

    One is JSON, a request or its coordinates alone, or CSV, with four numbers for each city. Two
    are CSV, with two columns where cities lie in a plane and else a matrix of costs, or TSPLIB's,
    which become matrices, or where `unrounded` asks for it coordinates.

    Raises:
        UnreadableFile: nothing of that kind; the message names the file.
        OSError: no such file.
    """
    if len(files) == 1:
        return _read(files[0], _request)
    first, second = (_read(file, lambda path: _objective(path, unrounded)) for file in files)
    if first.shape != second.shape:
        sizes = " and ".join("x".join(map(str, array.shape)) for array in (first, second))
        raise UnreadableFile(f"both files must have as many numbers, got {sizes}")
    if first.shape[1] == 2:
        return {"coordinates": np.concatenate((first, second), axis=1).tolist()}
    return {"matrices": np.stack((first, second))}


def read_map(path: Path) -> tuple[Request, bytes | None]:
    """What a JSON file says, a request with its grid; or nothing, and the content of a PNG file.

    Raises:
        UnreadableFile: neither; the message names the file.
        OSError: no such file.
    """
    if path.suffix == ".png":
        return {}, path.read_bytes()
    return _read(path, lambda path: _json(path.read_text())), None


def read_layer(path: Path) -> Array:
    """The costs on a map, as many as it has cells, from a CSV file.

    Raises:
        UnreadableFile: it is none; the message names the file.
        OSError: no such file.
    """
    return _read(path, _table)


def _read(path: Path, read: Callable[[Path], T]) -> T:
    try:
        return read(path)
    except (UnreadableFile, UnicodeDecodeError) as error:
        raise UnreadableFile(f"{path}: {error}") from None


def _request(path: Path) -> Request:
    if path.suffix in _TSPLIB:
        raise UnreadableFile("a file of TSPLIB is one objective: name another for the other one")
    if path.suffix == ".json":
        return _json(path.read_text())
    rows = _table(path)
    if rows.shape[1] != 4:
        raise UnreadableFile(f"must have 4 columns, x and y in either plane, got {rows.shape[1]}")
    return {"coordinates": rows.tolist()}


def _json(text: str) -> Request:
    try:
        value = json.loads(text)
    except json.JSONDecodeError as error:
        raise UnreadableFile(f"must be JSON: {error}") from None
    if isinstance(value, list):
        return {"coordinates": value}
    if isinstance(value, dict):
        return value
    raise UnreadableFile("must be a request, an object, or its coordinates, a list")


def _objective(path: Path, unrounded: bool) -> Array:
    """Where the cities lie in a plane, shape (n, 2), or what the ways cost, shape (n, n)."""
    if path.suffix in _TSPLIB:
        return (tsplib.coordinates if unrounded else tsplib.matrix)(path.read_text())
    rows = _table(path)
    if rows.shape[1] not in (2, len(rows)):
        demand = "must have 2 columns, x and y, or as many as rows"
        raise UnreadableFile(f"{demand}, got {len(rows)} rows of {rows.shape[1]}")
    return rows


def _table(path: Path) -> Array:
    """The numbers of a CSV file, whose first line may be a heading."""
    lines = path.read_text(encoding="utf-8-sig").splitlines()
    between = next((each for each in ";\t" if lines and each in lines[0]), ",")
    table = [(at, row) for at, row in enumerate(csv.reader(lines, delimiter=between), 1) if row]
    if table and not any(_is_number(field) for field in table[0][1]):
        del table[0]
    if not table:
        raise UnreadableFile("must have a row of numbers for each city, got none")
    for at, row in table:
        _check_row(at, row, len(table[0][1]))
    return np.array([row for _, row in table], dtype=np.float64)


def _check_row(at: int, row: list[str], width: int) -> None:
    if len(row) != width:
        raise UnreadableFile(
            f"line {at} must have {width} fields, as the first row, got {len(row)}"
        )
    for field in row:
        if not _is_number(field):
            raise UnreadableFile(f"line {at} must hold numbers, got {field[:80]!r}")


def _is_number(field: str) -> bool:
    try:
        return bool(np.isfinite(float(field)))
    except ValueError:
        return False
