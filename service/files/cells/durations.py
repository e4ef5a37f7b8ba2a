"""Decide the unit of durations in columns whose headings say none."""

import re

from service.files.column_names import DURATIONS, are_usually_minutes, seconds_of
from service.files.columns import Columns
from service.files.reading import quoted
from service.files.tables import number_in

_MINUTE = 60
_MOST_MINUTES = 480  # of a visit, a working day
_NOT_ZERO = re.compile(r"[1-9]", re.ASCII)


def read_units(columns: Columns) -> None:
    """Decide the units of durations whose headings have none, and note them.

    Headings that route planners write are in minutes, unless that is longer than a working day;
    all others are in seconds.

    Raises:
        UnreadableFile: Numbers without a unit stand beside hours and minutes.
    """
    for at, (name, field) in enumerate(zip(columns.names, columns.fields, strict=True)):
        if field not in DURATIONS or seconds_of(name):
            continue
        texts = [columns.text(row, at) for row in columns.filled(at)]
        plain = [text for text in texts if (number_in(text) or 0) > 0]
        clocks = [text for text in texts if number_in(text) is None and _NOT_ZERO.search(text)]
        if plain and clocks:
            came = {"came": plain[0], "beside": clocks[0], "instead": f"{name} (min)"}
            raise columns.source.refusal("no-unit", f"column {quoted(name)}", **came)
        if plain:
            _take_unit(columns, at, max(number_in(text) or 0.0 for text in plain))


def _take_unit(columns: Columns, at: int, longest: float) -> None:
    name = columns.names[at]
    if are_usually_minutes(name) and longest <= _MOST_MINUTES:
        columns.units[at] = _MINUTE
        unit, other = "minutes", "seconds, write 90 sec or name it " + quoted(f"{name} (sec)")
    else:
        unit, other = "seconds", "minutes, write 5 min or name it " + quoted(f"{name} (min)")
    text = f"{quoted(name)} is in {unit}, {longest:g} at most. For {other}."
    columns.source.note("service" if columns.fields[at] == "service" else "times", text)
