"""What people have in spreadsheets, and what each sheet, row and cell must become."""

import io
import re
from collections.abc import Sequence
from typing import Any

import openpyxl
import pytest

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile
from tests.files.xlsx import MAIN, TABLE, book, rows_of, styles_of

PLACED = ("id", "lat", "lon")
ORDERS = [("a", 60.1, 24.9), ("b", 60.2, 24.8)]
VANS = rows_of(("van", "capacity", "shift start", "shift end"), ("V1", 5, "8:00", "16:00"))
README = rows_of(("How to use this file",), ("Fill in the sheet of orders",))
LEGEND = rows_of(("Column", "Meaning"), ("qty", "pieces"), ("from", "when it opens"))
FORMULA = "<c><f>1+1</f><v/></c>"


def read(data: bytes, *others: tuple[str, bytes]) -> Reading:
    files = [NamedFile("a.xlsx", data), *(NamedFile(*each) for each in others)]
    return read_files(files, Bounds(), wanted=None)


def cells_as(formats: Sequence[str], *values: object, **more: Any) -> list[str]:
    """The texts of cells of one row with these number formats, as a column of details has them."""
    cells = [f'<c s="{at + 1}"><v>{value}</v></c>' for at, value in enumerate(values)]
    names = [f"note {at}" for at in range(len(values))]
    rows = rows_of((*PLACED, *names), ("a", 60.1, 24.9, *cells), ("b", 60.2, 24.8))
    details = read(book(rows, more=styles_of("General", *formats), **more)).details
    return [each.texts[0] for each in details]


@pytest.mark.parametrize(
    ("code", "number", "text"),
    [
        ("General", "0.5", "0.5"),
        ("General", "6.0171000000000003E1", "60.1710"),
        ("General", "60.170999999999999", "60.1710"),
        ("General", "7", "7"),
        ("General", "7.0", "7"),
        ("General", "12345678901234567", "12345678901234567"),
        ("General", "1.2345678901234568E16", "12345678901234568"),
        ("General", "-3", "-3"),
        ("0.00", "1250", "1250"),
        ("00000", "123", "00123"),
        ("0", "0", "0"),
        ("h:mm", "0.375", "09:00:00"),
        ("h:mm", "0.4583333333333333", "11:00:00"),
        ("hh:mm:ss", "0.99999999", "24:00:00"),
        ("h:mm AM/PM", "0.5625", "13:30:00"),
        ("h:mm", "1.0833333333333333", "26:00:00"),
        ("[h]:mm", "1.0833333333333333", "26:00:00"),
        ("[h]:mm", "0.375", "9:00:00"),
        ("[hh]:mm:ss", "2.5", "60:00:00"),
        ("[mm]:ss", "0.0104166666666667", "0:15:00"),
        ("yyyy-mm-dd", "46000", "2025-12-09"),
        ("yyyy-mm-dd", "46000.375", "2025-12-09 09:00:00"),
        ("d.m.yy h:mm", "46000", "2025-12-09 00:00:00"),
        ("mmm", "46000", "2025-12-09"),
        ("dd/mm/yyyy", "59", "1900-02-28"),
        ("dd/mm/yyyy", "61", "1900-03-01"),
        ("h:mm", "46000.375", "2025-12-09 09:00:00"),
        ("yyyy-mm-dd", "-1", "-1"),
        ("yyyy-mm-dd", "99999999", "99999999"),
        ("0.0 &quot;h&quot;", "1.5", "1.5"),
        ("[Red]0.0", "1.5", "1.5"),
        ("[$-409]d mmm yyyy", "46000", "2025-12-09"),
        ("#,##0\\ &quot;days&quot;", "46000", "46000"),
        ("0.00E+00", "1.5", "1.5"),
        ("General", "north", "north"),
    ],
)
def test_a_number_is_what_its_format_shows(code: str, number: str, text: str) -> None:
    assert cells_as([code], number) == [text]


def test_dates_may_begin_in_1904() -> None:
    names = '<workbookPr date1904="1"/>'
    assert cells_as(["yyyy-mm-dd"], "44538", names=names) == ["2025-12-09"]


def fields(*cells: str) -> bytes:
    return book(rows_of((*PLACED, "note"), ("a", 60.1, 24.9, *cells), ("b", 60.2, 24.8)))


