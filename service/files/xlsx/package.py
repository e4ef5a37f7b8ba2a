"""The parts of an XLSX file, a zip file of XML, each parsed within the budget of its file."""

import io
import posixpath
import zipfile
from collections.abc import Callable, Mapping
from xml.parsers import expat

from service.files.reading import Source, UnreadableFile
from service.files.xml_feed import feed

_MOST_PARTS = 2000
_ENTRY = b"PK\x01\x02"  # of each part, in the list at the end of a zip file
_MOST_EARNED = 32  # units of work for each byte: packed cells have half a byte or more
_COMPRESSIONS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_ROOT = "xl/workbook.xml"
# By a part that only such files have.
_OTHERS = {
    "content.xml": "an OpenDocument file (.ods): save it as .xlsx or CSV",
    "xl/workbook.bin": "a binary spreadsheet (.xlsb): save it as .xlsx or CSV",
    "index/document.iwa": "a file of Numbers: export it as .xlsx or CSV",
    "word/document.xml": "a document of Word: save its table as .xlsx or CSV",
    "doc.kml": "KMZ: unpack it first, and send the KML in it",
}

Start = Callable[[str, dict[str, str]], None]
End = Callable[[str], None]


class Package:
    """The parts of an XLSX file.

    Args:
        source: The file, whose budget is spent on what is unpacked and parsed.

    Raises:
        UnreadableFile: It is not XLSX, or has too many parts.
    """

    def __init__(self, source: Source) -> None:
        self.source = source
        # Counted before the list is read, which takes microseconds for each.
        source.check_count("parts", _MOST_PARTS, source.file.data.count(_ENTRY))
        try:
            self._zip = zipfile.ZipFile(io.BytesIO(source.file.data))
        except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as error:
            raise source.refusal("not-xlsx", reason=str(error)) from None
        self._parts = {_plain(each.filename): each for each in self._zip.infolist()}
        self._earned_at_most = _MOST_EARNED * len(source.file.data)
        self.root = self._root()

    def _root(self) -> str:
        """Return the name of the part that lists the sheets."""
        roots = [target for _, kind, target in self.relations("") if kind == "officeDocument"]
        found = next((each for each in [*roots, _ROOT] if _plain(each) in self._parts), None)
        if found is not None and _plain(found).endswith(".xml") and _plain(found)[:4] != "word":
            return found
        named = (what for part, what in _OTHERS.items() if part in self._parts)
        given = next(named, "another zip file: unpack it first")
        raise self.source.refusal("another-format", wanted="XLSX", given=given)

    def relations(self, part: str) -> list[tuple[str, str, str]]:
        """Return the id, the kind and the part of each relation of a part."""
        folder, name = posixpath.split(part)
        found: list[tuple[str, str, str]] = []

        def start(tag: str, attributes: dict[str, str]) -> None:
            if tag == "Relationship" and attributes.get("TargetMode") != "External":
                target = attributes.get("Target", "").replace("\\", "/")
                whole = posixpath.normpath(posixpath.join("/", folder, target)).lstrip("/")
                kind = attributes.get("Type", "").rpartition("/")[2]
                found.append((attributes.get("Id", ""), kind, whole))

        self.parse(posixpath.join(folder, "_rels", f"{name}.rels"), start)
        return found

    def parse(self, part: str, start: Start, end: End | None = None) -> None:
        """Call functions for the tags of a part, named without their prefixes; if there is one."""
        parser = expat.ParserCreate()
        _attach(parser, start, end)
        self.feed(part, parser)

    def earn(self, units: int) -> None:
        """Earn units of work for a cell with text, as many as a file of this length may have."""
        self._earned_at_most -= units
        if self._earned_at_most >= 0:
            self.source.work.earn(units)

    def feed(self, part: str, parser: "expat.XMLParserType") -> None:
        """Parse a part, if there is one.

        Raises:
            UnreadableFile: It cannot be unpacked, is not XML, or takes too much work.
        """
        info = self._parts.get(_plain(part))
        if info is None:
            return
        parser.StartDoctypeDeclHandler = self._refuse_doctype
        if info.compress_type not in _COMPRESSIONS:
            raise self.source.refusal("not-deflated")
        try:
            with self._zip.open(info) as file:
                feed(self.source, parser, file.read)
        except UnreadableFile:  # which is a ValueError
            raise
        except (zipfile.BadZipFile, OSError, EOFError, RuntimeError, ValueError) as error:
            raise self.source.refusal("not-xlsx", reason=str(error)) from None
        except Exception as error:
            if type(error).__module__ not in ("zlib", "pyexpat", "xml.parsers.expat"):
                raise
            raise self.source.refusal("not-xlsx", reason=f"{part}: {error}") from None

    def _refuse_doctype(self, *_: object) -> None:
        given = "XML with a DOCTYPE, which it never has"
        raise self.source.refusal("another-format", wanted="XLSX", given=given)


def _attach(parser: "expat.XMLParserType", start: Start, end: End | None) -> None:
    parser.StartElementHandler = lambda tag, attributes: start(local(tag), attributes)
    if end is not None:
        parser.EndElementHandler = lambda tag: end(local(tag))


def local(tag: str) -> str:
    """Return the name of a tag without its prefix."""
    return tag.rpartition(":")[2]


def relation_in(attributes: Mapping[str, str]) -> str:
    """Return the id of a relation in attributes, whatever its prefix is."""
    return next((value for name, value in attributes.items() if name.endswith(":id")), "")


def _plain(name: str) -> str:
    return name.replace("\\", "/").lstrip("/").casefold()
