"""GPX and KML: their points are stops, lines are noted, and hostile XML is refused."""

import time

import pytest

from service.files.reader import read_files
from service.files.reading import Bounds, FileTooLarge, NamedFile, Reading, UnreadableFile

A, B = '<wpt lat="60.17" lon="24.94"', '<wpt lat="60.18" lon="24.95"'
ROUTE = (
    '<rte><rtept lat="60.17" lon="24.94"><name>a</name></rtept>'
    '<rtept lat="60.18" lon="24.95"><name>b</name></rtept></rte>'
)
TRACK = '<trk><trkseg><trkpt lat="60.1" lon="24.9"/></trkseg></trk>'
PLACES = [[24.94, 60.17], [24.95, 60.18]]


def gpx(inside: str) -> bytes:
    return f'<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1">{inside}</gpx>'.encode()


def kml(inside: str) -> bytes:
    return (
        f'<kml xmlns="http://www.opengis.net/kml/2.2"><Document>{inside}</Document></kml>'.encode()
    )


def placemark(name: str, inside: str = "", place: str = "24.94,60.17,0") -> str:
    point = f"<Point><coordinates>{place}</coordinates></Point>"
    return f"<Placemark><name>{name}</name>{inside}{point}</Placemark>"


def data(name: str, value: str) -> str:
    return f'<ExtendedData><Data name="{name}"><value>{value}</value></Data></ExtendedData>'


TWO = placemark("a") + placemark("b", place="24.95,60.18")
POINTS = {
    "waypoints": (gpx(f"{A}><name>a</name></wpt>{B}><name>b</name></wpt>"), ["a", "b"]),
    "waypoints without names": (gpx(f"{A}/>{B}/>"), ["1", "2"]),
    "waypoints of one name": (
        gpx(f"{A}><name>Stop</name></wpt>{B}><name>Stop</name></wpt>"),
        ["Stop", "Stop (2)"],
    ),
    "the points of a route": (gpx(ROUTE), ["a", "b"]),
    "a route that ends where it begins": (
        gpx(ROUTE.replace("</rte>", '<rtept lat="60.17" lon="24.94"><name>a</name></rtept></rte>')),
        ["a", "b"],
    ),
    "waypoints, beside a route": (
        gpx(f"{A}><name>c</name></wpt>{B}><name>d</name></wpt>{ROUTE}"),
        ["c", "d"],
    ),
    "GPX with a prefix": (
        b'<g:gpx xmlns:g="http://www.topografix.com/GPX/1/0"><g:wpt lat="60.17" lon="24.94">'
        b'<g:name>a</g:name></g:wpt><g:wpt lat="60.18" lon="24.95"/></g:gpx>',
        ["a", "2"],
    ),
    "GPX in another encoding": (
        b'<?xml version="1.0" encoding="ISO-8859-1"?>'
        + gpx(f"{A}><name>Köln</name></wpt>{B}/>").decode().encode("latin-1"),
        ["Köln", "2"],
    ),
    "GPX in UTF-16": (gpx(f"{A}/>{B}/>").decode().encode("utf-16"), ["1", "2"]),
    "GPX with a byte order mark": (b"\xef\xbb\xbf" + gpx(f"{A}/>{B}/>"), ["1", "2"]),
    "placemarks": (kml(TWO), ["a", "b"]),
    "placemarks in folders, with spaces": (
        kml(f"<Folder>{TWO}</Folder>".replace("24.94,60.17,0", "\n  24.94, 60.17\n")),
        ["a", "b"],
    ),
    "several points of a placemark": (
        kml(
            "<Placemark><name>a</name><MultiGeometry><Point><coordinates>24.94,60.17"
            "</coordinates></Point><Point><coordinates>24.95,60.18</coordinates></Point>"
            "</MultiGeometry></Placemark>"
        ),
        ["a-1", "a-2"],
    ),
    "a name in CDATA": (
        kml(TWO.replace("<name>a</name>", "<name><![CDATA[a & b]]></name>")),
        ["a & b", "b"],
    ),
}


def read(content: bytes, name: str = "a.gpx") -> Reading:
    return read_files([NamedFile(name, content)], Bounds(), wanted=None)


@pytest.mark.parametrize("name", POINTS)
def test_points_are_stops_in_their_order(name: str) -> None:
    content, ids = POINTS[name]
    stops = read(content).request["stops"]
    assert [stop["id"] for stop in stops] == ids
    assert [stop["location"] for stop in stops] == PLACES


NOTED = {
    "Points without a name are numbered": gpx(f"{A}/>{B}/>"),
    "Points that share a name were numbered, as 'x'": gpx(
        f"{A}><name>x</name></wpt>{B}><name>x</name></wpt>"
    ),
    "ele, time of points was not used": gpx(f"{A}><ele>4</ele><time>2026</time></wpt>{B}/>"),
    "2 points of routes were not used": gpx(f"{A}/>{B}/>{ROUTE}"),
    "1 points of tracks were not used": gpx(f"{A}/>{B}/>{TRACK}"),
    "1 placemarks of lines and areas were not used": kml(
        f"{TWO}<Placemark><LineString><coordinates>1,2 3,4</coordinates></LineString></Placemark>"
    ),
    "latitude of placemarks was not used": kml(TWO + placemark("c", data("latitude", "9"))),
}


