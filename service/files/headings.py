"""Join two rows of headings: groups above names, or names above units."""

from collections import Counter
from collections.abc import Sequence

from service.files.column_names import SECONDS, fields_of
from service.files.reading import Source, quoted

Row = tuple[int, list[str]]
_UNITS = {
    *SECONDS,
    *("hh:mm", "h:mm", "hh:mm:ss", "time", "deg", "degree", "degrees", "°", "wgs84", "m", "km"),
    *("kg", "t", "lb", "lbs", "l", "m3", "m²", "m³", "pcs", "pc", "units", "unit", "eur", "€", "$"),
    *("usd", "gbp", "£", "stk", "stück", "text", "number", "#", "-"),
}
_LEAST = 2  # names in the second row by which it is a heading
_NOT_UNITS = ("time", "text", "number", "#", "-", "units", "unit")


def joined_heading(source: Source, heading: list[str], rows: list[Row]) -> list[str]:
    """Return a heading, joined with a second row of it, which is taken off the rows with a note.

    The second row has no numbers, and a row below it has some.
    """
    if len(rows) < 2 or not (second := _second(heading, rows)):
        return heading
    number, texts = rows.pop(0)
    units = _are_units(texts)
    joined = _with_units(heading, second) if units else _with_groups(heading, second)
    kind = "units" if units else "names"
    shown = ", ".join(quoted(each) for each in texts[:6] if each)
    source.note("heading", f"Row {number} was taken for {kind} below the heading: {shown}.")
    return joined


def _second(heading: Sequence[str], rows: Sequence[Row]) -> list[str] | None:
    """Return the second row of a heading, as wide as the first; None if it is a row of data."""
    second = rows[0][1]
    if any(any(letter.isdigit() for letter in text) for text in second if text not in _UNITS):
        return None
    if not any(any(map(str.isdigit, text)) for text in rows[1][1]):
        return None
    filled = [text for text in second if text]
    texts = (second + [""] * len(heading))[: max(len(heading), len(second))]
    if _are_units(second):
        return texts
    known = _count_known(second)
    joined = _count_known(_with_groups(heading, texts))
    named = known >= max(_LEAST, len(filled) // 2) and joined >= _count_known(heading)
    return texts if named else None


def _count_known(names: Sequence[str]) -> int:
    """Return how many names are those of fields."""
    return sum(each is not None for each in fields_of(names))


def _are_units(texts: Sequence[str]) -> bool:
    plain = [text.strip(" []()").casefold() for text in texts if text]
    return bool(plain) and all(text in _UNITS for text in plain)


def _with_units(heading: Sequence[str], units: Sequence[str]) -> list[str]:
    """Return names with their units in brackets."""
    plain = [unit.strip(" []()") for unit in units]
    names = [*heading, *[""] * (len(plain) - len(heading))]
    return [
        f"{name} [{unit}]" if name and unit and unit.casefold() not in _NOT_UNITS else name or unit
        for name, unit in zip(names, plain, strict=True)
    ]


def _with_groups(groups: Sequence[str], names: Sequence[str]) -> list[str]:
    """Return the names of the second row; with the group above where a name comes twice.

    A group reaches to the next one. Where the second row is empty, the name is in the first.
    """
    reached, latest = [], ""
    for at in range(len(names)):
        latest = (groups[at] if at < len(groups) else "") or latest
        reached.append(latest)
    seen = Counter(name.casefold() for name in names)
    return [
        (f"{group} {name}" if seen[name.casefold()] > 1 else name)
        if name
        else (groups[at] if at < len(groups) else "")
        for at, (group, name) in enumerate(zip(reached, names, strict=True))
    ]
