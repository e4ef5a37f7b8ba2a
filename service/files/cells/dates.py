"""Read dates and time zones beside times of day, and count all times from the first date.

A date without a time is the end of that day where something is due, and its begin elsewhere.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import date
from functools import lru_cache
from typing import NamedTuple

from service.files.reading import Source, UnreadableFile, quoted

_DATE = (
    r"(?P<iso>\d{4}[-/.]\d{1,2}[-/.]\d{1,2})|(?P<dotted>\d{1,2}\.\d{1,2}\.(?:\d{4}|\d\d))"
    r"|(?P<slashed>\d{1,2}[/-]\d{1,2}[/-](?:\d{4}|\d\d))"
)
_DATED = re.compile(rf"(?:{_DATE})(?:[T ,]+(?P<time>.+))?", re.ASCII)
_ZONE = re.compile(
    r"(.*\d(?:\s?[ap]\.?m\.?)?)\s?(?:(Z|UTC|GMT)|([-+])(\d\d):?(\d\d)?)", re.IGNORECASE
)
_MIDNIGHT = re.compile(r"0?0:00(?::00(?:\.0+)?)?|12(?::00){1,2}\s?a\.?m\.?", re.IGNORECASE)
_MOST_SHORT_YEAR = 99
_LONGEST = 80  # characters of a time with its date


class Parts(NamedTuple):
    """The parts of a text: its date, what it says of a time of day, and minutes from UTC."""

    date: str
    time: str
    zone: int | None


@dataclass(frozen=True)
class Calendar:
    """How the dates of a request are read.

    Args:
        first: The first date, from which times count; None if there is none.
        are_several: Whether there is another date. If not, times are those of one day.
        day_first: Whether 1/2/2026 is 1 February.
        zone: The minutes from UTC of all times that have a zone; None if none has.
        whole_days: The columns of dates whose times are all midnight, by file and name.
    """

    first: date | None = None
    are_several: bool = False
    day_first: bool = True
    zone: int | None = None
    whole_days: frozenset[tuple[str, str]] = frozenset()

    def days(self, parts: Parts) -> int:
        """Return how many days a date is after the first one; 0 if all times are of one day.

        Raises:
            ValueError: The date does not exist.
        """
        found = _date_in(parts.date, self.day_first)
        return (found - self.first).days if self.are_several and self.first else 0

    def shift(self, parts: Parts) -> int:
        """Return the seconds to add to a time, so that it is in the zone of the request."""
        if self.zone is None or parts.zone is None:
            return 0
        return 60 * (self.zone - parts.zone)


class TimeColumn(NamedTuple):
    """A column of times: its file, its name, and its texts, those of windows one by one."""

    source: Source
    name: str
    texts: Sequence[str]

    def refusal(self, code: str, /, **values: object) -> UnreadableFile:
        """Return the exception that says what the column must have."""
        return self.source.refusal(code, f"column {quoted(self.name)}", **values)


def parts_of(text: str) -> Parts:
    """Return the date, the time and the zone in a text; only the time if it has no date."""
    return _parts_of(text) if len(text) <= _LONGEST else Parts("", text, None)


@lru_cache(maxsize=4096)
def _parts_of(text: str) -> Parts:
    rest, zone = text.strip(), None
    found = _DATED.fullmatch(rest)
    day = ""
    if found:
        day = found["iso"] or found["dotted"] or found["slashed"]
        rest = found["time"] or ""
    if zoned := _ZONE.fullmatch(rest):
        is_clock = ":" in zoned[1] or day
        if is_clock and (day or zoned[3] != "-"):
            sign = -1 if zoned[3] == "-" else 1
            zone = sign * (60 * int(zoned[4] or 0) + int(zoned[5] or 0))
            rest = zoned[1]
    return Parts(day, rest.strip(), zone)


def are_days(texts: Sequence[str]) -> bool:
    """Return whether texts are dates without times, and of more than one day."""
    filled = [text for text in texts if text]
    return len({*filled}) > 1 and all((p := parts_of(each)).date and not p.time for each in filled)


def calendar_of(columns: Sequence[TimeColumn]) -> Calendar:
    """Return how the dates in all columns of times of a request are read, and note it.

    Raises:
        UnreadableFile: Dates allow two readings, or only some times have a zone.
    """
    found = [(each, [parts_of(text) for text in each.texts]) for each in columns]
    dated = [(each, [p for p in parts if p.date]) for each, parts in found]
    dated = [(each, parts) for each, parts in dated if parts]
    zone = _zone_of(found)
    if not dated:
        return Calendar(zone=zone)
    day_first = _day_first(dated)
    dates = set()
    for each, parts in dated:
        for part in parts:
            try:
                dates.add(_date_in(part.date, day_first))
            except ValueError:
                raise each.refusal("no-such-date", came=part.date) from None
    whole = {
        (each.source.name, each.name)
        for each, parts in dated
        if all(not part.time or _MIDNIGHT.fullmatch(part.time) for part in parts)
    }
    calendar = Calendar(min(dates), len(dates) > 1, day_first, zone, frozenset(whole))
    _note(calendar, dated, dates)
    return calendar


def _date_in(text: str, day_first: bool) -> date:
    numbers = [int(each) for each in re.split(r"[-/.]", text)]
    if len(text.split("-")[0].split("/")[0].split(".")[0]) == 4:
        year, month, day = numbers
    else:
        first, second, year = numbers
        is_day_first = day_first or "." in text
        day, month = (first, second) if is_day_first else (second, first)
    return date(year + 2000 if year <= _MOST_SHORT_YEAR else year, month, day)


def _day_first(dated: Iterable[tuple[TimeColumn, list[Parts]]]) -> bool:
    """Return whether dates such as 1/2/2026 begin with the day."""
    slashed = [
        (each, part.date, [int(n) for n in re.split("[-/]", part.date)])
        for each, parts in dated
        for part in parts
        if "." not in part.date and not re.match(r"\d{4}", part.date)
    ]
    firsts = [numbers[0] for _, _, numbers in slashed]
    seconds = [numbers[1] for _, _, numbers in slashed]
    if any(first > 12 for first in firsts) or firsts == seconds:
        return True
    if any(second > 12 for second in seconds):
        return False
    each, text, numbers = next(item for item in slashed if item[2][0] != item[2][1])
    both = [f"{numbers[2]:02}-{a:02}-{b:02}" for a, b in (numbers[1::-1], numbers[:2])]
    raise each.refusal("day-or-month", came=text, one=both[0], another=both[1])


def _zone_of(found: Iterable[tuple[TimeColumn, list[Parts]]]) -> int | None:
    """Return the zone of the first time that has one; None if none has."""
    cells = [
        (each, text, part)
        for each, parts in found
        for text, part in zip(each.texts, parts, strict=True)
        if part.time
    ]
    zoned = [cell for cell in cells if cell[2].zone is not None]
    if not zoned:
        return None
    if plain := next((cell for cell in cells if cell[2].zone is None), None):
        raise _mixed(zoned[0], plain)
    each, text, part = zoned[0]
    zone = part.zone or 0
    sign, minutes = "-" if zone < 0 else "+", abs(zone)
    named = "UTC" if not zone else f"UTC{sign}{minutes // 60:02}:{minutes % 60:02}"
    each.source.note("dates", f"Times are those of {named}, as {text[:40]}.")
    return zone


def _mixed(
    zoned: tuple[TimeColumn, str, Parts], plain: tuple[TimeColumn, str, Parts]
) -> UnreadableFile:
    beside = {"beside": plain[1], "column_beside": plain[0].name}
    return zoned[0].refusal("zones-differ", came=zoned[1], **beside)


def _note(
    calendar: Calendar, dated: Sequence[tuple[TimeColumn, list[Parts]]], dates: set[date]
) -> None:
    """Note from which date times count, or that all are of one day."""
    source, shown = dated[0][0].source, dated[0][1][0].date
    if calendar.are_several and calendar.first:
        last = max(dates)
        hours = 24 * (last - calendar.first).days
        text = f"Times count from {calendar.first} 0:00, the first date: {last} 0:00 is {hours}:00."
        source.note("dates", text)
    else:
        source.note("dates", f"Dates, as {shown}, were not used: only times of day.")
