"""Read the columns of a table that are about visits: demands, times, skills, vehicles, prizes."""

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Literal, cast

import numpy as np

from service.files.cells.durations import read_units
from service.files.cells.times import recognise_hours, seconds_in, spans_in
from service.files.column_names import WINDOWS
from service.files.columns import Columns
from service.files.fleets import Stop, add_windows

_Member = Literal["service", "due", "release", "skills", "vehicle", "prize", "urgency"]
_SEPARATOR = re.compile(r"[;|,]")  # between skills or ids
_AROUND_TEXT = " []{}\"'"  # as Python and JSON write lists
_MOST = 1e6  # the largest demand
_ROUNDING = 1e-6
_MOST_DECIMALS = 3  # of a demand, which becomes a whole number


def add_visits(columns: Columns, stops: list[Stop]) -> int:
    """Add the members of visits to stops: demand, times, skills, vehicle and prize.

    Returns:
        By how much the demands of the table were multiplied.
    """
    if any("location" in stop for stop in stops):
        recognise_hours(columns)
        read_units(columns)
    demands = [at for at, each in enumerate(columns.fields) if each == "demand"]
    readers: Mapping[_Member, Callable[[int, int], Any]] = {
        "service": partial(seconds_in, columns),
        "due": partial(seconds_in, columns),
        "release": partial(seconds_in, columns),
        "skills": partial(texts_in, columns),
        "vehicle": lambda row, at: " ".join(columns.text(row, at).split()),
        "prize": columns.amount,
        "urgency": columns.amount,
    }
    for name, read in readers.items():
        for row, value in columns.values(name, read):
            stops[row][name] = value
    for row, pair in columns.values("due_from", partial(_wanted_and_due, columns, stops)):
        stops[row]["due"] = pair
    for row, stop in enumerate(stops):
        add_windows(stop, spans_in(columns, row, WINDOWS))
    return _add_demands(columns, demands, stops) if demands else 1


def _wanted_and_due(columns: Columns, stops: Sequence[Stop], row: int, at: int) -> list[float]:
    """Return from when on a visit is wanted, and when it is due."""
    wanted, due = seconds_in(columns, row, at), cast(float | None, stops[row].get("due"))
    if due is None or due < wanted:
        raise columns.refuse(row, at, "wanted-not-before-due", came=columns.text(row, at))
    return [wanted, due]


def texts_in(columns: Columns, row: int, at: int) -> list[str]:
    """Return the texts in a field, such as skills, between semicolons, commas or bars."""
    pieces = _SEPARATOR.split(columns.text(row, at))
    return [text for each in pieces if (text := " ".join(each.strip(_AROUND_TEXT).split()))]


def _add_demands(columns: Columns, demands: list[int], stops: list[Stop]) -> int:
    """Add demands as whole numbers; multiply fractions by a power of ten, and return that."""
    rows = np.array(
        [
            [
                columns.tried(0.0, columns.number, row, at) if columns.text(row, at) else 0.0
                for at in demands
            ]
            for row in range(len(stops))
        ]
    )
    finer = [rows * 10**decimals for decimals in range(_MOST_DECIMALS + 1)]
    whole = [np.abs(each - np.rint(each)) < _ROUNDING for each in finer]
    right = (rows >= 0) & (rows <= _MOST) & whole[-1]
    for row, at in np.argwhere(~right).tolist():
        bounds = {"most": _MOST, "decimals": _MOST_DECIMALS}
        columns.refuse(row, demands[at], "wrong-demand", **bounds, came=float(rows[row, at]))
    decimals = next((at for at, each in enumerate(whole) if each.all()), 0)
    if decimals:
        columns.source.note(
            "demand",
            f"Demands must be whole numbers, so they are given in units of 1/{10**decimals}.",
        )
    for stop, amounts in zip(stops, np.rint(finer[decimals]).astype(int).tolist(), strict=True):
        stop["demand"] = amounts
    return 10**decimals
