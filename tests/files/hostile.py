"""Small files that would keep a reader busy for long, each made by a function."""

from collections.abc import Callable, Mapping

from tests.files.xlsx import MAIN, SHARED, TABLE, book


def _texts(count: int, text: str) -> dict[str, str]:
    items = f"<si><t>{text}</t></si>" * count
    return {"xl/sharedStrings.xml": f'<sst xmlns="{MAIN}">{items}</sst>'}


def _one_text(runs: str) -> dict[str, str]:
    return {"xl/sharedStrings.xml": f'<sst xmlns="{MAIN}"><si>{runs}</si></sst>'}


def _styles(count: int) -> dict[str, str]:
    cells = '<xf numFmtId="0"/>' * count
    return {"xl/styles.xml": f'<styleSheet xmlns="{MAIN}"><cellXfs>{cells}</cellXfs></styleSheet>'}


def _parts(count: int) -> bytes:
    return book(more={f"docProps/{at}.xml": "" for at in range(count)})


TSPLIB = b"TYPE : TSP\nDIMENSION : 3\nEDGE_WEIGHT_TYPE : EUC_2D\n"

HOSTILE: Mapping[str, Callable[[], tuple[str, bytes]]] = {
    "waypoints": lambda: ("a.gpx", b"<gpx>" + b'<wpt lat="1" lon="2"/>' * 300_000 + b"</gpx>"),
    "keywords": lambda: ("a.tsp", TSPLIB + b"A : b\n" * 1_000_000),
    "empty rows": lambda: ("a.xlsx", book(TABLE + "<row/>" * 1_500_000)),
    "sheets": lambda: ("a.xlsx", book("", sheets=map(str, range(1, 3_001)))),
    "styles": lambda: ("a.xlsx", book(more=_styles(1_000_000))),
    "names": lambda: ("a.xlsx", book(names='<definedName name="a">1</definedName>' * 500_000)),
    "a row of cells": lambda: ("a.xlsx", book(f"<row>{'<c/>' * 1_000_000}</row>")),
    "a row of numbers": lambda: ("a.xlsx", book(f"<row>{'<c><v>1</v></c>' * 100_000}</row>")),
    "rows of ones": lambda: ("a.xlsx", book(f"<row>{'<c><v>1</v></c>' * 1000}</row>" * 600)),
    "strings": lambda: ("a.xlsx", book(SHARED, more=_texts(600_000, "a" * 100))),
    "a long string": lambda: ("a.xlsx", book(SHARED, more=_one_text(f"<t>{'a' * 80_000_000}</t>"))),
    "runs of a string": lambda: (
        "a.xlsx",
        book(SHARED, more=_one_text("<r><t>a</t></r>" * 600_000)),
    ),
    "merged cells": lambda: (
        "a.xlsx",
        book(
            around="<sheetData>{}</sheetData><mergeCells>"
            + '<mergeCell ref="A1:B2"/>' * 2_000_000
            + "</mergeCells>"
        ),
    ),
    "columns": lambda: (
        "a.xlsx",
        book(
            around="<cols>"
            + '<col min="1" max="16384"/>' * 2_000_000
            + "</cols><sheetData>{}</sheetData>"
        ),
    ),
    "attributes": lambda: (
        "a.xlsx",
        book("<row " + " ".join(f'a{at}=""' for at in range(1_000_000)) + "/>"),
    ),
    "depth": lambda: ("a.xlsx", book("<x>" * 800_000 + "</x>" * 800_000)),
    "parts": lambda: ("a.xlsx", _parts(5_000)),
    "entities": lambda: ("a.xlsx", book('<!DOCTYPE a [<!ENTITY b "b">]><row/>')),
    "empty lines": lambda: ("a.csv", b"id,lat,lon\na,60,24\nb,61,25\n" + b"\n" * 15_000_000),
    "lines of a space": lambda: ("a.csv", b"id,lat,lon\na,60,24\nb,61,25\n" + b" \n" * 8_000_000),
    "lines of commas": lambda: ("a.csv", b"id,lat,lon\na,60,24\nb,61,25\n" + b",,\n" * 5_000_000),
    "one line of commas": lambda: ("a.csv", b"id,lat,lon\na,60,24\n" + b"," * 15_000_000),
    "one line of ones": lambda: ("a.csv", b"1," * 7_000_000 + b"1\n"),
    "short rows below a wide heading": lambda: (
        "a.csv",
        ",".join(f"a{at}" for at in range(16_000)).encode() + b"\n" + b"1\n" * 500_000,
    ),
    "wide heading": lambda: ("a.csv", b"lat," * 2_000_000 + b"lon\n" + b"1," * 2_000_000 + b"1\n"),
    "lines of words": lambda: ("a.txt", b"a b 1\n" * 2_500_000),
    "rules": lambda: ("a.txt", b"|--|\n" * 3_000_000),
    "long rule": lambda: ("a.txt", b"|a|b|\n" + b"-|" * 7_000_000 + b"x\n|1|2|"),
    "spaces": lambda: ("a.txt", b"a|b\n" + b" " * 15_000_000 + b"x\n--|--\n"),
    "records": lambda: (
        "a.json",
        ("[" + ",".join(f'{{"a{at}":1}}' for at in range(100_000)) + "]").encode(),
    ),
    "tsplib lines": lambda: ("a.tsp", b"DIMENSION: 5\n" + b"\n" * 15_000_000),
    "tsplib words": lambda: (
        "a.tsp",
        b"DIMENSION: 5\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n" + b"1 " * 8_000_000,
    ),
    "yaml": lambda: (
        "map.yaml",
        b"image: a.pgm\nresolution: 0.1\norigin: [0,0,0]\n" + b"a: 1\n" * 200_000,
    ),
    "yaml aliases": lambda: (
        "map.yaml",
        (
            "a0: &a0 [x]\n"
            + "".join(f"a{i}: &a{i} [{','.join([f'*a{i - 1}'] * 10)}]\n" for i in range(1, 10))
        ).encode(),
    ),
    "octile": lambda: ("a.map", b"type octile\nheight 5\nwidth 5\nmap\n" + b"\n" * 15_000_000),
    "unclosed quote": lambda: ("a.csv", b'id,lat,lon\n"' + b"a\n" * 7_000_000),
    "quotes": lambda: ("a.csv", b"id,lat,lon\n" + b'""' * 5_000_000 + b",1,2\n"),
    "digits": lambda: ("a.csv", b"id,lat,lon\n" + (b"1" * 100_000 + b"x,60,24\n") * 100),
    "digits of a place": lambda: ("a.csv", b"id,place\n" + (b"a," + b"1" * 100_000 + b"x\n") * 100),
    "spaces in times": lambda: (
        "a.csv",
        b"id,lat,lon,window\n" + (b"a,60,24,8" + b" " * 100_000 + b"x\n") * 100,
    ),
    "brackets in a heading": lambda: ("a.csv", b"id,lat,lon," + b"(" * 100_000 + b"\na,60,24,1\n"),
    "crs": lambda: (
        "a.geojson",
        b'{"type":"FeatureCollection","features":[],"crs":{"properties":{"name":"'
        + b"OGC:" * 1_000_000
        + b'"}}}',
    ),
    "objects": lambda: ("a.json", b'{"vehicles":[],"jobs":[' + b"{}," * 5_000_000 + b"{}]}"),
    "sums": lambda: (
        "a.csv",
        b"id,lat,lon,qty\na,60,24,1\nb,60,25,1\n"
        + b"c,,,0\n" * 60_000
        + b"".join(b"d,,,%d\n" % 2**at for at in range(1, 400)),
    ),
    "boundaries": lambda: ("a.csv", b"--boundary\r\n" * 400_000),
    "legacy": lambda: ("a.csv", b"\xe9,\xe8\n" * 3_000_000),
}
