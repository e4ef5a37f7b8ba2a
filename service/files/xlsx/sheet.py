"""Read the cells of a sheet of XLSX: their texts, what is hidden, and formulas without results."""

import re
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element

from service.files.xlsx.formats import GENERAL, MOST_DIGITS, Format, text_of
from service.files.xlsx.package import Package

MOST_COLUMNS = 16384  # of a spreadsheet
_MOST_ROWS = 2**20
_READ = 10  # units of work to read a field, and later the table
_FIELD = 8  # units of work that a field earns: its tags, and some bytes
_TEXT = 8  # units that a text earns which several cells may share
_TRUE = ("1", "true")
_BOOLEANS = {"0": "False", "1": "True"}
_MOST_DIGITS = 9  # of the number of a shared text
_FEW = 1000  # cells that are told at most
_REF = re.compile("([A-Z]{1,3})([0-9]{1,7})")

Cell = str | int  # a text, or the number of a shared one


@dataclass
class Sheet:
    """The cells of a sheet that have texts, by row and column, both from 1.

    Attributes:
        rows: The cells of each row with any.
        hidden_rows: The rows that have cells and are hidden.
        hidden_columns: The first and the last of each span of hidden columns.
        unstored: The cells whose formulas have no stored result.
        formulas: How many formulas have a stored result.
        zeros: How many of these results are 0.
        long_numbers: The cells whose numbers have more digits than are kept.
    """

    title: str
    rows: dict[int, dict[int, Cell]] = field(default_factory=dict)
    hidden_rows: list[int] = field(default_factory=list)
    hidden_columns: list[tuple[int, int]] = field(default_factory=list)
    unstored: list[str] = field(default_factory=list)
    formulas: int = 0
    zeros: int = 0
    long_numbers: list[str] = field(default_factory=list)


def letters_of(column: int) -> str:
    """Return the letters of a column that is counted from 1.

    >>> letters_of(1), letters_of(27)
    ('A', 'AA')
    """
    letters = ""
    while column:
        column, rest = divmod(column - 1, 26)
        letters = chr(65 + rest) + letters
    return letters


def _column_of(letters: str) -> int:
    column = 0
    for letter in letters:
        column = 26 * column + ord(letter) - 64
    return column


def text_in(element: Element) -> str:
    """Return the text in a cell or in a shared text: all its runs, without their pronunciation."""
    texts = [
        (each.text or "") if each.tag in ("v", "t") else text_in(each)
        for each in element
        if each.tag != "rPh"
    ]
    return "".join(texts)


@dataclass(frozen=True)
class Styles:
    """The number formats of cells by their styles, and where dates begin."""

    formats: list[Format] = field(default_factory=list)
    from_1904: bool = False


def read_sheet(
    package: Package, part: str, title: str, styles: Styles, most_rows: int = _MOST_ROWS
) -> Sheet:
    """Return the cells of the sheet in a part; only those of its first rows, if there are more."""
    reader = _SheetReader(package, Sheet(title), styles)
    left = most_rows
    for each in package.elements(part, "row", "col"):
        if each.tag == "col":
            reader.add_columns(each)
        elif left:
            left -= 1
            reader.add_row(each)
        else:
            break
    return reader.sheet


class _SheetReader:
    """Adds rows to a sheet."""

    def __init__(self, package: Package, sheet: Sheet, styles: Styles) -> None:
        self.sheet = sheet
        self._package, self._source = package, package.source
        self._formats, self._from_1904 = styles.formats, styles.from_1904
        self._row, self._column = 0, 0
        self._count = 0
        self._columns: dict[str, int] = {}

    def add_columns(self, columns: Element) -> None:
        """Add a span of columns, if they are hidden."""
        span = (columns.get("min", ""), columns.get("max", ""))
        hidden = columns.get("hidden") in _TRUE and all(map(str.isdecimal, span))
        if hidden and len(self.sheet.hidden_columns) < _FEW:
            self.sheet.hidden_columns.append((int(span[0]), int(span[1])))

    def add_row(self, row: Element) -> None:
        """Add the cells of a row that have texts."""
        self._source.spend(1)
        number = row.get("r", "")
        self._row = int(number) if number.isdecimal() and len(number) < 8 else self._row + 1
        self._source.check_count("rows", _MOST_ROWS, self._row)
        self._column = 0
        cells = self.sheet.rows.get(self._row, {})
        for each in row.iterfind("c"):
            self._place(each.get("r"))
            if (cell := self._content(each)) == "":
                continue
            if not cells:
                self.sheet.rows[self._row] = cells
                if row.get("hidden") in _TRUE:
                    self.sheet.hidden_rows.append(self._row)
            if self._column in cells:
                raise self._source.refusal("cell-twice", f"cell {self._name()}")
            cells[self._column] = cell

    def _place(self, ref: str | None) -> None:
        """Set the column of a cell: that of its reference, or else the next one."""
        letters = ref.rstrip("0123456789") if ref else ""
        column = self._columns.get(letters)
        if column is None:
            found = _REF.fullmatch(ref or "")
            column = _column_of(found[1]) if found else self._column + 1
            if found:
                self._columns[letters] = column
            self._source.check_count("columns", MOST_COLUMNS, column)
        self._column = column

    def _content(self, cell: Element) -> Cell:
        """Return what is in a cell, and count it; "" if that is nothing."""
        text, kind = text_in(cell), cell.get("t", "n")
        if cell.find("f") is not None:
            self._note_formula(text, kind)
        content = self._read(cell, text, kind) if text else ""
        if content != "":
            self._count += 1
            self._source.check_count("fields", self._source.bounds.cells // 2, self._count)
            self._source.spend(_READ)
            self._package.earn(_READ + _FIELD + (_TEXT if kind == "s" else 0))
        return content

    def _read(self, cell: Element, text: str, kind: str) -> Cell:
        if kind == "s":
            if not text.isdecimal() or len(text) > _MOST_DIGITS:
                raise self._source.refusal("no-shared-text", f"cell {self._name()}", came=text)
            return int(text)
        if kind == "n":
            return self._number(text, cell.get("s", "0"))
        if kind == "b":
            return _BOOLEANS.get(text, text)
        return text.replace("T", " ").removesuffix("Z") if kind == "d" else text

    def _number(self, text: str, style: str) -> str:
        at = int(style) if style.isdecimal() else 0
        shown = self._formats[at] if at < len(self._formats) else GENERAL
        written = text_of(text, shown, self._from_1904)
        if len(written) > MOST_DIGITS and written.isdecimal():
            self._keep(self.sheet.long_numbers)
        return written

    def _note_formula(self, text: str, kind: str) -> None:
        """Count a formula, or keep its cell if its result is not stored; a text may be empty."""
        if text or kind == "str":
            self.sheet.formulas += 1
            self.sheet.zeros += text == "0"
        else:
            self._keep(self.sheet.unstored)

    def _keep(self, cells: list[str]) -> None:
        if len(cells) < _FEW:
            cells.append(self._name())

    def _name(self) -> str:
        return f"{letters_of(self._column)}{self._row}"
