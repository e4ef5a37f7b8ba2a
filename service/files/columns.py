"""The columns of a table, and the fields of stops or vehicles that they are taken for."""

import re
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from service.errors.printable import printable, shortened
from service.files.cells.dates import Calendar, are_days
from service.files.cells.ids import are_names, is_list_of_cities, numbered
from service.files.cells.signs import decimals_of, is_number, is_numeric, with_plain_numbers
from service.files.cells.totals import is_total, is_total_of_vehicles, without_totals
from service.files.chosen import DETAIL, IGNORED, chosen_fields, without_unused
from service.files.column_names import (
    NAMES_OF_STOPS,
    NAMES_OF_VEHICLES,
    PLANES,
    best_fields,
    fields_of,
    is_about_vehicles,
    plain_name,
)
from service.files.reading import LONGEST_NAME, ColumnItem, Source, WrongCell, quoted
from service.files.tables import ColumnLeftOut, Table, number_in, plain_numbers

Read = TypeVar("Read")
_DEGREES = r"([-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[-+]?\d{1,2})?)"
_POINT = re.compile(
    rf"(?:SRID=4326;)?\s*POINT\s*Z?M?\s*\(\s*{_DEGREES}\s+{_DEGREES}(?:\s+{_DEGREES}){{0,2}}\s*\)",
    re.ASCII | re.IGNORECASE,
)
# As web maps show a place: latitude first.
_PAIR = re.compile(rf"\(?\s*{_DEGREES}°?\s*,\s*{_DEGREES}°?\s*\)?", re.ASCII | re.IGNORECASE)
_UNUSED = (DETAIL, IGNORED)
_HAS_DIGITS = re.compile(r"\d")
_OF_PLACES = ("point", "location", "position")  # which may have names
_INDEX = ("", "index", "unnamed: 0")
_MOST_DETAILS = 10  # columns
_MOST_NAMED = 20  # columns in a note
_LONGEST_DETAIL = 200  # characters of a text


