"""Read times of day and durations in the cells of tables, and the windows between them."""

import re
from collections.abc import Iterable, Sequence
from itertools import pairwise

from service.files.cells.dates import Parts, TimeColumn, calendar_of, parts_of
from service.files.column_names import DURATIONS, SECONDS, WINDOWS, seconds_of, unit_of_times
from service.files.columns import Columns
from service.files.reading import quoted
from service.files.tables import number_in

_TIME = re.compile(  # 10:30, 26:00, 10:30:05.5, 1 day, 2:00:00
    r"(?:(\d{1,2}) days?, )?(\d{1,3}):([0-5]\d)(?::([0-5]\d(?:\.\d+)?))?", re.ASCII
)
_NEXT_DAY = re.compile(r"(.+?)\s*\(\+(\d)\)")  # 1:30 am (+1)
_SPOKEN = re.compile(  # 8h30, 8 Uhr, 8.30 Uhr, 8 am, 1:30 p.m., 8:30h
    r"(\d{1,2})(?:\s?h\s?([0-5]\d)(?:\s?min)?|:([0-5]\d)\s?h(?:rs?)?"
    r"|(?:[.:h]([0-5]\d)(?::[0-5]\d)?)?\s?(?:uhr|o'clock|([ap])\.?m\.?))",
    re.ASCII | re.IGNORECASE,
)
_HOURS = re.compile(  # 8, 8.30, 0800, 8 h
    r"(\d{1,4})(?:[.,](\d\d?|0+))?(?:\s*(?:h|hrs?|hours?)\.?)?", re.ASCII | re.IGNORECASE
)
_HALF_OF_DAY = re.compile(r"\s?([ap])\.?m\.?", re.IGNORECASE)
_UNIT_BEHIND = re.compile(r"(?<=\d)\s*[a-z][a-z.']*", re.IGNORECASE)
_OF_TWELVE = re.compile(r"(?:0?\d|1[0-2])(?:[.:h][0-5]\d)?", re.ASCII | re.IGNORECASE)
_DECIMALS = re.compile(r"\d[.,]\d")
_MINUTE, _HOUR, _DAY = 60, 3600, 86400  # seconds
_LONGEST = 31 * _DAY  # in a time of day, as seconds from midnight
_OR = re.compile(r"\s*(?:[;|,&]|\band\b|\bund\b)\s*", re.IGNORECASE)  # between two windows
_AROUND_SPAN = " []()"
_ENDS = 2  # of a window
_BETWEEN = re.compile(r"\s*(?:[-/\u2013\u2014]|\bto\b|\bbis\b)\s*", re.IGNORECASE)
_BETWEEN_DATES = re.compile(
    r"\s+(?:[-\u2013\u2014]|to|bis)\s+|(?<=[\dzZ])/(?=\d{4}-)", re.IGNORECASE
)
_IF_WRONG = [[0.0, 1.0]]  # in place of wrong windows or shifts: overtime needs a shift
_LEAST_SECONDS = 100  # beside hours of the day
_PARTS, _ALSO_PARTS = {"25", "5", "75"}, {"50"}  # decimals of parts of an hour
_LASTING = re.compile(r"(.*\d)\s*([a-z]+)\.?", re.IGNORECASE)  # with its unit, as 5 min


def is_time(text: str) -> bool:
    """Return whether a text is a time of day, as 10:30 or 8 am, maybe with a date and a zone."""
    text = parts_of(text).time
    return _TIME.fullmatch(text) is not None or _spoken(text) is not None


def recognise_hours(columns: Columns) -> None:
    """Decide in which columns numbers are hours of the day, such as 8 or 0800, and note it.

    For files whose places are on the earth: in a plane, numbers are in the unit of distances.
    Numbers are hours if all in a column can be, or if others in the column are times, as 8:00.
    """
    columns.on_earth = True
    for group in _columns_of_times(columns):
        cells = [(row, at) for at in group for row in columns.filled(at)]
        texts = [text for row, at in cells for text in _times_in(columns, row, at)]
        numbers = [text for text in texts if number_in(text) is not None]
        in_parts = _are_in_parts(texts)
        hours = [_hours(text, in_parts) is not None for text in numbers]
        if all(hours) or any(is_time(text) or _has_unit_of_hours(text) for text in texts):
            columns.hours |= dict.fromkeys(group, in_parts)
            _note_hours(columns, group, cells)
        else:
            _note_brief_times(columns, group, numbers)


