"""Read the columns of a table that are about visits: demands, times, skills, vehicles, prizes."""

import re
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from service.files.column_names import SECONDS, WINDOWS, seconds_of
from service.files.columns import Columns
from service.files.fleets import Stop, spans
from service.files.reading import quoted
from service.files.tables import number_in

_TIME = re.compile(
    r"(?:(\d{4}-\d\d-\d\d)[ T])?(\d{1,2}):(\d\d)(?::(\d\d)(?:\.0+)?)?(?:Z|[-+]\d\d:\d\d)?",
    re.ASCII,
)
_LASTING = re.compile(r"(.*\d)\s*([a-z]+)\.?", re.IGNORECASE)  # with its unit, as 5 min
_BRIEF = 60  # seconds; a service that takes less may be meant in minutes
_OR = re.compile(r"\s*(?:[;|,&]|\band\b|\bund\b)\s*", re.IGNORECASE)  # between two windows
_SEPARATOR = re.compile(r"[;|,]")  # between skills or ids
_AROUND_SPAN = " []()"
_AROUND_TEXT = " []{}\"'"  # as Python and JSON write lists
_ENDS = 2  # of a window
_BETWEEN = re.compile(r"\s*(?:[-/\u2013\u2014]|\bto\b|\bbis\b)\s*", re.IGNORECASE)
_MOST = 1e6  # the largest demand
_ROUNDING = 1e-6
_MOST_DECIMALS = 3  # of a demand, which becomes a whole number


def add_visits(columns: Columns, stops: list[Stop]) -> int:
    """Add the members of visits to stops: demand, times, skills, vehicle and prize.

    Returns:
        By how much the demands of the table were multiplied.
    """
    demands = [at for at, each in enumerate(columns.fields) if each == "demand"]
    readers: Mapping[str, Callable[[int, int], Any]] = {
        "service": partial(seconds_in, columns),
        "due": partial(seconds_in, columns),
        "release": partial(seconds_in, columns),
        "skills": partial(texts_in, columns),
        "vehicle": lambda row, at: " ".join(columns.text(row, at).split()),
        "prize": columns.number,
    }
    for name, read in readers.items():
        if (at := columns.find(name)) is not None:
            for row in columns.filled(at):
                stops[row][name] = read(row, at)
    _note_brief_service(columns, stops)
    for row, stop in enumerate(stops):
        stop |= spans("window", spans_in(columns, row, WINDOWS))
    return _add_demands(columns, demands, stops) if demands else 1


def _note_brief_service(columns: Columns, stops: list[Stop]) -> None:
    """Note that service on the earth is in seconds, if it has no unit and may be in minutes."""
    at = columns.find("service")
    if at is None or columns.find("latitude") is None or seconds_of(columns.names[at]):
        return
    rows = columns.filled(at)
    longest = max((stops[row]["service"] for row in rows), default=0)
    if 0 < longest < _BRIEF and all(number_in(columns.text(row, at)) is not None for row in rows):
        name = columns.names[at]
        columns.source.note(
            "service",
            f"{quoted(name)} is in seconds, {longest:g} at most. For minutes, write 5 min or name"
            f" it {quoted(f'{name} (min)')}.",
        )


def is_time(text: str) -> bool:
    """Return whether a text is hours and minutes."""
    return _TIME.fullmatch(text) is not None


def texts_in(columns: Columns, row: int, at: int) -> list[str]:
    """Return the texts in a field, such as skills, between semicolons, commas or bars."""
    pieces = _SEPARATOR.split(columns.text(row, at))
    return [text for each in pieces if (text := " ".join(each.strip(_AROUND_TEXT).split()))]


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


def spans_in(columns: Columns, row: int, fields: Iterable[str]) -> list[list[float]]:
    """Return the windows or shifts of a row in seconds, in order; none if its fields are empty.

    Raises:
        UnreadableFile: A window begins before the one before has ended.
    """
    found = [(span, at) for field in fields for span, at in _spans_in(columns, row, field)]
    found.sort(key=lambda each: each[0])
    for (before, _), (span, at) in pairwise(found):
        if span[0] <= before[1]:
            came = f"got {span[0]:g} s after {before[1]:g} s"
            demand = f"must begin after the {_noun(columns, at)} before has ended, {came}"
            raise columns.refusal(row, at, demand)
    return [span for span, _ in found]


def _spans_in(columns: Columns, row: int, field: str) -> list[tuple[list[float], int]]:
    """Return the windows or shifts of one field, each with a column that it is in."""
    both = columns.find(field)
    if both is not None:
        bounds = _bounds_in(columns, row, both)
        return [([seconds_in(columns, row, both, text) for text in each], both) for each in bounds]
    earliest, latest = (columns.find(f"{field}_{end}") for end in ("from", "to"))
    texts = ["" if at is None else columns.text(row, at) for at in (earliest, latest)]
    if not any(texts):
        return []
    if latest is None or not texts[1]:
        at = latest if latest is not None else earliest
        assert at is not None
        noun = _noun(columns, at)
        raise columns.refusal(row, at, f"must say when the {noun} ends, got none")
    start = 0.0 if earliest is None or not texts[0] else seconds_in(columns, row, earliest)
    return [([start, seconds_in(columns, row, latest)], latest)]


def _bounds_in(columns: Columns, row: int, at: int) -> list[list[str]]:
    """Return the texts of both bounds of each window in a field."""
    text = columns.text(row, at).strip(_AROUND_SPAN)
    several = [_BETWEEN.split(each.strip(_AROUND_SPAN)) for each in _OR.split(text) if each]
    if all(len(bounds) == _ENDS for bounds in several):
        return several
    one = _BETWEEN.split(text)  # whose numbers may have decimal commas
    if len(one) == _ENDS:
        return [one]
    demand = "must be two times, as 8:00-12:30, or several as 8:00-10:00; 14:00-16:00"
    raise columns.refusal(row, at, demand, columns.text(row, at))


def _noun(columns: Columns, at: int) -> str:
    """Return `window` or `shift`, by the field of a column."""
    return str(columns.fields[at]).partition("_")[0]


def seconds_in(columns: Columns, row: int, at: int, text: str | None = None) -> float:
    """Return a time in seconds: hours and minutes, or a number with a unit or in its heading's."""
    text = columns.text(row, at) if text is None else text.strip()
    if time := _TIME.fullmatch(text):
        date, *parts = time.groups()
        if date and not any(note.code == "dates" for note in columns.source.notes):
            columns.source.note("dates", f"Dates, as {date}, were not used: only times of day.")
        hours, minutes, seconds = (int(each or 0) for each in parts)
        return 3600 * hours + 60 * minutes + seconds
    lasting = _LASTING.fullmatch(text)
    own = SECONDS.get(lasting[2].casefold()) if lasting else None
    number = number_in(lasting[1].strip() if lasting and own else text)
    if number is None or number < 0:
        raise columns.refusal(row, at, "must be seconds, or a time as 10:30 or 5 min", text)
    return number * (own or seconds_of(columns.names[at]) or 1)
