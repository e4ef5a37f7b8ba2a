"""Read the files that cities and maps come in, as members of a request."""

import csv
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from service.cli.errors import UnreadableFile
from service.cli.tsplib import parse_coordinates, parse_matrix

Array = NDArray[np.float64]
Request = dict[str, Any]
T = TypeVar("T")
_TSPLIB = (".tsp", ".atsp")


def read_request(files: Sequence[Path], *, unrounded: bool = False) -> Request:
    """Return the request in one file, or in two, with one objective each.

    One file is JSON, a request or its coordinates alone, or CSV, with four numbers for each city.
    Two files are CSV, with two columns for cities in a plane or else a matrix of costs; or they
    are TSPLIB's, which become matrices, or coordinates if `unrounded`.

    Raises:
        UnreadableFile: A file is none of these; the message names it.
        OSError: There is no such file.
    """
    if len(files) == 1:
        return _read(files[0], _read_cities)
    first, second = (_read(file, lambda path: _read_objective(path, unrounded)) for file in files)
    if first.shape != second.shape:
        sizes = " and ".join("x".join(map(str, array.shape)) for array in (first, second))
        raise UnreadableFile(f"both files must have as many numbers, got {sizes}")
    if first.shape[1] == 2:
        return {"coordinates": np.concatenate((first, second), axis=1).tolist()}
    return {"matrices": np.stack((first, second))}


def read_map(path: Path) -> tuple[Request, bytes | None]:
    """Return the request in a JSON file, or an empty one and the content of a PNG file.

    Raises:
        UnreadableFile: The file is neither; the message names it.
        OSError: There is no such file.
    """
    if path.suffix == ".png":
        return {}, path.read_bytes()
    return _read(path, lambda path: _parse_json(path.read_text())), None


def read_layer(path: Path) -> Array:
    """Return the costs on a map in a CSV file, a row for each row of its cells.

    Raises:
        UnreadableFile: The file is no table of numbers; the message names it.
        OSError: There is no such file.
    """
    return _read(path, _read_table)


def _read(path: Path, read: Callable[[Path], T]) -> T:
    """Return what a function reads from a file, with the file's name in its errors."""
    try:
        return read(path)
    except (UnreadableFile, UnicodeDecodeError) as error:
        raise UnreadableFile(f"{path}: {error}") from None


def _read_cities(path: Path) -> Request:
    """Return the request in a file that holds both objectives."""
    if path.suffix in _TSPLIB:
        raise UnreadableFile("a file of TSPLIB is one objective: name another for the other one")
    if path.suffix == ".json":
        return _parse_json(path.read_text())
    rows = _read_table(path)
    if rows.shape[1] != 4:
        raise UnreadableFile(f"must have 4 columns, x and y in either plane, got {rows.shape[1]}")
    return {"coordinates": rows.tolist()}


def _parse_json(text: str) -> Request:
    """Return the request that a text is, or whose coordinates it is."""
    try:
        value = json.loads(text)
    except json.JSONDecodeError as error:
        raise UnreadableFile(f"must be JSON: {error}") from None
    if isinstance(value, list):
        return {"coordinates": value}
    if isinstance(value, dict):
        return value
    raise UnreadableFile("must be a request, an object, or its coordinates, a list")


def _read_objective(path: Path, unrounded: bool) -> Array:
    """Return the cities in a plane, shape (n, 2), or the costs between them, shape (n, n)."""
    if path.suffix in _TSPLIB:
        return (parse_coordinates if unrounded else parse_matrix)(path.read_text())
    rows = _read_table(path)
    if rows.shape[1] not in (2, len(rows)):
        demand = "must have 2 columns, x and y, or as many as rows"
        raise UnreadableFile(f"{demand}, got {len(rows)} rows of {rows.shape[1]}")
    return rows


def _read_table(path: Path) -> Array:
    """Return the numbers of a CSV file, whose first line may be a heading."""
    lines = path.read_text(encoding="utf-8-sig").splitlines()
    separator = next((character for character in ";\t" if lines and character in lines[0]), ",")
    rows = csv.reader(lines, delimiter=separator)
    table = [(number, row) for number, row in enumerate(rows, 1) if row]
    if table and not any(_is_number(field) for field in table[0][1]):
        del table[0]
    if not table:
        raise UnreadableFile("must have a row of numbers for each city, got none")
    for number, row in table:
        _check_row(number, row, len(table[0][1]))
    return np.array([row for _, row in table], dtype=np.float64)


def _check_row(number: int, row: list[str], width: int) -> None:
    """Raise UnreadableFile if a line has fields that are not numbers, or not so many."""
    if len(row) != width:
        raise UnreadableFile(
            f"line {number} must have {width} fields, as the first row, got {len(row)}"
        )
    for field in row:
        if not _is_number(field):
            raise UnreadableFile(f"line {number} must hold numbers, got {field[:80]!r}")


def _is_number(field: str) -> bool:
    try:
        return bool(np.isfinite(float(field)))
    except ValueError:
        return False
