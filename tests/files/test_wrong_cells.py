"""Tables with several wrong cells: each is named once, row by row, and many are counted."""

from collections.abc import Sequence

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from service.files.reader import read_files
from service.files.reading import MOST_WRONG, Bounds, NamedFile, UnreadableFile, WrongCell

STOPS = {  # by column, what a cell may be, and what it may not be
    "id": ("", ("",)),
    "lat": ("60,1", ("north", "", "97", "6O.1")),
    "lon": ("24,9", ("east", "-181", "1e999")),
    "qty": ("2", ("two", "-1", "2.00001")),
    "from": ("8:00", ("early", "-3")),
    "to": ("9:00", ("late", "7:00 sharp")),
    "window 2": ("10:00-11:00", ("10:00", "x-y", "11:00-10:30")),
    "service": ("5 min", ("long", "-5")),
    "due": ("12:00", ("noon",)),
    "vehicle": ("Kim", ("nobody",)),
}
VANS = {
    "vehicle": ("", ("",)),
    "capacity": ("5000", ("big", "-1")),
    "initial load": ("1", ("some", "9999")),
    "shift": ("8:00-17:00", ("8:00", "soon-late")),
    "start": ("S2", ("nowhere",)),
    "fixed": ("3", ("free",)),
    "overtime": ("10 min", ("much",)),
    "reload": ("S3", ("S3 | nowhere",)),
    "max trips": ("2", ("0", "many")),
}
ROWS = 5
# Names that other cells refer to: these would be wrong as well.
NAMED = (("orders.csv", 3, "id"), ("orders.csv", 4, "id"), ("vans.csv", 2, "vehicle"))


def table(columns: dict[str, tuple[str, tuple[str, ...]]], names: Sequence[str]) -> list[list[str]]:
    right = [right for right, _ in columns.values()]
    return [[*columns], *([name, *right[1:]] for name in names)]


def reading_of(*tables: tuple[str, list[list[str]]]) -> UnreadableFile | None:
    files = [NamedFile(name, "\n".join(map(";".join, rows)).encode()) for name, rows in tables]
    try:
        read_files(files, Bounds(), wanted=None)
    except UnreadableFile as error:
        return error
    return None


def cells_in(error: UnreadableFile) -> list[str]:
    return [fault.detail for fault in error.faults] if isinstance(error, WrongCell) else []


@st.composite
def places(draw: st.DrawFn) -> dict[tuple[str, int, str], str]:
    """Wrong texts by the file, the row and the column."""
    cells = [
        (file, row, name)
        for file, columns in (("orders.csv", STOPS), ("vans.csv", VANS))
        for row in range(2, 2 + (ROWS if columns is STOPS else 2))
        for name in columns
        if (file, row, name) not in NAMED
    ]
    chosen = draw(st.lists(st.sampled_from(cells), unique=True, max_size=12))
    known = {"orders.csv": STOPS, "vans.csv": VANS}
    return {
        (file, row, name): draw(st.sampled_from(known[file][name][1]))
        for file, row, name in sorted(chosen, key=cells.index)
    }


@given(places())
@example({})
@example({("orders.csv", 2, "window 2"): "x-y", ("vans.csv", 2, "shift"): "8:00"})
@example({("vans.csv", 2, "capacity"): "big", ("vans.csv", 3, "start"): "nowhere"})
@example({("orders.csv", 2, "lat"): "97", ("orders.csv", 2, "lon"): "-181"})
@example({("vans.csv", 2, "capacity"): "big", ("vans.csv", 2, "initial load"): "9999"})
def test_each_wrong_cell_is_named_once_in_the_order_of_rows(
    wrong: dict[tuple[str, int, str], str],
) -> None:
    tables = {
        "orders.csv": table(STOPS, [f"S{row}" for row in range(1, ROWS + 1)]),
        "vans.csv": table(VANS, ["Kim", "Lee"]),
    }
    for (file, row, name), text in wrong.items():
        tables[file][row - 1][tables[file][0].index(name)] = text
    error = reading_of(*tables.items())
    if not wrong:
        assert error is None
        return
    assert error is not None
    expected = [
        f"{file}: row {row}, column '{name}' "
        for (file, row, name), text in wrong.items()
        # Whether that is too much, a wrong capacity does not say.
        if not (text == "9999" and (file, row, "capacity") in wrong)
    ]
    assert len(cells_in(error)) == len(expected), cells_in(error)
    for sentence, begin in zip(cells_in(error), expected, strict=True):
        assert sentence.startswith(begin)
    more = f" (and {len(expected) - 1} more)" if len(expected) > 1 else ""
    assert str(error) == f"{cells_in(error)[0]}{more}"


def test_costs_between_stops_and_of_a_metre_are_named_with_all_others() -> None:
    matrix = [["", "a", "b"], ["a", "0", "far"], ["b", "near", "0"]]
    error = reading_of(("one.csv", matrix), ("two.csv", matrix))
    assert error is not None
    assert [each.split(" must")[0] for each in cells_in(error)] == [
        f"{file}: row {row}, column '{name}'"
        for file in ("one.csv", "two.csv")
        for row, name in ((2, "b"), (3, "a"))
    ][: len(cells_in(error))]
    assert len(cells_in(error)) == 4
    priced = [["id", "lat", "lon", "cost"], ["a", "60", "24", "-1"], ["b", "61", "x", "-2"]]
    error = reading_of(("priced.csv", priced))
    assert error is not None
    assert [each[12:17] for each in cells_in(error)] == ["row 2", "row 3", "row 3"]


@pytest.mark.parametrize("wrong", [MOST_WRONG - 1, MOST_WRONG, 3 * MOST_WRONG])
def test_more_wrong_cells_than_are_counted_are_at_least_so_many(wrong: int) -> None:
    rows = [
        ["id", "lat", "lon"],
        ["a", "60.1", "24.9"],
        *([f"s{at}", "?", "24"] for at in range(wrong)),
    ]
    error = reading_of(("many.csv", rows))
    assert error is not None
    counted = min(wrong, MOST_WRONG)
    least = "at least " if wrong >= MOST_WRONG else ""
    assert len(cells_in(error)) == counted
    assert str(error).startswith("many.csv: row 3, column 'lat'")
    assert str(error).endswith(f"got '?' (and {least}{counted - 1} more)")


@pytest.mark.parametrize(
    ("rows", "sentence"),
    [
        (
            [["id", "lat", "lon"], ["a", "north", "24.9"], ["b", "60", "east", "1"]],
            "row 3 must have 3",
        ),
        ([["id", "town"], ["a", "Turku"], ["b", ""]], "must say where each stop is"),
    ],
)
def test_what_makes_the_cells_meaningless_comes_alone(rows: list[list[str]], sentence: str) -> None:
    error = reading_of(("orders.csv", rows))
    assert error is not None
    assert sentence in str(error)
    assert not cells_in(error)
