"""Leave rows of totals at the end of a table out."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace

from service.files.reading import Source, quoted
from service.files.tables import Row, Table, number_in

_PLACES = ("longitude", "latitude", "place", "x", "y")
_TOTAL = re.compile(
    r"(?:(?:grand|sub|order)[ -]?)?totals?|all(?: orders| stops)?|overall|sums?"
    r"|(?:gesamt|zwischen)?summe|gesamt|insgesamt|somme|totale"
    r"|suma|soma|totaal|yhteensä",
    re.IGNORECASE,
)
_MOST_TOTALS = 4  # rows
_MOST_OF_TOTAL = 2  # fields, if its name does not say what it is
_ROUNDING = 1e-6


def without_totals(
    source: Source, table: Table, is_total: Callable[[Sequence[Row]], bool]
) -> Table:
    """Return a table without rows of totals at its end, with a note on each."""
    rows = list(table.rows)
    while len(rows) > max(1, len(table.rows) - _MOST_TOTALS) and is_total(rows):
        number, texts = rows.pop()
        came = quoted(" ".join(filter(None, texts)))
        source.note("total", f"Row {number}, {came}, was taken for a total and left out.")
    unused = {
        at: each._replace(texts=each.texts[: len(rows)]) for at, each in table.left_out.items()
    }
    return replace(table, rows=rows, left_out=unused)


def is_total(rows: Sequence[Row], fields: Sequence[str | None]) -> bool:
    """Return whether the last row has no place, and is named as a total, or is an unnamed sum.

    A row with an id as others have is an order, whose place is missing.
    """
    texts = rows[-1][1]
    places = [text for text, each in zip(texts, fields, strict=True) if each in _PLACES]
    if not places or any(places):
        return False
    filled = [at for at, text in enumerate(texts) if text]
    names = [texts[at] for at in filled if fields[at] == "id"]
    if names or _is_named_total(texts):
        return _is_named_total(names or texts)
    return len(filled) <= _MOST_OF_TOTAL and any(_is_sum(rows, at) for at in filled)


def is_total_of_vehicles(rows: Sequence[Row]) -> bool:
    """Return whether the last row is named as a total, and has only numbers beside its name."""
    texts = [text for text in rows[-1][1] if text]
    return _is_named_total(texts) and sum(number_in(text) is None for text in texts) == 1


def _is_named_total(texts: Sequence[str]) -> bool:
    return any(_TOTAL.fullmatch(text.rstrip(" :")) for text in texts)


def _is_sum(rows: Sequence[Row], at: int) -> bool:
    """Return whether the last number of a column is the sum of those above it."""
    total, *above = (number_in(texts[at]) or 0.0 for _, texts in reversed(rows))
    return total > 0 and len(above) > 1 and abs(total - sum(above)) < _ROUNDING * total