def _columns_of_times(columns: Columns) -> list[list[int]]:
    """Return the columns of times of day whose numbers have no unit; begin and end together."""
    fields = [
        *([window] for window in (*WINDOWS, "shift")),
        *([f"{window}_from", f"{window}_to"] for window in (*WINDOWS, "shift")),
        *(["due_from", "due"], ["release"]),
    ]
    found = [[at for name in each if (at := columns.find(name)) is not None] for each in fields]
    return [
        group
        for group in found
        if group and not any(unit_of_times(columns.names[at], columns.fields[at]) for at in group)
    ]


def _times_in(columns: Columns, row: int, at: int) -> list[str]:
    """Return the texts of the times in a field; none of a window that cannot be read."""
    if columns.fields[at] in (*WINDOWS, "shift"):
        windows = columns.tried(None, _bounds_in, columns, row, at)
        return [text for bounds in windows or () for text in bounds]
    return [columns.text(row, at)]


def _are_in_parts(texts: Iterable[str]) -> bool:
    """Return whether the decimals of hours are parts of an hour, as in 8.5, and not minutes."""
    found = [_HOURS.fullmatch(text) for text in texts]
    decimals = {each[2] for each in found if each and int(each[2] or 0)}
    return bool(decimals & _PARTS) and decimals <= _PARTS | _ALSO_PARTS


def _has_unit_of_hours(text: str) -> bool:
    return number_in(text) is None and _HOURS.fullmatch(text) is not None


def _hours(text: str, in_parts: bool) -> float | None:
    """Return the seconds at an hour of the day, as 8, 8.30 or 0800; None for any other text."""
    found = _HOURS.fullmatch(text)
    if not found:
        return None
    whole, decimals = found[1], found[2] if int(found[2] or 0) else ""
    if len(whole) > 2:
        whole, minutes = whole[:-2], float(whole[-2:]) if not decimals else _MINUTE
    elif in_parts and decimals:
        minutes = _MINUTE * float(f"0.{decimals}")
    else:
        minutes = float(decimals.ljust(2, "0")) if decimals else 0.0
    seconds = _HOUR * int(whole) + _MINUTE * minutes
    return seconds if minutes < _MINUTE and seconds <= _DAY else None


def _note_hours(columns: Columns, group: list[int], cells: Iterable[tuple[int, int]]) -> None:
    """Note how numbers are read as hours, by the first one; best by one with decimals."""
    found = [
        cell
        for cell in cells
        if any(_is_guess(columns, cell[1], each) for each in _times_in(columns, *cell))
    ]
    if not found:
        return
    decimal = (cell for cell in found if _DECIMALS.search(columns.text(*cell)))
    row, at = next(decimal, found[0])
    times = [
        _clock(columns.tried(0.0, seconds_in, columns, row, at, text))
        for text in _times_in(columns, row, at)
    ]
    read = "; ".join("-".join(times[at : at + _ENDS]) for at in range(0, len(times), _ENDS))
    columns.source.note(
        "times",
        f"{_named(columns, group, 'has', 'have')} hours, such as {columns.text(row, at)[:80]},"
        f" read as {read}.",
    )


def _is_guess(columns: Columns, at: int, text: str) -> bool:
    """Return whether a text is an hour but 0, without a unit or with decimals."""
    is_plain = number_in(text) is not None or _DECIMALS.search(text) is not None
    return is_plain and bool(_hours(text, columns.hours[at]))


def _note_brief_times(columns: Columns, group: list[int], numbers: list[str]) -> None:
    """Note that times are in seconds, if one of them or all may be meant otherwise."""
    times = [time for each in numbers if (time := number_in(each) or 0) > 0]
    if times and (min(times) <= _DAY / _HOUR or max(times) < _HOUR):
        columns.source.note(
            "times",
            f"{_named(columns, group, 'is', 'are')} in seconds, such as {min(times):g}. Write"
            " times of day as 8:00.",
        )


def _named(columns: Columns, group: list[int], one: str, several: str) -> str:
    """Return the subject and verb of a sentence about columns."""
    names = " and ".join(quoted(columns.names[at]) for at in group)
    return f"{names} {one if len(group) == 1 else several}"


def _clock(seconds: float) -> str:
    """Return a time of day, as 8:00 or 8:00:30."""
    minutes, rest = divmod(round(seconds), _MINUTE)
    return f"{minutes // 60}:{minutes % 60:02}" + (f":{rest:02}" if rest else "")


