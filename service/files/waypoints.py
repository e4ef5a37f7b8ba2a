"""Read waypoints and routes of GPX, and placemarks of KML, as tables of stops.

Both are XML, which is parsed without entities, and in time that grows with its length alone: a
document type is refused, and so are more elements than stops need.
"""

import codecs
import io
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from xml.parsers import expat

from service.files.cells.ids import each_once
from service.files.column_names import fields_of
from service.files.other_files import STOPS, XML
from service.files.places import check_range
from service.files.reading import Source, UnreadableFile, quoted
from service.files.tables import Table, number_in, table_of
from service.files.xml_feed import feed

_MARKS = (codecs.BOM_UTF8, codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
_BEGINS = (b"<", b"<\0", b"\0<")
_DEEPEST = 50
_LONGEST = 2000  # characters of a text
_MOST_COLUMNS = 50
_MOST_NAMED, _LONGEST_NAME = 8, 40
_PLACES = ("id", "longitude", "latitude", "place", "x", "y")
_OTHER_SHAPES = {"LineString", "LinearRing", "Polygon", "Track", "MultiTrack", "Model"}
_TEXTS = {"name": "id", "desc": "description", "cmt": "comment", "description": "description"}


@dataclass
class _Point:
    """A waypoint or placemark: the kind of its element, its places, and its texts by column."""

    kind: str
    places: list[tuple[str, str]] = field(default_factory=list)  # longitude and latitude
    texts: dict[str, str] = field(default_factory=dict)
    shapes: int = 0  # lines and areas
    address: str = ""


def is_xml(data: bytes) -> bool:
    """Return whether bytes begin like XML, or a page of the web."""
    for mark in _MARKS:
        data = data.removeprefix(mark) if data[:4].startswith(mark) else data
    return data[:200].lstrip(b" \t\r\n").startswith(_BEGINS)


def table_of_xml(source: Source) -> Table:
    """Return the points of GPX or KML as a table with a heading.

    Raises:
        UnreadableFile: It is not GPX or KML, or has no points, or something hostile.
    """
    found = _Points(source)
    found.parse()
    points = found.of_gpx() if found.root == "gpx" else found.of_kml()
    return table_of(source, _rows(source, points), first=0)


class _Points:
    """Collects the points of a document while it is parsed."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.root = ""
        self.points: list[_Point] = []
        self.links = False
        self.recorded = 0  # points of tracks
        self._places = 0
        self.unused: dict[str, None] = {}  # names of elements in points of GPX
        self._path: list[str] = []
        self._open: _Point | None = None
        self._column: str | None = None  # what the text of the current element is
        self._named = ""  # the name of the current Data of KML
        self._text: list[str] = []

    def parse(self) -> None:
        """Parse the document.

        Raises:
            UnreadableFile: It is not XML, or hostile.
        """
        parser = expat.ParserCreate()
        parser.buffer_text = True
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._characters
        parser.StartDoctypeDeclHandler = self._doctype
        try:
            feed(self.source, parser, io.BytesIO(self.source.file.data).read)
        except UnreadableFile:  # which is a ValueError
            raise
        except (expat.ExpatError, LookupError, ValueError) as error:  # the latter of its encoding
            raise self.source.refusal("not-xml", reason=str(error)[:200]) from None

    def _doctype(self, name: str, *_: object) -> None:
        if name.casefold() == "html":
            raise self._another_format(name)
        raise self.source.refusal("document-type", came=name)

    def _start(self, name: str, attributes: Mapping[str, str]) -> None:
        name = name.rpartition(":")[2]
        if not self._path:
            self._check_root(name)
        if len(self._path) >= _DEEPEST:
            raise self.source.refusal("too-deep", most=_DEEPEST)
        self._path.append(name)
        self._text = []
        self._column = None
        if self.root == "gpx":
            self._start_gpx(name, attributes)
        else:
            self._start_kml(name, attributes)

    def _check_root(self, name: str) -> None:
        self.root = name.casefold()
        if self.root not in ("gpx", "kml"):
            raise self._another_format(name)

    def _another_format(self, name: str) -> UnreadableFile:
        """Return the exception for XML that begins with another element."""
        other = (STOPS, f"XML that begins with {quoted(name)}")
        wanted, given = XML.get(name.casefold(), other)
        return self.source.refusal("another-format", wanted=wanted, given=given)

    def _start_gpx(self, name: str, attributes: Mapping[str, str]) -> None:
        self.recorded += name == "trkpt"
        if name in ("wpt", "rtept"):
            self._open = _Point(name, [(attributes.get("lon", ""), attributes.get("lat", ""))])
            self.points.append(self._open)
            if name == self.points[0].kind:
                self._count_place()
        elif self._open is not None and len(self._path) >= 2 and self._path[-2] == self._open.kind:
            self._column = _TEXTS.get(name)
            if self._column is None and len(self.unused) < _MOST_COLUMNS:
                self.unused[name] = None

    def _start_kml(self, name: str, attributes: Mapping[str, str]) -> None:
        parent = self._path[-2] if len(self._path) > 1 else ""
        self.links |= name == "NetworkLink"
        if name == "Placemark":
            self._open = _Point(name)
            self.points.append(self._open)
        elif self._open is None:
            return
        elif name in _OTHER_SHAPES:
            self._open.shapes += 1
        else:
            self._column = self._column_of(name, parent, attributes)

    def _column_of(self, name: str, parent: str, attributes: Mapping[str, str]) -> str | None:
        """Return the column of the text of an element in a placemark."""
        if parent == "Placemark" and name in ("name", "description", "address"):
            return _TEXTS.get(name, name)
        if name == "Data":
            self._named = attributes.get("name", "")
        named = attributes.get("name", "") if name == "SimpleData" else ""
        if parent == "Data" and name == "value":
            named = self._named
        return name if parent == "Point" and name == "coordinates" else named[:_LONGEST] or None

    def _characters(self, text: str) -> None:
        if self._column is not None and len(self._text) < _LONGEST:
            self._text.append(text[:_LONGEST])

    def _end(self, name: str) -> None:
        self._path.pop()
        if self._open is not None and self._column:
            self._add(self._open, self._column, " ".join("".join(self._text).split())[:_LONGEST])
        self._column = None
        if self._open is not None and name.rpartition(":")[2] == self._open.kind:
            self._open = None

    def _add(self, point: _Point, column: str, text: str) -> None:
        if column == "coordinates":
            longitude, _, rest = text.partition(",")
            point.places.append((longitude.strip(), rest.partition(",")[0].strip()))
            self._count_place()
        elif column == "address":
            point.address = text
        elif text and (column in point.texts or len(point.texts) <= _MOST_COLUMNS + 1):
            point.texts.setdefault(column, text)

    def _count_place(self) -> None:
        """Count a place, and refuse too many at once; of a round trip the last is the first."""
        self._places += 1
        if self._places > self.source.bounds.cities + 1:
            self.source.check_count("stops", self.source.bounds.cities, self._places)

    def of_gpx(self) -> list[_Point]:
        """Return the waypoints; without any, the points of routes; and note the others."""
        waypoints = [point for point in self.points if point.kind == "wpt"]
        of_routes = [point for point in self.points if point.kind == "rtept"]
        stops = waypoints or of_routes
        if not stops:
            came = "tracks alone, which are ways that were recorded" if self.recorded else "neither"
            raise self.source.refusal("no-waypoints", given=came)
        if waypoints and of_routes:
            text = f"{len(of_routes)} points of routes were not used: stops are waypoints."
            self.source.note("left-out", text)
        if self.unused:
            named = ", ".join(name[:_LONGEST_NAME] for name in list(self.unused)[:_MOST_NAMED])
            self.source.note("columns", f"{named} of points was not used.")
        if self.recorded:
            self.source.note("left-out", f"{self.recorded} points of tracks were not used.")
        return stops if waypoints else self._one_way(stops)

    def _one_way(self, stops: list[_Point]) -> list[_Point]:
        """Return the points of a route; of one that ends where it begins, all but the last."""
        first, last = ((each.places, each.texts) for each in (stops[0], stops[-1]))
        if len(stops) < 3 or first != last:
            return stops
        text = "The route ends where it begins: this place is one stop."
        self.source.note("empty-rows", text)
        return stops[:-1]

    def of_kml(self) -> list[_Point]:
        """Return the placemarks that have a point, and note lines and areas.

        Raises:
            UnreadableFile: A placemark has an address alone, or there are none.
        """
        stops = [point for point in self.points if point.places]
        others = [point for point in self.points if not point.places]
        for point in others:
            if not point.shapes:
                named = f"placemark {quoted(point.texts.get('id') or point.address)}"
                raise self.source.refusal("address-alone" if point.address else "no-point", named)
        if not stops:
            came = "links to another file: download all of the map" if self.links else "none"
            raise self.source.refusal("no-placemarks", given=came)
        if others:
            text = f"{len(others)} placemarks of lines and areas were not used."
            self.source.note("left-out", text)
        return stops


def _rows(source: Source, points: list[_Point]) -> Iterator[list[str]]:
    """Yield a heading, and a row for each place of each point."""
    columns = _columns(source, points)
    names = _names(source, points)
    yield ["id", "longitude", "latitude", *columns]
    for at, point in enumerate(points, 1):
        for number, place in enumerate(point.places, 1):
            name = names[at - 1] if len(point.places) == 1 else f"{names[at - 1]}-{number}"
            where = f"point {at}, {quoted(name)},"
            degrees = [number_in(each) for each in place]
            if None in degrees:
                axes = dict(zip(("longitude", "latitude"), place, strict=True))
                raise source.refusal("no-degrees", where, **axes)
            check_range(source, [each or 0.0 for each in degrees], where)
            yield [name, *place, *(point.texts.get(each, "") for each in columns)]


def _columns(source: Source, points: list[_Point]) -> list[str]:
    """Return the names of texts that are columns beside the id and the place.

    Data that have the name of a place stand beside the point, which is where the stop is.
    """
    found = list(dict.fromkeys(name for each in points for name in each.texts if name != "id"))
    kept = [
        name for name, known in zip(found, fields_of(found), strict=True) if known not in _PLACES
    ]
    others = [name for name in found if name not in kept]
    if others:
        named = ", ".join(quoted(name)[1:-1] for name in others[:5])
        text = f"{named} of placemarks was not used: their points and names say it."
        source.note("left-out", text)
    source.check_count("columns", _MOST_COLUMNS, len(kept))
    return kept


def _names(source: Source, points: list[_Point]) -> list[str]:
    """Return the names of points. Those without one are numbered, and so are those of one name."""
    given = [point.texts.get("id") or str(at) for at, point in enumerate(points, 1)]
    if any("id" not in point.texts for point in points):
        source.note("ids", "Points without a name are numbered from 1.")
    if shared := [name for name, count in Counter(given).items() if count > 1]:
        named = ", ".join(quoted(name) for name in shared[:3])
        source.note("ids", f"Points that share a name were numbered, as {named}.")
    return each_once(given)
