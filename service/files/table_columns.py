"""The columns of a table: the field of a stop or vehicle that each is taken for, and its cells."""

import re
from dataclasses import dataclass

from service.files.columns import fields_of
from service.files.reading import Column, Source, UnreadableFile, quoted
from service.files.tables import Table, number_in, plain_numbers

_DEGREES = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d{1,2})?)"
_POINT = re.compile(
    rf"(?:SRID=4326;)?\s*POINT\s*Z?M?\s*\(\s*{_DEGREES}\s+{_DEGREES}(?:\s+{_DEGREES}){{0,2}}\s*\)",
    re.ASCII | re.IGNORECASE,
)
# As web maps show a place: latitude first.
_PAIR = re.compile(rf"\(?\s*{_DEGREES}°?\s*,\s*{_DEGREES}°?\s*\)?", re.ASCII | re.IGNORECASE)
_INDEX = ("", "index", "unnamed: 0")


@dataclass
class Columns:
    """The columns of a table, with the field that each is taken for."""

    source: Source
    table: Table
    names: list[str]
    fields: list[str | None]

    def find(self, field: str) -> int | None:
        """Return the column that is taken for a field, or None."""
        return self.fields.index(field) if field in self.fields else None

    def text(self, row: int, column: int) -> str:
        """Return a field."""
        return self.table.rows[row][1][column]

    def where(self, row: int, column: int) -> str:
        """Return the position of a field, for sentences."""
        return f"row {self.table.rows[row][0]}, column {quoted(self.names[column])}"

    def refusal(self, row: int, column: int, demand: str, *came: object) -> UnreadableFile:
        """Return the exception that says what a field must be, and quotes what came instead."""
        return self.source.refusal(f"{self.where(row, column)} {demand}", *came)

    def leave_out(self, field: str, when: str = "") -> None:
        """Note that a column, if there is one for a field, is not used."""
        if (at := self.find(field)) is not None:
            self.fields[at] = None
            self.source.note_left_out(quoted(self.names[at]) + when)

    def number(self, row: int, column: int) -> float:
        """Return the number in a field.

        Raises:
            UnreadableFile: The field is not a number.
        """
        text = self.text(row, column)
        number = number_in(text)
        if number is None:
            raise self.refusal(row, column, "must be a number", text)
        return number

    def numbers(self, columns: list[int]) -> list[list[float]]:
        """Return the numbers of columns, row by row."""
        rows = enumerate(self.table.rows)
        return [
            plain_numbers([texts[at] for at in columns]) or [self.number(row, at) for at in columns]
            for row, (_, texts) in rows
        ]

    def are_numbers(self, column: int) -> bool:
        """Return whether all fields of a column are numbers."""
        return all(number_in(row[column]) is not None for _, row in self.table.rows)

    def tell(self) -> None:
        """If there is a heading, note what each column is taken for."""
        if self.table.heading is None:
            return
        told = [
            Column(name[:200], each or "ignored")
            for name, each in zip(self.names, self.fields, strict=True)
        ]
        self.source.columns.extend(told)
        used = [
            f"{quoted(each.name)} ({each.taken_for})"
            for each in told
            if each.taken_for != "ignored"
        ]
        unused = [quoted(each.name) for each in told if each.taken_for == "ignored"]
        not_used = f" Not used: {', '.join(unused)}." if unused else ""
        self.source.note("columns", f"Columns were taken for: {', '.join(used)}.{not_used}"[:1000])


def columns_of(source: Source, table: Table) -> Columns:
    """Return the columns of a table, recognised by its heading or by their contents."""
    names = table.heading or [f"{number}" for number in range(1, table.width + 1)]
    fields: list[str | None] = fields_of(names) if table.heading else [None] * table.width
    columns = Columns(source, table, names, fields)
    for at in range(table.width):
        if fields[at] in (None, "place"):
            fields[at] = _place_column(columns, at)
    if "id" not in fields and fields[0] is None and table.width > 1:
        first = table.rows[0][1][0]
        # Without a heading, or if a square of costs has named rows, the first row decides.
        named = table.heading is None or len(table.rows) == table.width - 1
        if (named and number_in(first) is None) or _is_index(table):
            fields[0] = "id"
    return columns


def _place_column(columns: Columns, at: int) -> str | None:
    """Return `place` for a column of points in WKT, or of pairs under such a heading; else None."""
    texts = [row[at] for _, row in columns.table.rows]
    if all(map(_POINT.fullmatch, texts)):
        return "place"
    located = {"longitude", "latitude"} <= set(columns.fields)
    paired = columns.fields[at] == "place" and all("." in text for text in texts)
    if located or not paired or not all(map(_PAIR.fullmatch, texts)):
        return None
    name = quoted(columns.names[at])
    columns.source.note("place", f"{name} is taken to be latitude, then longitude.")
    return "place"


def place_in(text: str) -> list[float]:
    """Return the longitude and latitude in a point of WKT, or in a pair, latitude first."""
    if point := _POINT.fullmatch(text):
        return [float(each) for each in point.group(1, 2)]
    pair = _PAIR.fullmatch(text)
    assert pair is not None
    return [float(each) for each in pair.group(2, 1)]


def _is_index(table: Table) -> bool:
    """Return whether the first column is the index that pandas writes, or names of rows."""
    return table.heading is not None and table.heading[0].strip().casefold() in _INDEX


def ids_of(columns: Columns) -> list[str]:
    """Return the id of each row.

    Raises:
        UnreadableFile: An id is missing, or comes twice.
    """
    at = columns.fields.index("id")
    seen: dict[str, int] = {}
    for row, (number, texts) in enumerate(columns.table.rows):
        name = " ".join(texts[at].split())
        if not name:
            raise columns.refusal(row, at, "must be an id, got none")
        if name in seen:
            came = f"got {quoted(name)} as in row {seen[name]}"
            raise columns.refusal(row, at, f"must be an id that no other row has, {came}")
        seen[name] = number
    return list(seen)