@pytest.mark.parametrize(
    ("cell", "text"),
    [
        ('<c t="inlineStr"><is><t>00123</t></is></c>', "00123"),
        ('<c t="inlineStr"><is><t>12345678901234567</t></is></c>', "12345678901234567"),
        ('<c t="inlineStr"><is><r><t>ring </t></r><r><t>twice</t></r></is></c>', "ring twice"),
        ('<c t="inlineStr"><is><t>木</t><rPh sb="0" eb="1"><t>き</t></rPh></is></c>', "木"),
        ('<c t="str"><f>A1&amp;"x"</f><v>ax</v></c>', "ax"),
        ('<c t="str"><f>IF(1=1,"","x")</f><v></v></c>', ""),
        ('<c t="b"><v>1</v></c>', "True"),
        ('<c t="d"><v>2026-11-22T09:30:00</v></c>', "2026-11-22 09:30:00"),
        ("<c><f>1+1</f><v>2</v></c>", "2"),
        ("<c/>", ""),
    ],
)
def test_a_cell_is_read_as_text(cell: str, text: str) -> None:
    details = read(fields(cell)).details
    assert [each.texts[0] for each in details] == ([text] if text else [])


def shared(rows: str) -> bytes:
    texts = "".join(f"<si><t>{each}</t></si>" for each in ("id", "lat", "lon", "a", "b"))
    return book(rows, more={"xl/sharedStrings.xml": f'<sst xmlns="{MAIN}">{texts}</sst>'})


def prefixed(data: str) -> str:
    return re.sub(r"<(/?)(\w)", r"<\1x:\2", data)


@pytest.mark.parametrize(
    "data",
    [
        book(),
        shared(
            rows_of(
                [f'<c t="s"><v>{at}</v></c>' for at in range(3)],
                ['<c t="s"><v>3</v></c>', 60.1, 24.9],
                ['<c t="s"><v>4</v></c>', 60.2, 24.8],
            )
        ),
        book(TABLE.replace(' r="', ' q="')),  # without the places of cells
        book(f"<x:a xmlns:x='{MAIN}'>{prefixed(TABLE)}</x:a>"),
        book(TABLE + '<row r="1048576"><c r="XFD1048576" s="3"/></row>'),
        book(rows_of((None, None, *PLACED), *((None, None, *each) for each in ORDERS), first=5)),
    ],
    ids=["plain", "shared", "no places", "prefixed", "empty cell far away", "moved"],
)
def test_programs_write_one_table_in_many_ways(data: bytes) -> None:
    assert read(data).request["stops"] == [
        {"id": "a", "location": [24.9, 60.1]},
        {"id": "b", "location": [24.8, 60.2]},
    ]


@pytest.mark.parametrize(
    ("rows", "sheets", "which", "note"),
    [
        ([TABLE], ["S"], "ab", None),
        (["", TABLE], ["Blank", "S"], "ab", "Only the sheet 'S' of 2 was read."),
        ([README, TABLE], ["Read me", "S"], "ab", "Only the sheet 'S' of 2 was read."),
        ([LEGEND, TABLE], ["Legend", "S"], "ab", "Only the sheet 'S' of 2 was read."),
        ([README, "", TABLE], ["Read me", "X", "S"], "ab", "Only the sheet 'S' of 3 was read."),
        ([TABLE, README], ["S", "Read me"], "ab", "Only the sheet 'S' of 2 was read."),
        (
            [rows_of(("Total", "Amount"), ("pieces", 9), ("kg", 8)), TABLE],
            ["Sum", "S"],
            "ab",
            "Only the sheet 'S' of 2 was read.",
        ),
        (
            [TABLE, TABLE.replace(">a<", ">c<")],
            ["Monday", "Tuesday"],
            "ab",
            "Only the sheet 'Monday' of 2 was read.",
        ),
    ],
)
def test_the_sheet_with_the_table_is_read(
    rows: list[str], sheets: list[str], which: str, note: str | None
) -> None:
    reading = read(book(rows, sheets=sheets))
    assert [stop["id"] for stop in reading.request["stops"]] == list(which)
    assert [each.text for each in reading.notes if each.code == "sheet"] == [note] * bool(note)


