"""Open a workbook of XLSX: its visible sheets, the formats of its cells, and its shared texts."""

from typing import NamedTuple

from service.files.reading import Source
from service.files.xlsx.formats import GENERAL, Format, format_of
from service.files.xlsx.package import Package, relation_in
from service.files.xlsx.sheet import Cell, Sheet, Styles, read_sheet
from service.files.xlsx.texts import TextsReader

_FIRST_ROWS = 200  # by which a sheet is recognised
_TRUE = ("1", "true")


class Listed(NamedTuple):
    """A sheet in the list of a workbook: its title and its part."""

    title: str
    part: str


class Workbook:
    """A workbook whose sheets are read one by one.

    Attributes:
        sheets: The sheets that are not hidden, in order.
        recalculates: Whether all formulas are calculated when it is opened: as programs write it
            which do not calculate themselves.

    Raises:
        UnreadableFile: It is not XLSX.
    """

    def __init__(self, source: Source) -> None:
        self.source = source
        self._package = Package(source)
        related = self._package.relations(self._package.root)
        self._parts = {name: part for name, _, part in related}
        self._by_kind = {kind: part for _, kind, part in related}
        self.sheets: list[Listed] = []
        self.recalculates = self._from_1904 = False
        self._package.parse(self._package.root, self._list)
        self._styles = Styles(self._formats(), self._from_1904)
        self._texts: list[str] | None = None

    def _list(self, tag: str, attributes: dict[str, str]) -> None:
        if tag == "sheet" and attributes.get("state", "visible") == "visible":
            part = self._parts.get(relation_in(attributes), "")
            if "chartsheets" not in part:
                self.sheets.append(Listed(attributes.get("name", ""), part))
        elif tag == "workbookPr":
            self._from_1904 = attributes.get("date1904") in _TRUE
        elif tag == "calcPr":
            self.recalculates = attributes.get("fullCalcOnLoad") in _TRUE

    def _formats(self) -> list[Format]:
        codes: dict[int, str] = {}
        numbers: list[int] = []
        inside: list[str] = []

        def start(tag: str, attributes: dict[str, str]) -> None:
            if tag == "cellXfs":
                inside.append(tag)
            elif tag == "numFmt":
                codes[_whole(attributes.get("numFmtId"))] = attributes.get("formatCode", "")
            elif tag == "xf" and inside:
                numbers.append(_whole(attributes.get("numFmtId")))

        def end(tag: str) -> None:
            if tag == "cellXfs":
                inside.clear()

        self._package.parse(self._by_kind.get("styles", ""), start, end)
        known = {each: format_of(each, codes.get(each)) for each in set(numbers)}
        return [known.get(each, GENERAL) for each in numbers]

    def read(self, listed: Listed, *, first: bool = False) -> Sheet:
        """Return the cells of a sheet, or of its first rows alone."""
        most = {"most_rows": _FIRST_ROWS} if first else {}
        return read_sheet(self._package, listed.part, listed.title, self._styles, **most)

    def text(self, cell: Cell) -> str:
        """Return the text of a cell."""
        if isinstance(cell, str):
            return cell
        if self._texts is None:
            self._texts = self._shared_texts()
        if cell >= len(self._texts):
            raise self.source.refusal("too-few-texts", number=cell, came=len(self._texts))
        return self._texts[cell]

    def _shared_texts(self) -> list[str]:
        reader = TextsReader()
        self._package.feed(self._by_kind.get("sharedStrings", ""), reader.parser)
        return reader.texts


def _whole(text: str | None) -> int:
    return int(text) if text and text.isdecimal() and len(text) < 10 else 0
