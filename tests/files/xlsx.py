"""Make spreadsheets as XML in a zip file, with what no library writes."""

import io
import zipfile
from collections.abc import Iterable, Mapping, Sequence

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

SHARED = TABLE + '<row r="4"><c r="A4" t="s"><v>0</v></c></row>'


def rows_of(*rows: Iterable[object], first: int = 1) -> str:
    """Return the elements of rows; a text that begins with `<` is an element of a cell itself."""
    return "".join(
        f'<row r="{number}">{"".join(_cell(each) for each in row)}</row>'
        for number, row in enumerate(rows, first)
    )


def _cell(value: object) -> str:
    if value is None:
        return "<c/>"
    if isinstance(value, str):
        return value if value.startswith("<") else f'<c t="inlineStr"><is><t>{value}</t></is></c>'
    return f"<c><v>{value}</v></c>"


def styles_of(*formats: str) -> dict[str, str]:
    """Return the part of styles whose cells have these number formats, from style 0 on."""
    codes = "".join(
        f'<numFmt numFmtId="{200 + at}" formatCode="{code}"/>' for at, code in enumerate(formats)
    )
    cells = "".join(f'<xf numFmtId="{200 + at}"/>' for at in range(len(formats)))
    inside = f"<numFmts>{codes}</numFmts><cellXfs>{cells}</cellXfs>"
    return {"xl/styles.xml": f'<styleSheet xmlns="{MAIN}">{inside}</styleSheet>'}


def book(
    rows: str | Sequence[str] = TABLE,
    *,
    sheets: Iterable[str] = ("Sheet1",),
    names: str = "",
    more: Mapping[str, str] | None = None,
    around: str = "<sheetData>{}</sheetData>",
    state: Mapping[str, str] | None = None,
) -> bytes:
    """Return a spreadsheet whose sheets all have these rows.

    Args:
        rows: The elements of rows; or of each sheet.
        sheets: The names of its sheets.
        names: Elements of the workbook after its sheets.
        more: Further parts, such as `xl/styles.xml`, by their names.
        around: What stands around the rows in a sheet.
        state: Whether a sheet is hidden, by its name.
    """
    more = dict(more or {})
    titles = list(sheets)
    listed = "".join(
        f'<sheet name="{name}" sheetId="{at}" r:id="rId{at}"'
        f' state="{(state or {}).get(name, "visible")}"/>'
        for at, name in enumerate(titles, 1)
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
            f"{names}</workbook>",
        )
        file.writestr(
            "xl/_rels/workbook.xml.rels",
            f'<Relationships xmlns="{PACKAGE}">{related}</Relationships>',
        )
        for at in range(1, 1 + len(titles)):
            own = rows if isinstance(rows, str) else rows[at - 1]
            sheet = f'<worksheet xmlns="{MAIN}">' + around.replace("{}", own) + "</worksheet>"
            file.writestr(f"xl/worksheets/sheet{at}.xml", sheet)
        for part, text in more.items():
            file.writestr(part, text)
    return made.getvalue()