def test_hidden_sheets_are_not_read() -> None:
    data = book([TABLE.replace(">a<", ">c<"), TABLE], sheets=["Old", "S"], state={"Old": "hidden"})
    assert [stop["id"] for stop in read(data).request["stops"]] == ["a", "b"]
    with pytest.raises(UnreadableFile, match="must have a sheet with rows that is not hidden"):
        read(book(state={"Sheet1": "veryHidden"}))


@pytest.mark.parametrize("sheets", [["Orders", "Vans"], ["Vans", "Orders"]])
def test_a_sheet_of_vehicles_makes_it_a_fleet(sheets: list[str]) -> None:
    rows = {"Orders": TABLE, "Vans": VANS}
    reading = read(book([rows[each] for each in sheets], sheets=sheets))
    assert reading.kind == "fleet"
    [van] = reading.request["vehicles"]
    assert van == {"id": "V1", "start": "a", "end": "a", "shift": [28800, 57600]} | {
        k: van[k] for k in ("capacity",) if k in van
    }
    assert {each.file for each in reading.columns} == {"a.xlsx", "a.xlsx [Vans]"}


def test_columns_of_the_sheet_of_vehicles_can_be_chosen() -> None:
    from service.files.chosen import with_chosen

    data = book([TABLE, VANS], sheets=["Orders", "Vans"])
    part = b'[{"file":"a.xlsx [Vans]","name":"capacity","taken_for":"ignored"}]'
    [file] = with_chosen([NamedFile("a.xlsx", data)], part)
    reading = read_files([file], Bounds(), wanted=None)
    assert "capacity" not in reading.request["vehicles"][0]


def test_faults_in_both_sheets_are_told_with_their_sheet() -> None:
    orders = rows_of(PLACED, ("a", "north", 24.9), ("b", 60.2, 24.8))
    vans = rows_of(("van", "max stops"), ("V1", "many"))
    with pytest.raises(UnreadableFile) as refused:
        read(book([orders, vans], sheets=["Orders", "Vans"]))
    first, second = (fault.detail for fault in refused.value.faults)
    assert first == "a.xlsx: row 2, column 'lat' must be a number, got 'north'"
    assert second.startswith("a.xlsx [Vans]: row 2, column 'max stops' must be")


def around(columns: str = "", rows: str = TABLE) -> bytes:
    return book(rows, around=f"<cols>{columns}</cols><sheetData>{{}}</sheetData>")


HIDDEN = TABLE.replace('<row r="2"', '<row r="2" hidden="1"')


@pytest.mark.parametrize(
    ("data", "note"),
    [
        (around(rows=HIDDEN), "Row 2 is hidden in the sheet 'Sheet1', and read as well"),
        (around('<col min="2" max="2" hidden="1"/>'), "Column B is hidden in the sheet"),
        (around('<col min="2" max="3" hidden="1"/>', HIDDEN), "Row 2 and columns B, C are hidden"),
        (around('<col min="4" max="16384" hidden="1"/>'), None),
        (around('<col min="1" max="3" hidden="0"/>'), None),
        (around(rows=TABLE + '<row r="9" hidden="1"/>'), None),
    ],
)
def test_what_is_hidden_is_read_with_a_note(data: bytes, note: str | None) -> None:
    reading = read(data)
    assert len(reading.request["stops"]) == 2
    notes = [each.text for each in reading.notes if each.code == "hidden"]
    assert notes == [] if note is None else notes[0].startswith(note), notes


def with_formulas(*cells: str, names: str = "") -> bytes:
    rows = rows_of((*PLACED, "qty"), *((*o, c) for o, c in zip(ORDERS, cells, strict=True)))
    return book(rows, names=names)


LATER = '<calcPr fullCalcOnLoad="1"/>'
ZERO = "<c><f>1-1</f><v>0</v></c>"


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (with_formulas(FORMULA, FORMULA), "Cells D2, D3 have no stored result"),
        (with_formulas("<c><f>1</f></c>", "<c><v>1</v></c>"), "Cell D2 has no stored result"),
        (with_formulas(ZERO, ZERO, names=LATER), "Each formula in the sheet 'Sheet1' has the"),
    ],
)
def test_formulas_without_stored_results_are_refused(data: bytes, sentence: str) -> None:
    with pytest.raises(UnreadableFile, match=re.escape(sentence)) as refused:
        read(data)
    assert "open the file in a spreadsheet program and save it" in str(refused.value)


