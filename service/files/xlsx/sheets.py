"""Choose the sheets of a spreadsheet that are planned, and return their rows, with notes."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from service.errors.printable import shortened
from service.files.column_names import fields_of, is_about_vehicles
from service.files.reading import Source, UnreadableFile, quoted
from service.files.tables import Row, Table, number_in, table_of_rows
from service.files.xlsx.sheet import MOST_COLUMNS, Sheet, letters_of
from service.files.xlsx.workbook import Listed, Workbook

_MOST_SHEETS = 100  # that are looked into
_MOST_NAMED = 3
_LEAST_NUMBERS = 2  # columns of a table without a heading
_PLACES = ({"longitude", "latitude"}, {"place"}, {"x", "y"})
_CONTENT, _COLUMNS, _NUMBERS, _PLACED = range(4)  # ranks of sheets


class _Seen(NamedTuple):
    """The first rows of a sheet: how much it looks like a table of stops, or of vehicles."""

    listed: Listed
    rank: int
    of_vehicles: bool


def is_spreadsheet(data: bytes) -> bool:
    """Return whether bytes are a zip file, which XLSX is."""
    return data.startswith(b"PK\x03\x04")


def sheets_of(source: Source, *, several: bool) -> list[Source]:
    """Return the sources of the sheet of stops, with its rows, and of one of vehicles.

    The sheet of stops is the first one with places or, if none has any, with numbers.

    Args:
        several: Whether it is one of several files: then only one sheet is read, and one of numbers
            may be a square of costs.

    Raises:
        UnreadableFile: It is not XLSX, has no row, or takes too much work.
    """
    book = Workbook(source)
    seen = [found for each in book.sheets[:_MOST_SHEETS] if (found := _look(source, book, each))]
    if not seen:
        raise source.refusal("no-sheet")
    ranks = [min(each.rank, _NUMBERS if several else _PLACED) for each in seen]
    stops = seen[ranks.index(max(ranks))]
    vans = [] if several else [each for each in seen if each.of_vehicles and each is not stops][:1]
    _note_sheets(source, book.sheets, [stops, *vans])
    read = [source.of_sheet("", _rows(source, book, stops.listed))]
    for each in vans:
        other = source.of_sheet(each.listed.title, [])
        read.append(other.of_sheet("", _rows(other, book, each.listed)))
    return read


def _note_sheets(source: Source, sheets: Sequence[Listed], read: Sequence[_Seen]) -> None:
    if len(sheets) > len(read):
        titles = " and ".join(quoted(each.listed.title) for each in read)
        only = f"Only the sheet {titles}" if len(read) == 1 else f"Of the sheets only {titles}"
        were = "was read" if len(read) == 1 else "were read"
        source.note("sheet", f"{only} of {len(sheets)} {were}.")


def _look(source: Source, book: Workbook, listed: Listed) -> _Seen | None:
    """Return how much the first rows of a sheet look like a table; None if it has no text."""
    sheet = book.read(listed, first=True)
    rows = [row for row in _texts(book, sheet) if any(row[1])]
    if not rows:
        return None
    try:
        table = table_of_rows(source.unnoted(), rows)
    except UnreadableFile:
        return _Seen(listed, _CONTENT, of_vehicles=False)
    heading = table.heading or []
    of_vehicles = is_about_vehicles(heading) if heading else False
    return _Seen(listed, _CONTENT if of_vehicles else _rank(table), of_vehicles)


def _rank(table: Table) -> int:
    fields = {*fields_of(table.heading)} if table.heading else set()
    if any(each <= fields for each in _PLACES):
        return _PLACED
    columns = zip(*(row for _, row in table.rows), strict=True)
    numbers = sum(any(number_in(each) is not None for each in texts) for texts in columns)
    if numbers >= _LEAST_NUMBERS:
        return _NUMBERS
    return _COLUMNS if table.width > 1 else _CONTENT


def _rows(source: Source, book: Workbook, listed: Listed) -> list[Row]:
    """Return the rows of a sheet, and note what is hidden in it.

    Raises:
        UnreadableFile: Formulas have no stored results.
    """
    sheet = book.read(listed)
    _check_formulas(source, book, sheet)
    rows = _texts(book, sheet)
    _note_hidden(source, sheet)
    if sheet.long_numbers:
        source.note(
            "digits",
            f"{_named(sheet.long_numbers, 'cell', 'has', 'have')} more than 15 digits, which a"
            " spreadsheet does not keep: format ids as text.",
        )
    return rows


def _check_formulas(source: Source, book: Workbook, sheet: Sheet) -> None:
    """Raise UnreadableFile if formulas have no stored results, or all of them 0 for later."""
    later = book.recalculates and sheet.formulas and sheet.zeros == sheet.formulas
    if sheet.unstored or later:
        which = (
            _named(sheet.unstored, "cell", "has", "have")
            if sheet.unstored
            else f"Each formula in the sheet {quoted(sheet.title)} has"
        )
        came = "no stored result" if sheet.unstored else "the result 0, to be calculated later"
        raise source.refusal("no-results", given=f"{which} {came}")


def _texts(book: Workbook, sheet: Sheet) -> list[Row]:
    """Return the rows of a sheet as texts, from its first column with any to its last."""
    used = {column for cells in sheet.rows.values() for column in cells}
    if not used:
        return []
    first, width = min(used), max(used) + 1 - min(used)
    book.source.check_count("fields", book.source.bounds.cells, width * len(sheet.rows))
    rows: list[Row] = []
    for number, cells in sorted(sheet.rows.items()):
        texts = [""] * width
        for column, cell in cells.items():
            texts[column - first] = book.text(cell)
        rows.append((number, texts))
    return rows


def _note_hidden(source: Source, sheet: Sheet) -> None:
    used = {column for cells in sheet.rows.values() for column in cells}
    columns = [
        column
        for first, last in sheet.hidden_columns
        for column in range(first, min(last, MOST_COLUMNS) + 1)
        if column in used
    ]
    hidden = [
        *([_counted("row", sheet.hidden_rows)] if sheet.hidden_rows else []),
        *([_counted("column", map(letters_of, columns))] if columns else []),
    ]
    if hidden:
        are = "is" if len(sheet.hidden_rows) + len(columns) == 1 else "are"
        source.note(
            "hidden",
            f"{_begun(' and '.join(hidden))} {are} hidden in the sheet {quoted(sheet.title)},"
            " and read as well: delete what is not to be planned.",
        )


def _counted(noun: str, which: Iterable[object]) -> str:
    named = [*map(str, which)]
    return f"{noun}{'s' * (len(named) > 1)} {shortened(named, _MOST_NAMED)}"


def _begun(sentence: str) -> str:
    return sentence[:1].upper() + sentence[1:]


def _named(cells: Sequence[str], noun: str, one: str, several: str) -> str:
    """Return the subject and verb of a sentence about cells."""
    return f"{_begun(_counted(noun, cells))} {one if len(cells) == 1 else several}"
