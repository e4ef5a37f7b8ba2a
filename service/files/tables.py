"""Make tables of fields, with a heading or without, from CSV, XLSX and records of JSON."""

import csv
import io
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import NamedTuple

from service.files.headings import joined_heading
from service.files.plain_text import with_whole_names, without_lines
from service.files.reading import LONGEST_NAME, Source, quoted
from service.files.work import LINE_OF_TABLE

Row = tuple[int, list[str]]  # the number of a row, as a spreadsheet counts, and its fields
# In the order in which they are tried.
_SEPARATORS = {
    ";": "semicolons",
    "\t": "tabs",
    "|": "bars",
    ",": "commas",
    "^": "carets",
    "~": "tildes",
}
_SAMPLE = 2**16  # characters by which the separator is recognised
_SAMPLE_ROWS = 50
MOST_COLUMNS = 2**14  # as of spreadsheets
_LONG = 40  # characters of a field; white space in a longer one may be long as well
_LARGEST = 1e150  # the same limit as in requests
_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)(e[-+]?\d{1,3})?", re.ASCII | re.IGNORECASE)
_POINT = re.compile(r"(?:SRID=\d+;)?\s*POINT\s*Z?M?\s*\(\s*[-+\d.]", re.IGNORECASE)  # of WKT
_PLAIN = re.compile(r"[-+0-9.eE ]+", re.ASCII)
_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+(e[-+]?\d{1,3})?", re.ASCII | re.IGNORECASE)
_MINUS = str.maketrans({"\u2212": "-", "\u2013": "-", "\xa0": "", "\u202f": ""})


class ColumnLeftOut(NamedTuple):
    """A column that was taken out of a table: its name, what was chosen for it, and its texts."""

    name: str
    taken_for: str
    texts: list[str]


@dataclass(frozen=True)
class Table:
    """The rows of a table, all with the same number of fields, and the heading if there is one.

    `left_out` are the columns that were taken out, by their places in the file.
    """

    heading: list[str] | None
    rows: list[Row]
    left_out: Mapping[int, ColumnLeftOut] = field(default_factory=dict)

    @property
    def width(self) -> int:
        """The number of fields in each row."""
        return len(self.rows[0][1])

    def texts(self, column: int) -> list[str]:
        """Return the texts of a column."""
        return [row[column] for _, row in self.rows]

    @property
    def numbered(self) -> list[str]:
        """The numbers of columns in the file, from 1, as their names."""
        numbers = range(self.width + len(self.left_out))
        return [f"{at + 1}" for at in numbers if at not in self.left_out]


def number_in(field: str) -> float | None:
    """Return the number in a field, with a decimal point or comma; None if it is not a number."""
    text = field.translate(_MINUS)
    if _DECIMAL_COMMA.fullmatch(text):
        text = text.replace(",", ".")
    if not _NUMBER.fullmatch(text):
        return None
    number = float(text)
    return number if abs(number) <= _LARGEST else None


def plain_numbers(fields: Sequence[str]) -> list[float] | None:
    """Return the numbers of fields with decimal points, fast; None if any field is different."""
    if not _PLAIN.fullmatch(" ".join(fields)):
        return None
    try:
        numbers = list(map(float, fields))
    except ValueError:
        return None
    return numbers if all(-_LARGEST <= number <= _LARGEST for number in numbers) else None


def table_of_csv(source: Source, text: str) -> Table:
    """Return the table in CSV.

    Raises:
        UnreadableFile: It is not CSV, or has too many fields.
    """
    source.spend_on_lines(text, LINE_OF_TABLE)
    first, _, rest = text.partition("\n")
    declared = re.fullmatch(r"\s*\"?sep=(.)\"?\s*", first)
    body = without_lines(rest if declared else text)
    separator = declared[1] if declared else _separator(body)
    source.signs.separator = separator
    if separator not in (",", None):
        named = _SEPARATORS.get(separator, quoted(separator))
        source.note("separator", f"Fields are separated by {named}.")
    if separator is None:
        rows: Iterable[list[str]] = _spaced_rows(body)
    else:
        rows = _csv_rows(source, body, separator)
    return table_of(source, rows, 2 if declared else 1)


def table_of(source: Source, fields: Iterable[Sequence[str]], first: int = 1) -> Table:
    """Return the table with these rows of fields; `first` is the number of the first row.

    Rows without any text are left out, with a note, and so are titles above the heading.

    Raises:
        UnreadableFile: It has no rows, rows of different lengths, or too many fields.
    """
    return table_of_rows(source, enumerate(fields, first))


def table_of_rows(source: Source, fields: Iterable[tuple[int, Sequence[str]]]) -> Table:
    """Return the table with these rows, each with its number. See `table_of`."""
    rows: list[Row] = []
    count, empty, widest = 0, 0, 0
    for number, row in fields:
        stripped = [_stripped(field) for field in row]
        count += 1 + len(stripped)
        widest = max(widest, len(stripped))
        source.check_count("fields and rows", source.bounds.cells, count)
        if any(stripped):
            rows.append((number, stripped))
        else:
            empty += bool(stripped)
    source.check_count("columns", MOST_COLUMNS, widest)
    if empty:
        source.note("empty-rows", f"{_counted(empty)} left out.")
    if not rows:
        raise source.refusal("no-stops")
    _take_titles(source, rows)
    heading = _take_heading(source, rows)
    if heading is not None:
        heading = joined_heading(source, heading, rows)
    if not rows:
        raise source.refusal("heading-alone")
    return Table(heading, _squared(source, heading, rows))


