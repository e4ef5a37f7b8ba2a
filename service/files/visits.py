"""Read the columns of a table that are about visits: demands, windows, service, prizes."""

import re
from functools import partial

import numpy as np

from service.files.columns import Columns, seconds_of
from service.files.fleets import Stop
from service.files.tables import number_in

_TIME = re.compile(
    r"(?:(\d{4}-\d\d-\d\d)[ T])?(\d{1,2}):(\d\d)(?::(\d\d)(?:\.0+)?)?(?:Z|[-+]\d\d:\d\d)?",
    re.ASCII,
)
_BETWEEN = re.compile(r"\s*(?:[-/\u2013\u2014]|\bto\b|\bbis\b)\s*", re.IGNORECASE)
_MOST = 1e6  # the largest demand
_ROUNDING = 1e-6
_MOST_DECIMALS = 3  # of a demand, which becomes a whole number


def add_visits(columns: Columns, stops: list[Stop]) -> int:
    """Add the members of visits to stops: demand, window, service and prize.

    Returns:
        By how much the demands of the table were multiplied.
    """
    demands = [at for at, each in enumerate(columns.fields) if each == "demand"]
    columns.leave_out("skills")
    for name, read in (("service", partial(seconds_in, columns)), ("prize", columns.number)):
        if (at := columns.find(name)) is not None:
            for row in _filled(columns, at):
                stops[row][name] = read(row, at)
    for row, stop in enumerate(stops):
        if window := span_in(columns, row, "window"):
            stop["window"] = window
    return _add_demands(columns, demands, stops) if demands else 1


def is_time(text: str) -> bool:
    """Return whether a text is hours and minutes."""
    return _TIME.fullmatch(text) is not None


def _filled(columns: Columns, at: int) -> list[int]:
    """Return the rows in which a column has text."""
    return [row for row in range(len(columns.table.rows)) if columns.text(row, at)]


def _add_demands(columns: Columns, demands: list[int], stops: list[Stop]) -> int:
    """Add demands as whole numbers; multiply fractions by a power of ten, and return that."""
    rows = np.array(
        [
            [columns.number(row, at) if columns.text(row, at) else 0.0 for at in demands]
            for row in range(len(stops))
        ]
    )
    finer = [rows * 10**decimals for decimals in range(_MOST_DECIMALS + 1)]
    whole = [np.abs(each - np.rint(each)) < _ROUNDING for each in finer]
    right = ((rows >= 0) & (rows <= _MOST) & whole[-1]).all(axis=1)
    if not right.all():
        row = int(np.argmin(right))
        demand = f"must be 0 to {_MOST:g}, with at most {_MOST_DECIMALS} decimals"
        came = ", ".join(f"{each:g}" for each in rows[row])
        raise columns.refusal(row, demands[0], f"{demand}, got {came}")
    decimals = next(at for at, each in enumerate(whole) if each.all())
    if decimals:
        columns.source.note(
            "demand",
            f"Demands must be whole numbers, so they are given in units of 1/{10**decimals}.",
        )
    for stop, amounts in zip(stops, np.rint(finer[decimals]).astype(int).tolist(), strict=True):
        stop["demand"] = amounts
    return 10**decimals


def span_in(columns: Columns, row: int, field: str) -> list[float] | None:
    """Return a window or a shift in seconds; None if its fields are empty."""
    both = columns.find(field)
    if both is not None:
        text = columns.text(row, both)
        bounds = _BETWEEN.split(text.strip("[]() "))
        if text and len(bounds) != 2:
            raise columns.refusal(row, both, "must be two times, as 8:00-12:30", text)
        return [seconds_in(columns, row, both, each) for each in bounds] if text else None
    ends = [columns.find(f"{field}_from"), columns.find(f"{field}_to")]
    texts = ["" if at is None else columns.text(row, at) for at in ends]
    if not any(texts):
        return None
    earliest, latest = ends
    if latest is None or not texts[1]:
        at = latest if latest is not None else earliest
        assert at is not None
        raise columns.refusal(row, at, f"must say when the {field} ends, got none")
    start = 0.0 if earliest is None or not texts[0] else seconds_in(columns, row, earliest)
    return [start, seconds_in(columns, row, latest)]


def seconds_in(columns: Columns, row: int, at: int, text: str | None = None) -> float:
    """Return a time in seconds: hours and minutes, or a number in the unit of its heading."""
    text = columns.text(row, at) if text is None else text.strip()
    if time := _TIME.fullmatch(text):
        date, *parts = time.groups()
        if date and not any(note.code == "dates" for note in columns.source.notes):
            columns.source.note("dates", f"Dates, as {date}, were not used: only times of day.")
        hours, minutes, seconds = (int(each or 0) for each in parts)
        return 3600 * hours + 60 * minutes + seconds
    number = number_in(text)
    if number is None or number < 0:
        raise columns.refusal(row, at, "must be seconds, or a time as 10:30", text)
    return number * (seconds_of(columns.names[at]) or 1)
