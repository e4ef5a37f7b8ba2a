"""Write the numbers of cells as the texts that a spreadsheet program shows: times, dates, ids."""

import re
from datetime import datetime, timedelta
from typing import NamedTuple

_DAY = 86400  # seconds
_FIRST, _FIRST_1904 = datetime(1899, 12, 30), datetime(1904, 1, 1)
_LEAP = 60  # the day that never was, 29 February 1900
_LAST = 2958466  # 1 January 10000
_SHORT = 60  # days: a time of day with fewer lasts longer than a day
_WHOLE = 1e21
MOST_DIGITS = 15  # that spreadsheet programs keep of a number
_NO_CODE = re.compile(r'"[^"]*"|\\.|_.|\*.|\[(?!h+\]|m+\]|s+\])[^\]]*\]')
_ELAPSED = re.compile(r"\[(h+|m+|s+)\]")
_BUILT_IN = {
    **dict.fromkeys((14, 15, 16, 17, 27, 28, 29, 30, 31, 36, 50, 51, 52, 53, 54, 57, 58), "d"),
    **dict.fromkeys((18, 19, 20, 21, 32, 33, 34, 35, 45, 47, 55, 56), "h"),
    22: "d h",
    46: "[h]",
}


class Format(NamedTuple):
    """What the number format of a cell shows: a date, a time of day, a length of time, zeros."""

    date: bool = False
    time: bool = False
    elapsed: bool = False
    digits: int = 0  # at least; zeros are written in front


GENERAL = Format()


def format_of(number: int, code: str | None) -> Format:
    """Return the format of a number of formats, whose code is its own or a known one."""
    code = _BUILT_IN.get(number, "") if code is None else code
    plain = _NO_CODE.sub("", code.casefold()).partition(";")[0]
    if plain == "general":
        return GENERAL
    if _ELAPSED.search(plain):
        return Format(elapsed=True)
    time = bool(set("hs") & set(plain))
    date = bool(set("yd") & set(plain)) or ("m" in plain and not time)
    digits = len(plain) if re.fullmatch("00+", plain) else 0
    return Format(date=date, time=time, digits=digits)


def text_of(text: str, shown: Format, from_1904: bool) -> str:
    """Return the number in a cell as a text; a text that is not a number stays as it is."""
    try:
        number = float(text)
    except ValueError:
        return text
    if shown.elapsed or shown.date or shown.time:
        return _time(number, shown, from_1904) or _number(text, number)
    return _number(text, number).rjust(shown.digits, "0") if shown.digits else _number(text, number)


def _number(text: str, number: float) -> str:
    """Return a number without an exponent or a point where it is whole."""
    if text.isdecimal():
        return text
    if number.is_integer() and abs(number) < _WHOLE:
        return str(int(number))
    written = repr(float(f"{number:.{MOST_DIGITS}g}"))
    # With three decimals the point might be a thousands sign.
    return f"{written}0" if re.fullmatch(r"-?\d+\.\d{3}", written) else written


def _time(days: float, shown: Format, from_1904: bool) -> str | None:
    """Return a time or a date; None if it is none."""
    first = 0 if from_1904 else _LEAP
    is_date = shown.date or (shown.time and days >= _SHORT)
    if not 0 <= days < (_LAST if is_date else _LEAP * _LEAP):
        return None
    seconds = round(days * _DAY)
    if shown.elapsed or not is_date:
        hours = f"{seconds // 3600}" if shown.elapsed or days >= 1 else f"{seconds // 3600:02}"
        return f"{hours}:{seconds % 3600 // 60:02}:{seconds % 60:02}"
    begin = _FIRST_1904 if from_1904 else _FIRST + timedelta(days=days < first)
    moment = begin + timedelta(seconds=seconds)
    has_time = shown.time or seconds % _DAY
    return moment.isoformat(sep=" ") if has_time else moment.date().isoformat()