@dataclass
class Columns:
    """The columns of a table, with the field that each is taken for.

    `hours` are the columns of times whose numbers are hours of the day, as 8 or 8.30; each with
    whether decimals are parts of an hour, as in 8.5, and not minutes. `units` are the seconds of
    the usual unit of columns whose headings have none. `on_earth` says that the places of the
    stops are, so that times are seconds.
    """

    source: Source
    table: Table
    names: list[str]
    fields: list[str | None]
    hours: dict[int, bool] = field(default_factory=dict)
    units: dict[int, float] = field(default_factory=dict)
    calendar: Calendar = field(default_factory=Calendar)
    on_earth: bool = False
    _ids: list[str] | None = None
    of_stops: bool = True

    def find(self, field: str) -> int | None:
        """Return the column that is taken for a field, or None."""
        return self.fields.index(field) if field in self.fields else None

    def is_chosen(self, column: int) -> bool:
        """Return whether a person has chosen the field of a column."""
        return self.names[column][:LONGEST_NAME] in self.source.file.chosen

    def text(self, row: int, column: int) -> str:
        """Return a field."""
        return self.table.rows[row][1][column]

    def refuse(self, row: int, at: int, code: str, /, **values: object) -> WrongCell:
        """Return the exception that says what a field must be.

        The source keeps it as well: all wrong fields are refused together.
        """
        number = self.table.rows[row][0]
        fault = self.source.fault(code, row=number, column=self.names[at], **values)
        return self.source.refuse_cell(number, at, fault)

    def are_whole_days(self, column: int) -> bool:
        """Return whether all dates of a column are at midnight, so that they have no times."""
        return (self.source.name, self.names[column]) in self.calendar.whole_days

    def tried(self, instead: Read, read: Callable[..., Read], *arguments: object) -> Read:
        """Return what a function reads from fields, or `instead` if one of them is wrong."""
        try:
            return read(*arguments)
        except WrongCell:
            return instead

    def leave_out(self, field: str, when: str = "") -> None:
        """Note that a column, if there is one for a field, is not used."""
        if (at := self.find(field)) is not None:
            self.fields[at] = None
            self.source.note_left_out(quoted(self.names[at]) + when)

    def filled(self, column: int) -> list[int]:
        """Return the rows in which a column has text."""
        return [row for row in range(len(self.table.rows)) if self.text(row, column)]

    def values(
        self, field: str, read: Callable[[int, int], Read], instead: Read | None = None
    ) -> Iterator[tuple[int, Read]]:
        """Yield the rows in which the column of a field has text, with what is read there.

        Rows whose text is wrong have `instead`, or are left out without it.
        """
        if (at := self.find(field)) is not None:
            for row in self.filled(at):
                value = self.tried(instead, read, row, at)
                if value is not None:
                    yield row, value

    def number(self, row: int, column: int) -> float:
        """Return the number in a field.

        Raises:
            UnreadableFile: The field is not a number.
        """
        text = self.text(row, column)
        number = number_in(text)
        if number is None:
            raise self.refuse(row, column, "no-number", came=text)
        return number

    def amount(self, row: int, column: int) -> float:
        """Return the number in a field, which must not be negative."""
        number = self.number(row, column)
        if number < 0:
            raise self.refuse(row, column, "negative", came=number)
        return number

    def whole(self, row: int, column: int) -> int:
        """Return the whole number from 1 in a field."""
        number = self.number(row, column)
        if number < 1 or not number.is_integer():
            raise self.refuse(row, column, "no-count", came=self.text(row, column))
        return int(number)

    def read_signs(self, columns: Sequence[int] = ()) -> None:
        """Rewrite numbers with decimal points and without thousands signs.

        Args:
            columns: Columns of numbers whose fields do not say that they are.

        Raises:
            UnreadableFile: The numbers of a column allow two readings.
        """
        fields = [field or ("x" if at in columns else None) for at, field in enumerate(self.fields)]
        self.source.signs.own |= decimals_of(self.table, fields)
        numeric = [at for at, field in enumerate(fields) if is_numeric(field)]
        self.table = with_plain_numbers(self.source, self.table, fields, numeric)

    def numbers(self, columns: list[int]) -> list[list[float]]:
        """Return the numbers of columns, row by row; 0 in place of wrong ones."""
        return [
            plain_numbers([texts[at] for at in columns])
            or [self.tried(0.0, self.number, row, at) for at in columns]
            for row, (_, texts) in enumerate(self.table.rows)
        ]

    def are_numbers(self, column: int) -> bool:
        """Return whether all fields of a column are numbers."""
        return all(number_in(text) is not None for text in self.table.texts(column))

    def have_numbers(self, column: int) -> bool:
        """Return whether any field of a column is a number, with any signs."""
        return any(map(is_number, self.table.texts(column)))

    def listed(self) -> list[ColumnItem]:
        """Return what each column in the file is taken for."""
        file = self.source.name
        return [ColumnItem(file, name[:LONGEST_NAME], field) for name, field, _ in self._placed()]

    def _placed(self) -> list[ColumnLeftOut]:
        """Return all columns in the order of the file; the texts only of those that are not used.

        Of a table of stops, up to ten unused columns that have a name and texts are details: those
        that were chosen to be, then the first others.
        """
        placed = [
            ColumnLeftOut(name, field or "", [] if field else self.table.texts(at))
            for at, (name, field) in enumerate(zip(self.names, self.fields, strict=True))
        ]
        for at, column in sorted(self.table.left_out.items()):
            placed.insert(at, column)
        unused = [at for at, each in enumerate(placed) if each.taken_for in ("", DETAIL)]
        told = [at for at in unused if placed[at].name and any(placed[at].texts) and self.of_stops]
        told.sort(key=lambda at: placed[at].taken_for != DETAIL)
        for at in unused:
            field = DETAIL if at in told[:_MOST_DETAILS] else IGNORED
            placed[at] = placed[at]._replace(taken_for=field)
        return placed

    def ids(self) -> list[str]:
        """Return the id of each row. Those that are missing, or come twice, are kept as wrong.

        Names of stops that are missing or come twice are numbered, with a note.
        """
        if self._ids is None:
            at = self.fields.index("id")
            names = [" ".join(text.split()) for text in self.table.texts(at)]
            if self.of_stops and not self.is_chosen(at) and are_names(self.names[at]):
                self._ids = numbered(self.source, self.names[at], names)
            else:
                self._check_ids(names, at)
                self._ids = names
        return self._ids

    def _check_ids(self, ids: Sequence[str], at: int) -> None:
        """Keep ids that are missing, or come twice, as wrong."""
        seen: dict[str, int] = {}
        for row, name in enumerate(ids):
            if not name:
                self.refuse(row, at, "no-id")
            elif name in seen:
                self.refuse(row, at, "same-id", came=name, first=seen[name])
            else:
                seen[name] = self.table.rows[row][0]

    @property
    def are_any_chosen(self) -> bool:
        """Return whether a person has chosen a field for any column."""
        return bool(self.source.file.chosen)

    def keep(self, fields: Collection[str], why: str) -> None:
        """Take no column for any other field than these and ids, and note those that were."""
        for at, taken_for in enumerate(self.fields):
            if taken_for is not None and taken_for not in fields and taken_for != "id":
                self.fields[at] = None
                name = quoted(self.names[at])
                self.source.note("left-out", f"{name} was not used as {taken_for}: {why}.")

    def leave_free(self, columns: Collection[int]) -> None:
        """Take no column but these for a field, apart from that of ids."""
        for at, taken_for in enumerate(self.fields):
            if at not in columns and taken_for != "id":
                self.fields[at] = None

    def report(self) -> None:
        """Note what each column is taken for, unless none has a name and all are used."""
        if self.table.heading is None and None not in self.fields and not self.are_any_chosen:
            return
        self.source.columns.extend(self.listed())
        self._report_details()
        pairs = [(each.name, each.taken_for) for each in self.source.columns]
        used = [f"{quoted(name)} ({field})" for name, field in pairs if field not in _UNUSED]
        unused = [quoted(name) for name, field in pairs if field in _UNUSED]
        not_used = f" Not used: {shortened(unused, _MOST_NAMED)}." if unused else ""
        text = f"Columns were taken for: {shortened(used, _MOST_NAMED)}.{not_used}"
        self.source.note("columns", text)
        for at, taken_for in enumerate(self.fields):
            if taken_for is None and are_days(self.table.texts(at)):
                name = quoted(self.names[at])
                text = f"{name} has several dates, which were not used: all is of one day."
                self.source.note("dates", text)

    def _report_details(self) -> None:
        """Add the texts of details to the source, by the ids of their stops or their numbers."""
        count = len(self.table.rows)
        ids = self.ids() if "id" in self.fields else [f"{row + 1}" for row in range(count)]
        for name, taken_for, texts in self._placed():
            if taken_for == DETAIL:
                short = [printable(" ".join(text.split()))[:_LONGEST_DETAIL] for text in texts]
                by_id = dict(zip(ids, short, strict=True))
                self.source.details.append((printable(name)[:LONGEST_NAME], by_id))


