"""Read the cells of a sheet of XLSX: their texts, what is hidden, and formulas without results."""

import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from xml.parsers import expat

from service.files.xlsx.formats import GENERAL, MOST_DIGITS, Format, text_of
from service.files.xlsx.package import Package, local

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


def read_sheet(
    package: Package, part: str, title: str, styles: "Styles", most_rows: int = _MOST_ROWS
) -> Sheet:
    """Return the cells of the sheet in a part; only those of its first rows, if there are more."""
    reader = _SheetReader(package, Sheet(title), styles, most_rows)
    with suppress(_EnoughError):
        package.feed(part, reader.parser)
    return reader.sheet


class _EnoughError(Exception):
    """Enough rows are read."""


@dataclass(frozen=True)
class Styles:
    """The number formats of cells by their styles, and where dates begin."""

    formats: list[Format] = field(default_factory=list)
    from_1904: bool = False


class _SheetReader:
    """The handlers of the tags of a sheet."""

    def __init__(self, package: Package, sheet: Sheet, styles: Styles, most_rows: int) -> None:
        self._rows_left = most_rows
        self.sheet = sheet
        self._package, self._source = package, package.source
        self._formats, self._from_1904 = styles.formats, styles.from_1904
        self.parser = parser = expat.ParserCreate()
        parser.buffer_text = True
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        self._begins: dict[str, Callable[[dict[str, str]], None]] = {
            "c": self._begin_cell,
            "v": self._begin_text,
            "t": self._begin_text,
            "row": self._begin_row,
            "f": self._begin_formula,
            "rPh": self._begin_phonetic,
            "col": self._begin_columns,
        }
        self._texts: list[str] = []
        self._row, self._column = 0, 0
        self._cells: dict[int, Cell] = {}
        self._cell: dict[str, str] = {}
        self._is_hidden = self._is_formula = False
        self._phonetic = 0
        self._count = 0
        self._columns: dict[str, int] = {}

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        begin = self._begins.get(tag) or self._begins.get(local(tag))
        if begin:
            begin(attributes)

    def _end(self, tag: str) -> None:
        name = local(tag)
        if name in ("v", "t"):
            self.parser.CharacterDataHandler = None
        elif name == "c":
            self._end_cell()
        elif name == "rPh":
            self._phonetic -= 1

    def _begin_cell(self, attributes: dict[str, str]) -> None:
        self._cell = attributes
        self._is_formula = False
        self._texts.clear()
        self._place(attributes.get("r"))

    def _begin_text(self, _: dict[str, str]) -> None:
        if not self._phonetic:
            self.parser.CharacterDataHandler = self._texts.append

    def _begin_formula(self, _: dict[str, str]) -> None:
        self._is_formula = True

    def _begin_phonetic(self, _: dict[str, str]) -> None:
        self._phonetic += 1

    def _begin_columns(self, attributes: dict[str, str]) -> None:
        span = (attributes.get("min", ""), attributes.get("max", ""))
        hidden = attributes.get("hidden") in _TRUE and all(map(str.isdecimal, span))
        if hidden and len(self.sheet.hidden_columns) < _FEW:
            self.sheet.hidden_columns.append((int(span[0]), int(span[1])))

    def _begin_row(self, attributes: dict[str, str]) -> None:
        self._source.spend(1)
        self._rows_left -= 1
        if self._rows_left < 0:
            raise _EnoughError
        number = attributes.get("r", "")
        self._row = int(number) if number.isdecimal() and len(number) < 8 else self._row + 1
        self._column = 0
        self._is_hidden = attributes.get("hidden") in _TRUE
        self._source.check_count("rows", _MOST_ROWS, self._row)
        self._cells = self.sheet.rows.get(self._row, {})

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

    def _end_cell(self) -> None:
        text = "".join(self._texts) if self._texts else ""
        kind = self._cell.get("t", "n")
        if self._is_formula:
            self._note_formula(text, kind)
        if not text:
            return
        cell = self._content(text, kind)
        if cell == "":
            return
        self._count += 1
        self._source.check_count("fields", self._source.bounds.cells // 2, self._count)
        self._source.spend(_READ)
        self._package.earn(_READ + _FIELD + (_TEXT if kind == "s" else 0))
        if not self._cells:
            self.sheet.rows[self._row] = self._cells
            if self._is_hidden:
                self.sheet.hidden_rows.append(self._row)
        if self._column in self._cells:
            raise self._source.refusal("cell-twice", f"cell {self._name()}")
        self._cells[self._column] = cell

    def _content(self, text: str, kind: str) -> Cell:
        if kind == "s":
            if not text.isdecimal() or len(text) > _MOST_DIGITS:
                raise self._source.refusal("no-shared-text", f"cell {self._name()}", came=text)
            return int(text)
        if kind == "n":
            return self._number(text)
        if kind == "b":
            return _BOOLEANS.get(text, text)
        return text.replace("T", " ").removesuffix("Z") if kind == "d" else text

    def _number(self, text: str) -> str:
        style = self._cell.get("s", "0")
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
