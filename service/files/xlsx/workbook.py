"""Open a workbook of XLSX: its visible sheets, the formats of its cells, and its shared texts."""

from collections.abc import Iterator
from typing import NamedTuple
from xml.parsers import expat

from service.files.reading import Source
from service.files.xlsx.formats import GENERAL, format_of
from service.files.xlsx.package import Package, local, relation_in
from service.files.xlsx.sheet import Cell, Sheet, Styles, read_sheet

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
        self._source = source
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

    def _formats(self) -> list:
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

    def read(self, listed: Listed) -> Sheet:
        """Return the cells of a sheet."""
        self._source.spend(1)
        return read_sheet(self._package, listed.part, listed.title, self._styles)

    def text(self, cell: Cell) -> str:
        """Return the text of a cell."""
        if isinstance(cell, str):
            return cell
        if self._texts is None:
            self._texts = self._shared_texts()
        return self._texts[cell] if cell < len(self._texts) else ""

    def _shared_texts(self) -> list[str]:
        """Return the texts that cells share, each of one or several runs."""
        parser = expat.ParserCreate()
        parser.buffer_text = True
        texts: list[str] = []
        pieces: list[str] = []
        phonetic = 0

        def start(tag: str, _: dict[str, str]) -> None:
            nonlocal phonetic
            name = local(tag)
            if name == "si":
                pieces.clear()
            elif name == "rPh":
                phonetic += 1
            elif name == "t" and not phonetic:
                parser.CharacterDataHandler = pieces.append

        def end(tag: str) -> None:
            nonlocal phonetic
            name = local(tag)
            if name == "t":
                parser.CharacterDataHandler = None
            elif name == "rPh":
                phonetic -= 1
            elif name == "si":
                texts.append("".join(pieces))

        parser.StartElementHandler, parser.EndElementHandler = start, end
        self._package.feed(self._by_kind.get("sharedStrings", ""), parser)
        return texts


def _whole(text: str | None) -> int:
    return int(text) if text and text.isdecimal() and len(text) < 10 else 0
