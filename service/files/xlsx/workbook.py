"""Open a workbook of XLSX: its visible sheets, the formats of its cells, and its shared texts."""

from typing import NamedTuple
from xml.etree.ElementTree import Element

from service.files.reading import Source
from service.files.xlsx.formats import Format, format_of
from service.files.xlsx.package import Package, relation_of
from service.files.xlsx.sheet import Cell, Sheet, Styles, read_sheet, text_in

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
        for each in self._package.elements(self._package.root, "sheet", "workbookPr", "calcPr"):
            self._read(each)
        self._styles = Styles(self._formats(), self._from_1904)
        self._texts: list[str] | None = None

    def _read(self, element: Element) -> None:
        """Read an element of the part that lists the sheets."""
        if element.tag == "workbookPr":
            self._from_1904 = element.get("date1904") in _TRUE
        elif element.tag == "calcPr":
            self.recalculates = element.get("fullCalcOnLoad") in _TRUE
        elif element.get("state", "visible") == "visible":
            part = self._parts.get(relation_of(element), "")
            if "chartsheets" not in part:
                self.sheets.append(Listed(element.get("name", ""), part))

    def _formats(self) -> list[Format]:
        """Return the format of each style."""
        codes: dict[int, str] = {}
        numbers: list[int] = []
        for each in self._package.elements(self._by_kind.get("styles", ""), "numFmt", "cellXfs"):
            if each.tag == "numFmt":
                codes[_whole(each.get("numFmtId"))] = each.get("formatCode", "")
            else:
                numbers += [_whole(style.get("numFmtId")) for style in each.iter("xf")]
        known = {each: format_of(each, codes.get(each)) for each in set(numbers)}
        return [known[each] for each in numbers]

    def read(self, listed: Listed, *, first: bool = False) -> Sheet:
        """Return the cells of a sheet, or of its first rows alone."""
        most = {"most_rows": _FIRST_ROWS} if first else {}
        return read_sheet(self._package, listed.part, listed.title, self._styles, **most)

    def text(self, cell: Cell) -> str:
        """Return the text of a cell."""
        if isinstance(cell, str):
            return cell
        if self._texts is None:
            part = self._by_kind.get("sharedStrings", "")
            self._texts = [text_in(each) for each in self._package.elements(part, "si")]
        if cell >= len(self._texts):
            raise self.source.refusal("too-few-texts", number=cell, came=len(self._texts))
        return self._texts[cell]


def _whole(text: str | None) -> int:
    return int(text) if text and text.isdecimal() and len(text) < 10 else 0