def _spoken(text: str) -> float | None:
    """Return the seconds at a time of day with a word, as 8h30, 8 Uhr or 8 am; else None."""
    found = _SPOKEN.fullmatch(text)
    if not found:
        return None
    hour, minute = int(found[1]), int(found[2] or found[3] or found[4] or 0)
    if half := found[5]:
        if hour > 12:
            return None
        hour = hour % 12 + (12 if half in "pP" else 0)
    return float(_HOUR * hour + _MINUTE * minute)


def spans_in(columns: Columns, row: int, fields: Iterable[str]) -> list[list[float]]:
    """Return the windows or shifts of a row in seconds, in order; none if its fields are empty.

    Fields are kept as wrong, and another span is returned, where a window cannot be read, ends
    before it begins, or begins before the one before has ended.
    """
    read = [columns.tried(None, _spans_in, columns, row, field) for field in fields]
    found = [each for spans in read for each in spans or ()]
    backward = [(span, at) for span, at in found if span[1] < span[0]]
    for _, at in backward:
        code = "ends-before-midnight" if at in columns.hours else "ends-before"
        columns.refuse(row, at, code, noun=_noun(columns, at), came=columns.text(row, at))
    if backward or None in read:
        return _IF_WRONG
    found.sort(key=lambda each: each[0])
    for (before, _), (span, at) in pairwise(found):
        if span[0] <= before[1]:
            ends = {"begin": span[0], "end": before[1]}
            columns.refuse(row, at, "begins-before", noun=_noun(columns, at), **ends)
    return [span for span, _ in found]


