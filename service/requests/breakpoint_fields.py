"""The field of times of travel by breakpoints of each pair of stops, and their check."""

from collections.abc import Sequence
from itertools import chain
from typing import Annotated

import numpy as np
from pydantic import Field

from service.day.breakpoints import Breakpoints
from service.errors import invalid
from service.requests.arrays import check_rows
from service.requests.fields import IS_TIME, Items, Pair

LATEST = 864_000  # ten days
_MOST_OF_PAIR = 1000
_ROUNDING = 1e-6  # seconds by which who leaves later may arrive earlier
TimeOfDay = Annotated[float, Field(ge=0, le=LATEST, allow_inf_nan=False), IS_TIME]
OfPair = Annotated[
    list[Pair[TimeOfDay]], Field(min_length=1, max_length=_MOST_OF_PAIR, fail_fast=True)
]
Rows = Items[Items[OfPair | None]]


def read_breakpoints(part: str, rows: Sequence[Sequence[OfPair | None]], n: int) -> Breakpoints:
    """Return the breakpoints of all pairs of n stops; from a stop to itself it takes no time.

    Raises:
        Refusal: They do not fit the stops, times are not ascending, or who leaves later arrives
            earlier.
    """
    check_rows(part, n, len(rows))
    for i, row in enumerate(rows):
        if len(row) != n:
            raise invalid(f"{part}/{i}", "entry-to-each", stops=n, came=len(row))
    of_pairs = [
        (pair or []) if i != j else [] for i, row in enumerate(rows) for j, pair in enumerate(row)
    ]
    ends = np.cumsum([len(pair) for pair in of_pairs])
    knots = np.array(list(chain.from_iterable(of_pairs)), np.float64).reshape(-1, 2)
    spans = np.stack((np.append(0, ends[:-1]), ends), axis=1).reshape(n, n, 2)
    found = Breakpoints(spans, knots[:, 0].copy(), knots[:, 1].copy())
    _check_order(part, found)
    return found.changed(np.stack((np.arange(n), np.arange(n)), axis=1), np.zeros(n))


def _check_order(part: str, found: Breakpoints) -> None:
    """Raise a refusal unless times are ascending, and who leaves later arrives no earlier."""
    steps, costs = np.diff(found.times), np.diff(found.costs)
    inside = np.ones(len(steps), np.bool_)
    first = found.spans[found.known][:, 0]
    inside[first[first > 0] - 1] = False  # from one pair to the next
    wrong = inside & ((steps <= 0) | (costs < -steps - _ROUNDING))
    if not wrong.any():
        return
    at = int(wrong.argmax()) + 1
    i, j = np.argwhere((found.spans[..., 0] <= at) & (at < found.spans[..., 1]))[0].tolist()
    where = f"{part}/{i}/{j}/{at - found.spans[i, j, 0]}"
    before, time = float(found.times[at - 1]), float(found.times[at])
    if time <= before:
        raise invalid(f"{where}/0", "not-later", before=before, came=time)
    least = float(found.costs[at - 1]) - (time - before)
    raise invalid(f"{where}/1", "overtakes", least=least, came=float(found.costs[at]))