def columns_of(source: Source, table: Table) -> Columns:
    """Return the columns of a table, as chosen, or recognised by its heading or their contents.

    Without a heading, columns are called by their numbers from 1.

    Raises:
        UnreadableFile: The columns cannot be taken for what was chosen.
    """
    source.check_rows(len(table.rows))
    table = without_unused(source, table, (*NAMES_OF_STOPS, *PLANES[2:], DETAIL))
    names = table.heading or table.numbered
    chosen = chosen_fields(source.file, names)
    fields: list[str | None] = [*chosen]
    if table.heading:
        fields = fields_of(names, chosen)
        table = without_totals(source, table, lambda rows: is_total(rows, fields))
    columns = Columns(source, table, names, fields)
    source.supposed.extend(columns.listed())
    columns.read_signs()
    for at in range(table.width):
        if chosen[at] == "place":
            _check_places(columns, at)
        elif fields[at] in (None, "place"):
            fields[at] = _place_column(columns, at)
    if not any(chosen):
        _name_rows(columns)
    if "id" not in fields and fields[0] is None and table.width > 1:
        first = table.rows[0][1][0]
        # Without a heading, or if a square of costs has named rows, the first row decides.
        named = table.heading is None or len(table.rows) == table.width - 1
        if (named and number_in(first) is None) or _is_index(table):
            fields[0] = "id"
    return columns