@pytest.mark.parametrize("sentence", NOTED)
def test_what_is_left_out_is_noted(sentence: str) -> None:
    assert sentence in " ".join(note.text for note in read(NOTED[sentence]).notes)


def test_data_of_placemarks_are_columns() -> None:
    reading = read(kml(placemark("depot") + placemark("a", data("demand", "3"), "24.95,60.18")))
    assert reading.kind == "fleet"
    assert [stop.get("demand") for stop in reading.request["stops"]] == [None, [3]]


def test_descriptions_tell_drivers_something() -> None:
    waypoints = f"{A}><name>a</name><desc>ring twice</desc></wpt>{B}><name>b</name></wpt>"
    [detail] = read(gpx(waypoints)).details
    assert (detail.column, detail.texts) == ("description", ["ring twice", ""])


def test_a_table_of_vehicles_may_stand_beside_gpx() -> None:
    stops = NamedFile("a.gpx", gpx(f"{A}><name>depot</name></wpt>{B}><name>b</name></wpt>"))
    vans = NamedFile("vans.csv", b"vehicle,count,depot\nvan,2,depot\n")
    reading = read_files([stops, vans], Bounds(), wanted=None)
    assert reading.request["vehicles"][0]["count"] == 2


LAUGHS = (
    '<?xml version="1.0"?><!DOCTYPE gpx [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'
    '<gpx><wpt lat="60" lon="24"><name>&b;</name></wpt></gpx>'
)
OUTSIDE = (
    '<?xml version="1.0"?><!DOCTYPE gpx [<!ENTITY a SYSTEM "file:///etc/hostname">]>'
    '<gpx><wpt lat="60" lon="24"><name>&a;</name></wpt></gpx>'
)
REFUSED = {
    "entities": (LAUGHS.encode(), "must be GPX or KML without a document type"),
    "entities from outside": (OUTSIDE.encode(), "must be GPX or KML without a document type"),
    "an entity that nothing declares": (gpx(f"{A}><name>&b;</name></wpt>"), "must be XML"),
    "cut off": (gpx(f"{A}/>{B}/>")[:-9], "must be XML"),
    "an encoding that is none": (
        b'<?xml version="1.0" encoding="klingon"?>' + gpx(f"{A}/>"),
        "must be XML",
    ),
    "too deep": (gpx("<a>" * 60 + "</a>" * 60), "elements up to 50 deep"),
    "a latitude that is none": (
        gpx(A.replace("60.17", "95") + "/>"),
        "point 1, '1', must have a latitude of -90 to 90, got 95",
    ),
    "no longitude": (
        gpx('<wpt lat="60.17"><name>x</name></wpt>'),
        "point 1, 'x', must have a longitude and a latitude",
    ),
    "a place that is no number": (
        kml(TWO + placemark("c", place="east,north")),
        "point 3, 'c', must have a longitude and a latitude",
    ),
    "tracks alone": (gpx(TRACK), "got tracks alone, which are ways that were recorded"),
    "nothing in GPX": (gpx(""), "must have waypoints (wpt), or routes (rte); got neither"),
    "nothing in KML": (kml(""), "must have placemarks with a Point, got none"),
    "a link in KML": (
        kml("<NetworkLink><Link><href>https://maps.example/x</href></Link></NetworkLink>"),
        "links to another file",
    ),
    "an address in KML": (
        kml(TWO + "<Placemark><name>c</name><address>High St 5</address></Placemark>"),
        "placemark 'c' must have a Point: look up where its address is first",
    ),
    "a page of the web": (b"<!DOCTYPE html><html><body></body></html>", "got a web page"),
    "a table of the web": (b"<table><tr><td>1</td></tr></table>", "save it as XLSX or CSV"),
    "a spreadsheet in XML": (
        b'<?xml version="1.0"?><Workbook xmlns="urn:x"></Workbook>',
        "got a spreadsheet in XML",
    ),
    "other XML": (b"<orders><order/></orders>", "got XML that begins with 'orders'"),
    "TCX": (b"<TrainingCenterDatabase/>", "got TCX"),
    "an old spreadsheet": (b"\xd0\xcf\x11\xe0" + bytes(600), "(.xls): save it as .xlsx or CSV"),
    "a password": (
        b"\xd0\xcf\x11\xe0" + bytes(600) + "EncryptedPackage".encode("utf-16-le"),
        "with a password",
    ),
    "a GeoPackage": (b"SQLite format 3\x00" + bytes(90), "export it as GeoJSON or CSV"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_other_or_hostile_files_are_refused_in_a_sentence(name: str) -> None:
    content, sentence = REFUSED[name]
    with pytest.raises(UnreadableFile) as refused:
        read(content)
    assert sentence in str(refused.value)


@pytest.mark.parametrize(
    "inside",
    ["<a/>" * 2**20, f"<a b='{'x' * 2**21}'/>", "<!--" + "x" * 2**21 + "-->", TRACK * 2**18],
    ids=["elements", "attribute", "comment", "tracks"],
)
def test_xml_that_is_too_much_is_refused_soon(inside: str) -> None:
    began = time.process_time()
    with pytest.raises(FileTooLarge):
        read_files([NamedFile("a.gpx", gpx(inside))], Bounds(cities=1000), wanted=None)
    assert time.process_time() - began < 2