def _spans_in(columns: Columns, row: int, field: str) -> list[tuple[list[float], int]] | None:
    """Return the windows or shifts of one field, each with a column that it is in.

    None if a time of it is wrong, which is kept.
    """
    both = columns.find(field)
    if both is not None:
        bounds = _bounds_in(columns, row, both)
        return [(_window_in(columns, row, both, *each), both) for each in bounds]
    earliest, latest = (columns.find(f"{field}_{end}") for end in ("from", "to"))
    filled = [at for at in (earliest, latest) if at is not None and columns.text(row, at)]
    if not filled:
        return []
    times = [columns.tried(None, seconds_in, columns, row, at) for at in filled]
    if earliest in filled and latest not in filled and columns.on_earth and field in WINDOWS:
        start = times[0]
        if start is None:
            return None
        return [([start, _DAY * (start // _DAY + 1)], _noted_open(columns, row, earliest))]
    if latest is None or latest not in filled:
        at = filled[0] if latest is None else latest
        raise columns.refuse(row, at, "no-end", noun=_noun(columns, at))
    start, end = [0.0, *times][-_ENDS:]
    if start is None or end is None:
        return None
    return [([start, end], latest)]


def _window_in(columns: Columns, row: int, at: int, begin: str, end: str) -> list[float]:
    """Return the seconds of both bounds of a window."""
    start = seconds_in(columns, row, at, begin, is_end=False)
    return [start, seconds_in(columns, row, at, end, is_end=True)]


def _noted_open(columns: Columns, row: int, at: int | None) -> int:
    """Note once that windows without an end are open until midnight; return their column."""
    begin = "Windows without an end are open until midnight"
    columns.source.note_once("times", begin, f", as that of row {columns.table.rows[row][0]}.")
    return at or 0


def _bounds_in(columns: Columns, row: int, at: int) -> list[list[str]]:
    """Return the texts of both bounds of each window in a field."""
    text = columns.text(row, at).strip(_AROUND_SPAN)
    dated = [_BETWEEN_DATES.split(each.strip(_AROUND_SPAN)) for each in re.split("[;|,]", text)]
    if all(len(bounds) == _ENDS and parts_of(bounds[0]).date for bounds in dated):
        return [[begin, _with_date(begin, end)] for begin, end in dated]
    several = [_BETWEEN.split(each.strip(_AROUND_SPAN)) for each in _OR.split(text) if each]
    one = _BETWEEN.split(text)  # whose numbers may have decimal commas
    for found in (several, [one]):
        if all(len(bounds) == _ENDS for bounds in found):
            return [[_with_unit(begin, end), end] for begin, end in found]
    raise columns.refuse(row, at, "no-window", came=columns.text(row, at))


def _with_date(begin: str, end: str) -> str:
    """Return the end of a window with the date of its begin if it has none."""
    date = parts_of(begin).date
    return end if parts_of(end).date else f"{date} {end}"


def _with_unit(begin: str, end: str) -> str:
    """Return the begin of a window with the unit of its end if it has none, as in 8-12 Uhr."""
    unit = _UNIT_BEHIND.search(end)
    if not unit or unit.end() < len(end):
        return begin
    if half := _HALF_OF_DAY.fullmatch(unit[0]):
        same, latest = _spoken(f"{begin}{unit[0]}"), _spoken(end)
        if not _OF_TWELVE.fullmatch(begin) or same is None or latest is None:
            return begin
        return f"{begin}{unit[0]}" if same <= latest or half[1] in "aA" else f"{begin} am"
    known = unit[0].strip().strip(".").casefold() in (*SECONDS, "uhr", "o'clock")
    return f"{begin}{unit[0]}" if known and number_in(begin) is not None else begin


def _noun(columns: Columns, at: int) -> str:
    """Return `window` or `shift`, by the field of a column."""
    return str(columns.fields[at]).partition("_")[0]


def _time_of_day(columns: Columns, at: int, text: str) -> float | None:
    """Return the seconds at a time with a word, or at an hour in a column of hours; else None."""
    if (spoken := _spoken(text)) is not None:
        return spoken
    return _hours(text, columns.hours[at]) if at in columns.hours else None


def seconds_in(
    columns: Columns, row: int, at: int, text: str | None = None, *, is_end: bool | None = None
) -> float:
    """Return a time in seconds: hours and minutes, or a number with a unit or in its heading's.

    Args:
        text: The text of the time, if it is only a part of the field.
        is_end: Whether a date without a time is the end of that day; by default the field says it.
    """
    text = columns.text(row, at) if text is None else text.strip()
    field = str(columns.fields[at])
    parts = parts_of(text) if field not in DURATIONS else Parts("", text, None)
    seconds = _seconds_of_day(columns, at, parts.time)
    if parts.date and (not parts.time or columns.are_whole_days(at)):
        ends = field == "due" or field.endswith("_to") if is_end is None else is_end
        note_whole_day(columns, at, parts.date, ends)
        return columns.calendar.days(parts) * _DAY + _DAY * ends
    if seconds is not None:
        days = columns.calendar.days(parts) if parts.date else 0
        if (moved := seconds + days * _DAY + columns.calendar.shift(parts)) >= 0:
            return moved
    lasting = _LASTING.fullmatch(text)
    own = SECONDS.get(lasting[2].casefold()) if lasting else None
    number = number_in(lasting[1].strip() if lasting and own else text)
    unit = own or seconds_of(columns.names[at]) or columns.units.get(at)
    is_doubtful = at in columns.hours and not unit and 0 < (number or 0) < _LEAST_SECONDS
    if number is None or number < 0 or is_doubtful:
        raise columns.refuse(row, at, "no-time-in-cell", came=text)
    if columns.on_earth and field not in DURATIONS and number * (unit or 1) > _LONGEST:
        raise columns.refuse(row, at, "unix-time", came=text)
    return number * (unit or 1)


def _seconds_of_day(columns: Columns, at: int, text: str) -> float | None:
    """Return the seconds at a time of day; None if the text is not one."""
    if later := _NEXT_DAY.fullmatch(text):
        before = _seconds_of_day(columns, at, later[1])
        return None if before is None else before + _DAY * int(later[2])
    if time := _TIME.fullmatch(text):
        days, hours, minutes = (int(each or 0) for each in time.group(1, 2, 3))
        return _DAY * days + _HOUR * hours + _MINUTE * minutes + float(time[4] or 0)
    return _time_of_day(columns, at, text)


def note_whole_day(columns: Columns, at: int, date: str, ends: bool) -> None:
    """Note once for each column that a date without a time is the end of that day, or its begin."""
    name = quoted(columns.names[at])
    which = "end" if ends else "begin"
    begin = f"{name} has dates without times: "
    columns.source.note_once("dates", begin, f"{date} is the {which} of that day.")


def read_calendar(tables: Sequence[Columns]) -> None:
    """Decide how the dates in the times of all tables of a request are read.

    Raises:
        UnreadableFile: Dates allow two readings, or only some times have a zone.
    """
    found = [
        TimeColumn(
            columns.source,
            columns.names[at],
            [text for row in columns.filled(at) for text in _times_in(columns, row, at)],
        )
        for columns in tables
        for at, field in enumerate(columns.fields)
        if field in ("due", "due_from", "release") or str(field).startswith(("window", "shift"))
    ]
    calendar = calendar_of(found)
    for columns in tables:
        columns.calendar = calendar
