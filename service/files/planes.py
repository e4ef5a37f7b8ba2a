"""Take columns of numbers for x and y of planes: as they are called, or chosen, or pasted alone."""

import re
from collections.abc import Sequence

from service.files.column_names import PLANES
from service.files.columns import Columns
from service.files.reading import UnreadableFile, quoted
from service.files.tables import number_in, plain_numbers

_MOST_ALIKE = 10  # how much wider the widest column of pasted planes may be than the narrowest
_EXACT = re.compile(r"[.,]\d{3}", re.ASCII)  # half of the degrees of a pasted place, or more
_LONGEST_COUNT = 15  # digits of a number of a row


def called_planes(columns: Columns) -> list[tuple[int, int]]:
    """Return the columns of x and y of each plane, by what they are called or chosen to be."""
    fields = columns.fields
    pairs = [
        (fields.index(x), fields.index(y))
        for x, y in zip(PLANES[::2], PLANES[1::2], strict=True)
        if x in fields and y in fields
    ]
    used = {at for pair in pairs for at in pair}
    free = [at for at, each in enumerate(fields) if each is None and at not in used]
    names = {_folded(columns.names[at]): at for at in free}
    for name, at in names.items():
        other = next((names[each] for each in _partners(name) if each in names), None)
        if other is not None and columns.have_numbers(at) and columns.have_numbers(other):
            pairs.append((at, other))
    chosen = [pair for pair in pairs if columns.is_chosen(pair[0])]
    return chosen + sorted(pair for pair in pairs if pair not in chosen)


def _folded(name: str) -> str:
    return re.sub(r"\s+", "", name.casefold())


def _partners(name: str) -> list[str]:
    """Return the names that a column of y has beside this one of x."""
    named = [f"{name[:at]}y{name[at + 1 :]}" for at, each in enumerate(name) if each == "x"]
    return ["v", *named] if name == "u" else named


def pasted_planes(columns: Columns, free: Sequence[int]) -> list[tuple[int, int]]:
    """Return x and y of planes in four, six or eight columns without names, if they are alike.

    They are not if the first one counts rows, two are degrees, or one is far wider than another:
    then they may be anything else.
    """
    if len(free) not in (4, 6, 8) or not is_nameless(columns) or columns.are_any_chosen:
        return []
    counted = [at for at, field in enumerate(columns.fields) if field == "id"] + [free[0]]
    if any(count_rows(columns, at) for at in counted) or degrees_in(columns, free):
        return []
    widths = []
    for at in free:
        numbers = [each for each in _numbers(columns, at) if each is not None]
        widths.append(max(numbers) - min(numbers) if numbers else 0.0)
    if len(columns.table.rows) > 1 and max(widths) > _MOST_ALIKE * min(widths):
        return []
    count = len(free) // 2
    columns.source.note(
        "planes", f"{len(free)} columns without names were taken for x and y of {count} planes."
    )
    return list(zip(free[::2], free[1::2], strict=True))


def is_nameless(columns: Columns) -> bool:
    """Return whether columns have no names, or numbers for names, apart from that of ids."""
    heading = columns.table.heading
    pairs = zip(columns.names, columns.fields, strict=True)
    return heading is None or all(
        number_in(name) is not None for name, field in pairs if field != "id"
    )


def recognise_pasted(columns: Columns) -> None:
    """Take columns without names for an id that counts, and a place that is all else they have."""
    if not is_nameless(columns) or columns.are_any_chosen:
        return
    free = [at for at, field in enumerate(columns.fields) if field != "id"]
    if len(free) == columns.table.width > 2 and count_rows(columns, 0):
        columns.fields[0] = "id"
        del free[0]
    numeric = [at for at in free if columns.have_numbers(at)]
    if len(numeric) != 2:
        return
    if found := degrees_in(columns, numeric):
        columns.fields[found[0]], columns.fields[found[1]] = "longitude", "latitude"
        order = "longitude, then latitude" if found[0] < found[1] else "latitude, then longitude"
        columns.source.note("place", f"Two columns without names were taken for {order}.")
        columns.read_signs()


def count_rows(columns: Columns, at: int) -> bool:
    """Return whether a column counts the rows, in whole numbers."""
    texts = columns.table.texts(at)
    if len(texts) < 2 or not texts[0].isdecimal() or len(texts[0]) > _LONGEST_COUNT:
        return False
    first = int(texts[0])
    return texts[1] == str(first + 1) and texts == [str(first + row) for row in range(len(texts))]


def degrees_in(columns: Columns, free: Sequence[int]) -> tuple[int, int] | None:
    """Return the columns of longitude and latitude in the first two of numbers, if they are."""
    if len(free) < 2:
        return None
    first, second = free[:2]
    numbers = [_numbers(columns, at) for at in (first, second)]
    if any(None in column for column in numbers):
        return None
    left, right = (max(abs(each or 0.0) for each in column) for column in numbers)
    if max(left, right) <= 1 or max(left, right) > 180 or min(left, right) > 90:
        return None
    texts = [row[at] for _, row in columns.table.rows for at in (first, second)]
    exact = [each for each in texts if _EXACT.search(each)]
    if 2 * len(exact) < len(texts):
        return None
    return (second, first) if left <= 90 else (first, second)


def _numbers(columns: Columns, at: int) -> list[float | None]:
    """Return the number in each field of a column, or None."""
    texts = columns.table.texts(at)
    return [*(plain_numbers(texts) or map(number_in, texts))]


def question(columns: Columns, free: Sequence[int]) -> UnreadableFile:
    """Return the refusal of columns of numbers that may be anything.

    What its columns are supposed to be says what is likely: an id that counts, and degrees.
    """
    if is_nameless(columns) and (found := degrees_in(columns, free)):
        columns.fields[found[0]], columns.fields[found[1]] = "longitude", "latitude"
    columns.source.supposed[:] = columns.listed()
    names = ", ".join(quoted(columns.names[at]) for at in free[:8])
    return columns.source.refusal("which-places", given=names)