def _place_column(columns: Columns, at: int) -> str | None:
    """Return `place` for a column of points in WKT, or of pairs under such a heading; else None."""
    texts = columns.table.texts(at)
    if all(map(_POINT.fullmatch, texts)):
        return "place"
    if columns.fields[at] != "place":
        return None
    located = {"longitude", "latitude"} <= set(columns.fields)
    paired = all("." in text for text in texts)
    if located or not paired or not all(map(_PAIR.fullmatch, texts)):
        return None
    name = quoted(columns.names[at])
    columns.source.note("place", f"{name} is taken to be latitude, then longitude.")
    return "place"


def _name_rows(columns: Columns) -> None:
    """Take a column of places for ids if it has names, and cities only if they are all it has.

    Amounts without a digit, such as the names of goods, are none.
    """
    fields, table = columns.fields, columns.table
    texts = [table.texts(at) for at in range(table.width)]
    at = columns.find("id")
    if at is not None and plain_name(columns.names[at]) == "city":
        others = [texts[each] for each in range(table.width) if fields[each] is None]
        fields[at] = "id" if is_list_of_cities(texts[at], others) else None
    for at in (at for at, taken_for in enumerate(fields) if taken_for in ("demand", "pickup")):
        if any(texts[at]) and not _HAS_DIGITS.search("".join(texts[at])):
            fields[at] = None  # such as the names of goods
    for at, name in enumerate(columns.names):
        if "id" not in fields and fields[at] == "place" and all(map(str.strip, texts[at])):
            is_named = not any(map(is_number, texts[at])) and plain_name(name) in _OF_PLACES
            fields[at] = "id" if is_named and place_in(texts[at][0]) is None else fields[at]


def _check_places(columns: Columns, at: int) -> None:
    """Keep the fields of a column that are not places as wrong."""
    for row, (_, texts) in enumerate(columns.table.rows):
        if place_in(texts[at]) is None:
            columns.refuse(row, at, "not-a-point", came=texts[at])


def place_in(text: str) -> list[float] | None:
    """Return the longitude and latitude in a point of WKT, or in a pair, latitude first.

    None if the text is neither.
    """
    if point := _POINT.fullmatch(text):
        return [float(each) for each in point.group(1, 2)]
    pair = _PAIR.fullmatch(text)
    return [float(each) for each in pair.group(2, 1)] if pair else None


def _is_index(table: Table) -> bool:
    """Return whether the first column is the index that pandas writes, or names of rows."""
    return table.heading is not None and table.heading[0].strip().casefold() in _INDEX


def columns_of_vehicles(source: Source, table: Table) -> Columns:
    """Return the columns of a table of vehicles, with the field that each may be.

    Only those of loads may come several times.

    Columns `start` and `end` may be times of a shift instead: their contents decide.

    Raises:
        UnreadableFile: The columns cannot be taken for what was chosen.
    """
    table = without_unused(source, table, NAMES_OF_VEHICLES)
    table = without_totals(source, table, is_total_of_vehicles)
    names = table.heading or []
    fields = best_fields(names, NAMES_OF_VEHICLES, chosen_fields(source.file, names))
    columns = Columns(source, table, names, fields, of_stops=False)
    source.supposed.extend(columns.listed())
    columns.read_signs()
    return columns


def share_signs(tables: Sequence[tuple[Source, Table]]) -> None:
    """Let the decimal signs of each table of a request be known to all of them."""
    for source, table in tables:
        heading = table.heading or [""] * table.width
        names = NAMES_OF_VEHICLES if is_about_vehicles(heading) else NAMES_OF_STOPS
        source.signs.own |= decimals_of(table, best_fields(heading, names))
    known = {sign for source, _ in tables for sign in source.signs.own}
    for source, _ in tables:
        source.signs.of_request |= known
