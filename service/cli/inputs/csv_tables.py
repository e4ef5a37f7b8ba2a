"""Parse a table of numbers in CSV, with the ids of its rows where it has them."""

import csv
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.cli.errors import UnreadableFile

Array = NDArray[np.float64]
Ids = tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """The numbers of a table, shape (rows, columns), and the id of each row or None."""

    numbers: Array
    ids: Ids | None = None


def parse_table(text: str) -> Table:
    """Return the table in a text, whose first line may be a heading.

    Fields are separated by commas, or by semicolons or tabs; then a comma in a number is a decimal
    point. The first column holds ids where its heading is `id`, or where it is the one that holds
    no number in the first row.

    Raises:
        UnreadableFile: A field is no number, a row has other columns than the first, or an id is
            missing or comes twice.
    """
    lines = text.removeprefix("\ufeff").splitlines()
    separator = next((character for character in ";\t" if lines and character in lines[0]), ",")
    read = csv.reader(lines, delimiter=separator)
    try:
        rows = [(number, row) for number, row in enumerate(read, 1) if row]
    except csv.Error as error:
        raise UnreadableFile(f"must be CSV: {error}") from None
    heading: list[str] = []
    if rows and (_is_id(rows[0][1]) or not any(map(_is_number, _dotted(rows[0][1], separator)))):
        heading = rows.pop(0)[1]
    if not rows:
        raise UnreadableFile("must have a row of numbers for each city, got none")
    first = rows[0][1]
    for number, row in rows:
        if len(row) != len(first):
            demand = f"line {number} must have {len(first)} fields, as the first row"
            raise UnreadableFile(f"{demand}, got {len(row)}")
    dotted = [_dotted(row, separator) for _, row in rows]
    named = _is_id(heading) or [*map(_is_number, dotted[0])] == [False, *[True] * (len(first) - 1)]
    for (number, _), row in zip(rows, dotted, strict=True):
        _check_numbers(number, row[named:])
    numbers = np.array([row[named:] for row in dotted], dtype=np.float64)
    return Table(numbers, _ids(rows) if named and len(first) > 1 else None)


def _is_id(heading: list[str]) -> bool:
    """Return whether the first column of a heading is that of ids."""
    return bool(heading) and heading[0].strip().casefold() == "id"


def _dotted(row: list[str], separator: str) -> list[str]:
    """Return the fields of a row, with points for decimal commas."""
    if separator == ",":
        return row
    return [field if "." in field else field.replace(",", ".") for field in row]


def _ids(rows: list[tuple[int, list[str]]]) -> Ids:
    """Return the first field of each row.

    Raises:
        UnreadableFile: One is empty, or like another.
    """
    seen: dict[str, int] = {}
    for number, row in rows:
        name = row[0].strip()
        if not name:
            raise UnreadableFile(f"line {number} must begin with an id, got none")
        if name in seen:
            demand = f"line {number} must have an id of its own"
            raise UnreadableFile(f"{demand}, got {name[:80]!r} as line {seen[name]} has it")
        seen[name] = number
    return tuple(seen)


def _check_numbers(number: int, row: list[str]) -> None:
    """Raise UnreadableFile if a line has fields that are not numbers."""
    for field in row:
        if not _is_number(field):
            raise UnreadableFile(f"line {number} must hold numbers, got {field[:80]!r}")


def _is_number(field: str) -> bool:
    try:
        return math.isfinite(float(field))
    except ValueError:
        return False
