"""Decide which sign in the numbers of a table is decimal: by column and by file, never by cell.

`1,250` is 1250 beside 60.169, and 1.25 beside 2,5. What one column leaves open, the other columns
of its file decide, then the other files of the request, then how fields are separated. If nothing
does, the table is refused with a sentence that shows both readings.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace

from service.files.column_names import NUMBERS
from service.files.reading import LONGEST_NAME, Source, UnreadableFile, quoted
from service.files.tables import Table

_SPACES = str.maketrans({"\u2212": "-", "\u2013": "-", "\xa0": " ", "\u202f": " ", "\u2009": " "})
_SIGNS = (".", ",")
_MOST_DEGREES = 180
_DEGREES = ("longitude", "latitude")
_OF_PROGRAMS = (",", "|", None)  # separators beside which a decimal sign is a point


def _pattern(decimal: str) -> re.Pattern[str]:
    """Return the form of numbers with this decimal sign, and maybe with thousands signs."""
    point, other = map(re.escape, (decimal, _other(decimal)))
    grouped = "|".join(rf"[1-9]\d{{0,2}}(?:{sign}\d{{3}})+" for sign in (other, " ", "['\u2019]"))
    whole = rf"(?:\d+|{grouped})"
    return re.compile(
        rf"[-+]?(?:{whole}(?:{point}\d*)?|{point}\d+)(?:e[-+]?\d{{1,3}})?",
        re.ASCII | re.IGNORECASE,
    )


def _other(decimal: str) -> str:
    return "," if decimal == "." else "."


_PATTERNS = {decimal: _pattern(decimal) for decimal in _SIGNS}
_PAIRED = re.compile(r"\d\.\d+°?[ ,]", re.ASCII)
_GROUPING = re.compile(r"[ '\u2019]")
_DIGITS_AND_POINTS = re.compile(r"[-+0-9.\n]*", re.ASCII)
_TWO_POINTS = re.compile(r"\.\d*\.")
_SURELY_DECIMAL = re.compile(r"\.(?!\d{3}(?!\d))|(?<!\d)0?\.|\d{4}\.", re.ASCII)


def is_number(text: str) -> bool:
    """Return whether a text is a number, with any signs."""
    return bool(_readings_of(text, is_degrees=False))


def is_numeric(field: str | None) -> bool:
    """Return whether the cells of a field are numbers, apart from times of day."""
    return field is not None and (field in NUMBERS or field.endswith(("_latitude", "_longitude")))


def decimals_of(table: Table, fields: Sequence[str | None]) -> set[str]:
    """Return the decimal signs that the columns of numbers of a table have for certain."""
    found: set[str] = set()
    for at, field in enumerate(fields):
        if field == "place":
            found |= {"."} if any(map(_PAIRED.search, table.texts(at))) else set()
        elif table.heading is None or is_numeric(field):
            texts = table.texts(at)
            signs = _surely(texts) or _common(_readings(texts, field))
            found |= signs if len(signs) == 1 else set()
    return found


def with_plain_numbers(
    source: Source, table: Table, fields: Sequence[str | None], columns: Iterable[int]
) -> Table:
    """Return a table whose numbers in some columns have decimal points, and no thousands signs.

    Args:
        source: The file, with the decimal signs that are known of it and of the request.
        fields: The field that each column is taken for.
        columns: These columns. What is not a number in them stays as it is.

    Raises:
        UnreadableFile: A column allows both readings.
    """
    plain = {at: texts for at in columns if (texts := _plain(source, table, fields[at], at))}
    if not plain:
        return table
    rows = [
        (number, [plain[at][index] if at in plain else text for at, text in enumerate(texts)])
        for index, (number, texts) in enumerate(table.rows)
    ]
    return replace(table, rows=rows)


def _plain(source: Source, table: Table, field: str | None, at: int) -> list[str] | None:
    """Return the plain texts of a column; None if they are plain already."""
    texts = table.texts(at)
    if _surely(texts):
        return None
    readings = _readings(texts, field)
    signs = _common(readings)
    sign = next(iter(signs)) if len(signs) == 1 else None
    open_cells = [at for at, each in enumerate(readings) if len({*each.values()}) > 1]
    if open_cells and sign is None:
        sign = _decided(source, [texts[at] for at in open_cells], bool(signs))
        if sign is None:
            first = open_cells[0]
            raise _question(source, _name(table, at), texts[first], readings[first])
    plain = [
        each.get(sign or "", next(iter(each.values()), text))
        for text, each in zip(texts, readings, strict=True)
    ]
    grouped = [
        index
        for index, each in enumerate(readings)
        if each and _is_grouped(texts[index], plain[index])
    ]
    is_known = len(signs) == 1 or source.signs.own or source.signs.of_request
    if shown := grouped or ([] if is_known or sign == "." else open_cells):
        what = "thousands signs" if grouped else "decimal commas"
        came = f"{quoted(texts[shown[0]])} is {float(plain[shown[0]]):.15g}"
        source.note("thousands", f"{_name(table, at)} has {what}: {came}.")
    return plain


def _surely(texts: Sequence[str]) -> set[str]:
    """Return the decimal signs of digits and points alone, fast; none if they may have others."""
    joined = "\n".join(texts)
    if not _DIGITS_AND_POINTS.fullmatch(joined) or _TWO_POINTS.search(joined):
        return set()
    if "." not in joined:
        return set(_SIGNS)
    return {"."} if _SURELY_DECIMAL.search(joined) else set()


def _name(table: Table, at: int) -> str:
    return quoted(table.heading[at][:LONGEST_NAME] if table.heading else at + 1)


def _readings(texts: Iterable[str], field: str | None) -> list[dict[str, str]]:
    """Return the plain numbers that each text may be, by the decimal signs that allow them."""
    return [_readings_of(text, str(field).endswith(_DEGREES)) for text in texts]


def _readings_of(text: str, is_degrees: bool) -> dict[str, str]:
    """Return the plain numbers that a text may be; degrees are never more than 180."""
    plain = text.translate(_SPACES)
    found = {
        sign: _GROUPING.sub("", plain).replace(_other(sign), "").replace(sign, ".")
        for sign, form in _PATTERNS.items()
        if form.fullmatch(plain)
    }
    if len(found) > 1 and is_degrees:
        return {s: each for s, each in found.items() if abs(float(each)) <= _MOST_DEGREES} or found
    return found


def _common(readings: Iterable[dict[str, str]]) -> set[str]:
    """Return the decimal signs that all numbers of a column allow; none if they disagree."""
    return set(_SIGNS).intersection(*(each for each in readings if each))


def _decided(source: Source, cells: Sequence[str], agree: bool) -> str | None:
    """Return the decimal sign of a column that leaves it open, by the rest of the request."""
    if not agree:
        return None
    for known in (source.signs.own, source.signs.of_request):
        if known:
            return next(iter(known)) if len(known) == 1 else None
    shown = {sign for cell in cells for sign in _SIGNS if sign in cell}
    if shown == {"."} and source.signs.separator in _OF_PROGRAMS:
        return "."
    # Spreadsheets write semicolons where commas are decimal.
    return "," if shown == {","} and source.signs.separator == ";" else None


def _question(source: Source, name: str, text: str, readings: dict[str, str]) -> UnreadableFile:
    """Return the refusal of a column that allows both readings."""
    both = " or ".join(f"{float(readings[sign]):.15g}" for sign in sorted(readings))
    return source.refusal("which-sign", f"column {name}", came=text, readings=both)


def _is_grouped(text: str, plain: str) -> bool:
    """Return whether a number lost a thousands sign."""
    return sum(map(text.translate(_SPACES).count, ".,' \u2019")) > plain.count(".")
