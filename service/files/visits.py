"""Read the columns of a table that are about visits: loads, times, skills, vehicles, prizes."""

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Literal, cast

import numpy as np

from service.files.cells.durations import read_units
from service.files.cells.times import recognise_hours, seconds_in, spans_in
from service.files.column_names import WINDOWS, amount_of
from service.files.columns import Columns
from service.files.fleets import Stop, add_windows

_Member = Literal["service", "due", "release", "skills", "vehicle", "prize", "urgency"]
_SEPARATOR = re.compile(r"[;|,]")  # between skills or ids
_AROUND_TEXT = " []{}\"'"  # as Python and JSON write lists
_MOST = 1e6  # the largest demand
_ROUNDING = 1e-6
_MOST_DECIMALS = 3  # of a demand, which becomes a whole number


def add_visits(columns: Columns, stops: list[Stop]) -> int:
    """Add the members of visits to stops: loads, times, skills, vehicle and prize.

    Returns:
        By how much the loads of the table were multiplied.
    """
    if any("location" in stop for stop in stops):
        recognise_hours(columns)
        read_units(columns)
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
    return _add_loads(columns, stops)


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


def loads_in(columns: Columns) -> tuple[list[int], list[int]]:
    """Return the columns of demands, and those of what stops give back for each of them.

    Raises:
        UnreadableFile: There are not as many of the one as of the other.
    """
    demands, pickups = (
        [at for at, each in enumerate(columns.fields) if each == field]
        for field in ("demand", "pickup")
    )
    if not demands or not pickups:
        return demands, pickups
    return demands, in_order(columns, "pickup", [columns.names[at] for at in demands])


def in_order(columns: Columns, field: str, demands: Sequence[str], table: str = "") -> list[int]:
    """Return the columns of a field, one for each demand: by their names if both share them.

    `demands` are the names of the columns of demands, which are in another table if that is named.
    """
    found = [at for at, each in enumerate(columns.fields) if each == field]
    if len(found) != len(demands):
        counts = {"demands": len(demands), "came": len(found)}
        values = {"noun": field.replace("_", " "), "table": table or columns.source.name}
        raise columns.source.refusal("column-each-demand", **values, **counts)
    amounts = [amount_of(name) for name in demands]
    by_amount = {amount_of(columns.names[at]): at for at in found}
    if by_amount.keys() == set(amounts) and len(by_amount) == len(amounts):
        return [by_amount[amount] for amount in amounts]
    return found


def _add_loads(columns: Columns, stops: list[Stop]) -> int:
    """Add loads as whole numbers; multiply fractions by a power of ten, and return that."""
    demands, pickups = loads_in(columns)
    if not demands and not pickups:
        return 1
    at = [*demands, *pickups]
    rows = np.array([[_load(columns, row, each) for each in at] for row in range(len(stops))])
    finer = [rows * 10**decimals for decimals in range(_MOST_DECIMALS + 1)]
    whole = [np.abs(each - np.rint(each)) < _ROUNDING for each in finer]
    right = (rows >= 0) & (rows <= _MOST) & whole[-1]
    for row, column in np.argwhere(~right).tolist():
        bounds = {"most": _MOST, "decimals": _MOST_DECIMALS}
        columns.refuse(row, at[column], "wrong-demand", **bounds, came=float(rows[row, column]))
    decimals = next((at for at, each in enumerate(whole) if each.all()), 0)
    if decimals:
        columns.source.note(
            "demand",
            f"Demands must be whole numbers, so they are given in units of 1/{10**decimals}.",
        )
    for stop, amounts in zip(stops, np.rint(finer[decimals]).astype(int).tolist(), strict=True):
        if demands:
            stop["demand"] = amounts[: len(demands)]
        if any(amounts[len(demands) :]):
            stop["pickup"] = amounts[len(demands) :]
    return 10**decimals


def _load(columns: Columns, row: int, at: int) -> float:
    return columns.tried(0.0, columns.number, row, at) if columns.text(row, at) else 0.0