def test_results_of_formulas_are_read() -> None:
    for data in (
        with_formulas(ZERO, "<c><f>1+1</f><v>2</v></c>", names=LATER),
        with_formulas(ZERO, ZERO),
    ):
        assert read(data).request["stops"][0]["id"] == "a"


def test_formulas_as_openpyxl_writes_them_are_refused() -> None:
    made = openpyxl.Workbook()
    for row in [(*PLACED, "qty"), ("a", 60.1, 24.9, 0), ("b", 60.2, 24.8, "=1+1")]:
        made.active.append(row)
    data = io.BytesIO()
    made.save(data)
    with pytest.raises(UnreadableFile, match="Cell D3 has no stored result"):
        read(data.getvalue())


def test_ids_of_more_digits_than_a_spreadsheet_keeps_are_noted() -> None:
    rows = rows_of(PLACED, (12345678901234567, 60.1, 24.9), ("98765432109876543", 60.2, 24.8))
    reading = read(book(rows))
    ids = [stop["id"] for stop in reading.request["stops"]]
    assert ids == ["12345678901234567", "98765432109876543"]
    assert [each.text for each in reading.notes if each.code == "digits"] == [
        "Cell A2 has more than 15 digits, which a spreadsheet does not keep: format ids as text."
    ]


HEADINGS = [
    (["Order", "Place", "", "Visit"], ["Id", "Lat", "Lon", "Minutes"], "names"),
    (["Id", "Lat", "Lon", "Service"], ["", "deg", "deg", "min"], "units"),
    (["Id", "Lat", "Lon", "Service"], ["", "[deg]", "[deg]", "(min)"], "units"),
    (["Customer", "Lat", "Lon", ""], ["", "", "", "Minutes"], "units"),
    (["Customer", "Position", "", "Visit"], ["", "Latitude", "Longitude", "Minutes"], "names"),
]


@pytest.mark.parametrize(("first", "second", "kind"), HEADINGS)
def test_two_rows_of_headings_are_joined(first: list[str], second: list[str], kind: str) -> None:
    rows = rows_of(first, second, ("a", 60.1, 24.9, 5), ("b", 60.2, 24.8, 7))
    reading = read(book(rows))
    assert reading.request["stops"][1]["service"] == 420
    [note] = [each.text for each in reading.notes if each.code == "heading"]
    assert note.startswith(f"Row 2 was taken for {kind} below the heading: ")


@pytest.mark.parametrize(
    "rows",
    [
        [("id", "lat", "lon"), ("a", "north", "east"), ("b", 60.2, 24.8)],
        [("id", "lat", "lon"), ("a", "lat", "x"), ("b", 60.2, 24.8)],
    ],
)
def test_a_row_of_wrong_cells_is_no_heading(rows: list[tuple[object, ...]]) -> None:
    with pytest.raises(UnreadableFile, match="row 2, column 'lat' must be a number"):
        read(book(rows_of(*rows)))


def other_zip(name: str) -> bytes:
    import zipfile

    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as file:
        file.writestr(name, "x")
    return made.getvalue()


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (other_zip("content.xml"), "got an OpenDocument file (.ods)"),
        (other_zip("xl/workbook.bin"), "got a binary spreadsheet (.xlsb)"),
        (other_zip("Index/Document.iwa"), "got a file of Numbers"),
        (other_zip("word/document.xml"), "got a document of Word"),
        (other_zip("doc.kml"), "got KMZ"),
        (other_zip("orders.csv"), "got another zip file: unpack it first"),
        (b"PK\x03\x04", "must be XLSX"),
        (book()[:-30], "must be XLSX"),
        (book("<row><c"), "must be XLSX: xl/worksheets/sheet1.xml"),
        (book(""), "must have a sheet with rows"),
        (book(TABLE + '<row r="3"><c r="A3"><v>1</v></c></row>'), "cell A3 must come once"),
        (book(TABLE + '<row><c t="s"><v>7</v></c></row>'), "must have the shared text 7 of a"),
        (book(TABLE + '<row><c t="s"><v>x</v></c></row>'), "cell A4 must be a shared text, got"),
        (book(rows_of(PLACED)), "must have a row for each stop below its heading"),
    ],
)
def test_what_is_no_table_is_refused(data: bytes, sentence: str) -> None:
    with pytest.raises(UnreadableFile, match=re.escape(sentence)):
        read(data)
