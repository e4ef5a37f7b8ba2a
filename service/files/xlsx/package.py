"""The parts of an XLSX file, a zip file of XML, each parsed within the budget of its file."""

import io
import posixpath
import zipfile
import zlib
from collections.abc import Iterator
from xml.etree.ElementTree import Element
from xml.parsers import expat

from service.files.reading import Source, UnreadableFile
from service.files.xml_elements import elements

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
        for each in self.elements(posixpath.join(folder, "_rels", f"{name}.rels"), "Relationship"):
            if each.get("TargetMode") != "External":
                target = each.get("Target", "").replace("\\", "/")
                whole = posixpath.normpath(posixpath.join("/", folder, target)).lstrip("/")
                kind = each.get("Type", "").rpartition("/")[2]
                found.append((each.get("Id", ""), kind, whole))
        return found

    def earn(self, units: int) -> None:
        """Earn units of work for a cell with text, as many as a file of this length may have."""
        self._earned_at_most -= units
        if self._earned_at_most >= 0:
            self.source.work.earn(units)

    def elements(self, part: str, *names: str) -> Iterator[Element]:
        """Yield the elements of a part that have these names; none if there is no such part.

        Raises:
            UnreadableFile: It cannot be unpacked, is not XML, or takes too much work.
        """
        info = self._parts.get(_plain(part))
        if info is None:
            return
        if info.compress_type not in _COMPRESSIONS:
            raise self.source.refusal("not-deflated")
        try:
            with self._zip.open(info) as file:
                yield from elements(self.source, file.read, lambda _: names, self._doctype)
        except UnreadableFile:  # which is a ValueError
            raise
        except (zipfile.BadZipFile, OSError, EOFError, RuntimeError, ValueError) as error:
            raise self.source.refusal("not-xlsx", reason=str(error)) from None
        except (zlib.error, expat.ExpatError) as error:
            raise self.source.refusal("not-xlsx", reason=f"{part}: {error}") from None

    def _doctype(self, _: str) -> UnreadableFile:
        given = "XML with a DOCTYPE, which it never has"
        return self.source.refusal("another-format", wanted="XLSX", given=given)


def relation_of(element: Element) -> str:
    """Return the id of the relation of an element, whatever the prefix of the attribute is."""
    return next((value for name, value in element.items() if name.endswith(":id")), "")


def _plain(name: str) -> str:
    return name.replace("\\", "/").lstrip("/").casefold()