def _stripped(field: str) -> str:
    """Return a field without white space around it; if it is long, with single spaces in it."""
    return field.strip() if len(field) <= _LONG else " ".join(field.split())


def _counted(count: int) -> str:
    return "1 row without text was" if count == 1 else f"{count} rows without text were"


def _separator(text: str) -> str | None:
    """Return the separator that splits all rows of a sample alike; None if it is white space."""
    lines = text[:_SAMPLE].splitlines()
    sample = "\n".join(lines[:_SAMPLE_ROWS] if len(text) <= _SAMPLE else lines[:-1][:_SAMPLE_ROWS])
    widths: dict[str, list[int]] = {}
    for separator in _SEPARATORS:
        rows = csv.reader(io.StringIO(sample, newline=""), delimiter=separator)
        try:
            widths[separator] = [len(row) for row in islice(rows, _SAMPLE_ROWS) if row]
        except csv.Error:
            widths[separator] = []
    for separator, found in widths.items():
        if found and found[0] > 1 and len(set(found)) == 1:
            return separator
    most = max(_SEPARATORS, key=lambda each: max(widths[each], default=0))
    return most if max(widths[most], default=0) > 1 else None


def _spaced_rows(text: str) -> Iterable[list[str]]:
    """Return rows whose fields have white space between; or of one field, if they are texts.

    They are texts, such as addresses, if each is in quotation marks, or if their numbers of words
    differ and few have two numbers.
    """
    lines = text.split("\n")
    rows = [line.split() for line in lines]
    below = [row for row in rows if row][1:]
    tabular = [row for row in below if sum(number_in(word) is not None for word in row) > 1]
    differ = len({len(row) for row in below}) > 1 and 2 * len(tabular) < len(below)
    if differ or (below and all(re.fullmatch(r'\s*("[^"]*"\s*)?', line) for line in lines[1:])):
        return ([line.strip().strip('"')] for line in lines)
    return with_whole_names(rows, lambda word: number_in(word) is not None)


def _csv_rows(source: Source, text: str, separator: str) -> Iterator[list[str]]:
    # The parser keeps a whole row before it is counted.
    source.check_count("fields", source.bounds.cells, text.count(separator))
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)
    try:
        yield from reader
    except csv.Error as error:
        raise source.refusal("not-csv", reason=str(error), line=reader.line_num) from None


def _take_titles(source: Source, rows: list[Row]) -> None:
    """Take away rows of a single text that stand above a heading of several words, with a note.

    The row below the heading must have a number, so that the words are not a row of the table.
    """
    first = next((at for at, (_, row) in enumerate(rows) if sum(map(bool, row)) > 1), 0)
    if not 0 < first < len(rows) - 1:
        return
    heading, below = (
        [number_in(field) is not None for field in row] for _, row in rows[first : first + 2]
    )
    if not any(heading) and any(below):
        titles = ", ".join(quoted("".join(row)) for _, row in rows[:first])
        source.note("title", f"Above the heading, {titles} was taken for a title and left out.")
        del rows[:first]


def _take_heading(source: Source, rows: list[Row]) -> list[str] | None:
    """Take the heading off rows that have one, and return it."""
    fields = rows[0][1]
    if _counts_up(fields):
        # A square of numbers is a matrix of costs, even if its first row counts.
        if len(rows) == len(fields) != 4 or len(fields) < 2:
            return None
        source.note("heading", "The first row counts the columns, so it is taken for a heading.")
    elif not _is_heading(fields, rows):
        return None
    return [name[:LONGEST_NAME] for name in rows.pop(0)[1]]


def _counts_up(fields: Sequence[str]) -> bool:
    """Return whether fields count from 0, as pandas writes the heading of unnamed columns."""
    numbers = fields[1:] if fields[0] == "" else fields
    return list(numbers) == [str(number) for number in range(len(numbers))]


def _is_heading(fields: Sequence[str], rows: Sequence[Row]) -> bool:
    """Return whether a row is a heading: words only, after `id`, or the same names as the rows."""
    if any(map(_POINT.match, fields[1:])):
        return any("(" in field and not _POINT.match(field) for field in fields)
    numbers = [number_in(field) is not None for field in fields]
    if not any(numbers) or fields[0].strip("#").casefold() == "id":
        return True
    labels = [row[0] for _, row in rows[1:]]
    return fields[0] == "" and len(labels) > 1 and list(fields[1:]) == labels


def _squared(source: Source, heading: list[str] | None, rows: list[Row]) -> list[Row]:
    """Return rows with as many fields as the heading, or the first row; refuse other rows.

    Any row may have more fields that are empty. Under a heading, rows may lack their last fields.
    """
    width = len(rows[0][1] if heading is None else heading)
    source.check_count("fields", source.bounds.cells, width * len(rows))
    if heading is not None and all(len(row) == width + 1 for _, row in rows):
        heading.insert(0, "")  # R writes named rows like this
        width += 1
    squared = []
    for number, row in rows:
        short = width - len(row)
        if any(row[width:]) or (short > 0 and heading is None):
            code = "row-of-one" if width == 1 else "other-fields"
            raise source.refusal(code, row=number, fields=width, came=len(row))
        squared.append((number, row[:width] + [""] * short))
    return squared
