"""Small files that would keep a reader busy for long: each is made by a function of its size."""

import io
import zipfile
from collections.abc import Callable, Iterable, Mapping

MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE = "http://schemas.openxmlformats.org/package/2006/relationships"
TABLE = (
    '<row r="1"><c r="A1" t="inlineStr"><is><t>id</t></is></c>'
    '<c r="B1" t="inlineStr"><is><t>lat</t></is></c><c r="C1" t="inlineStr"><is><t>lon</t></is></c>'
    '</row><row r="2"><c r="A2" t="inlineStr"><is><t>a</t></is></c><c r="B2"><v>60.1</v></c>'
    '<c r="C2"><v>24.9</v></c></row><row r="3"><c r="A3" t="inlineStr"><is><t>b</t></is></c>'
    '<c r="B3"><v>60.2</v></c><c r="C3"><v>24.8</v></c></row>'
)


def book(
    rows: str = TABLE,
    *,
    sheets: Iterable[str] = ("Sheet1",),
    names: str = "",
    more: Mapping[str, str] | None = None,
    around: str = "<sheetData>{}</sheetData>",
) -> bytes:
    """Return a spreadsheet whose sheets all have these rows.

    Args:
        rows: The elements of rows.
        sheets: The names of its sheets.
        names: The elements of defined names.
        more: Further parts, such as `xl/styles.xml`, by their names.
        around: What stands around the rows in a sheet.
    """
    more = dict(more or {})
    titles = list(sheets)
    listed = "".join(
        f'<sheet name="{name}" sheetId="{at}" r:id="rId{at}"/>' for at, name in enumerate(titles, 1)
    )
    kinds = {"xl/styles.xml": "styles", "xl/sharedStrings.xml": "sharedStrings"}
    related = "".join(
        f'<Relationship Id="rId{at}" Type="{OFFICE}/worksheet" Target="worksheets/sheet{at}.xml"/>'
        for at in range(1, 1 + len(titles))
    ) + "".join(
        f'<Relationship Id="x{at}" Type="{OFFICE}/{kinds[part]}" Target="{part[3:]}"/>'
        for at, part in enumerate(more)
        if part in kinds
    )
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr(
            "_rels/.rels",
            f'<Relationships xmlns="{PACKAGE}"><Relationship Id="rId1"'
            f' Type="{OFFICE}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        )
        file.writestr(
            "xl/workbook.xml",
            f'<workbook xmlns="{MAIN}" xmlns:r="{OFFICE}"><sheets>{listed}</sheets>'
            f"<definedNames>{names}</definedNames></workbook>",
        )
        file.writestr(
            "xl/_rels/workbook.xml.rels",
            f'<Relationships xmlns="{PACKAGE}">{related}</Relationships>',
        )
        for at in range(1, 1 + len(titles)):
            sheet = f'<worksheet xmlns="{MAIN}">' + around.replace("{}", rows) + "</worksheet>"
            file.writestr(f"xl/worksheets/sheet{at}.xml", sheet)
        for part, text in more.items():
            file.writestr(part, text)
    return made.getvalue()


def _texts(count: int, text: str) -> dict[str, str]:
    items = f"<si><t>{text}</t></si>" * count
    return {"xl/sharedStrings.xml": f'<sst xmlns="{MAIN}">{items}</sst>'}


def _styles(count: int) -> dict[str, str]:
    cells = '<xf numFmtId="0"/>' * count
    return {"xl/styles.xml": f'<styleSheet xmlns="{MAIN}"><cellXfs>{cells}</cellXfs></styleSheet>'}


def _parts(count: int) -> bytes:
    return book(more={f"docProps/{at}.xml": "" for at in range(count)})


HOSTILE: Mapping[str, Callable[[], tuple[str, bytes]]] = {
    "empty rows": lambda: ("a.xlsx", book(TABLE + "<row/>" * 4_000_000)),
    "sheets": lambda: ("a.xlsx", book("", sheets=map(str, range(1, 10_001)))),
    "styles": lambda: ("a.xlsx", book(more=_styles(1_000_000))),
    "names": lambda: ("a.xlsx", book(names='<definedName name="a">1</definedName>' * 1_000_000)),
    "a row of cells": lambda: ("a.xlsx", book(f"<row>{'<c/>' * 5_000_000}</row>")),
    "a row of numbers": lambda: ("a.xlsx", book(f"<row>{'<c><v>1</v></c>' * 2_000_000}</row>")),
    "strings": lambda: ("a.xlsx", book(more=_texts(1_000_000, "a" * 100))),
    "a long string": lambda: ("a.xlsx", book(more=_texts(1, "a" * 120_000_000))),
    "runs of a string": lambda: (
        "a.xlsx",
        book(more={"xl/sharedStrings.xml": f'<sst xmlns="{MAIN}"><si>{"<r><t>a</t></r>" * 2_000_000}</si></sst>'}),
    ),
    "merged cells": lambda: (
        "a.xlsx",
        book(around="<sheetData>{}</sheetData><mergeCells>" + '<mergeCell ref="A1:B2"/>' * 2_000_000 + "</mergeCells>"),
    ),
    "columns": lambda: (
        "a.xlsx",
        book(around="<cols>" + '<col min="1" max="16384"/>' * 2_000_000 + "</cols><sheetData>{}</sheetData>"),
    ),
    "attributes": lambda: (
        "a.xlsx",
        book("<row " + " ".join(f'a{at}=""' for at in range(1_000_000)) + "/>"),
    ),
    "depth": lambda: ("a.xlsx", book("<x>" * 3_000_000 + "</x>" * 3_000_000)),
    "far row": lambda: ("a.xlsx", book(TABLE + '<row r="1048576"><c r="XFD1048576"><v>1</v></c></row>')),
    "parts": lambda: ("a.xlsx", _parts(20_000)),
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
        ("a0: &a0 [x]\n" + "".join(f"a{i}: &a{i} [{','.join([f'*a{i-1}'] * 10)}]\n" for i in range(1, 10))
        ).encode(),
    ),
    "octile": lambda: ("a.map", b"type octile\nheight 5\nwidth 5\nmap\n" + b"\n" * 15_000_000),
    "unclosed quote": lambda: ("a.csv", b'id,lat,lon\n"' + b"a\n" * 7_000_000),
    "quotes": lambda: ("a.csv", b"id,lat,lon\n" + b'""' * 5_000_000 + b",1,2\n"),
    "legacy": lambda: ("a.csv", b"\xe9,\xe8\n" * 3_000_000),
}
