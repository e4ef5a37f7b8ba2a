"""Two matrices of costs as they travel, and every demand on them."""

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from service.problems import Fault, Refusal

Array = NDArray[np.float64]
Rows = list[list[float]]


def stacked(matrices: list[Rows]) -> Array:
    """Two matrices of numbers as an array, shape (2, n, n).

    Raises:
        Refusal: one is not square, or they differ in size.
    """
    n = len(matrices[0])
    for m, rows in enumerate(matrices):
        _check_square(f"matrices/{m}", rows)
        if len(rows) != n:
            sentence = f"must have {n} rows, as many as matrices/0, got {len(rows)}"
            raise _invalid(f"matrices/{m}", sentence)
    return np.array(matrices, dtype=np.float64)


def check_costs(matrices: Array, largest: float) -> None:
    """Nothing, if all that stands beside the diagonals, shape (2, n, n), is a cost.

    Raises:
        Refusal: something is not finite, negative or too large.
    """
    n = matrices.shape[1]
    # A comparison with NaN is false, so what is not a number is found as well.
    costs = (matrices >= 0) & (matrices <= largest) | np.eye(n, dtype=np.bool_)
    if costs.all():
        return
    m, i, j = np.unravel_index(costs.argmin(), costs.shape)
    cost = float(matrices[m, i, j])
    shown = to_json(cost, inf_nan_mode="constants").decode()
    if not np.isfinite(cost):
        demand = "must be a finite number"
    else:
        demand = "must not be negative" if cost < 0 else f"must be at most {largest:g}"
    raise _invalid(f"matrices/{m}/{i}/{j}", f"{demand}, got {shown}")


def _check_square(name: str, rows: Rows) -> None:
    n = len(rows)
    widths = [len(row) for row in rows]
    if not n:
        raise _invalid(name, "must have a row for each city, got none")
    if widths == [n] * n:
        return
    if len(set(widths)) == 1:
        raise _invalid(name, f"must be square, got {n} rows of {widths[0]} numbers")
    i = next(i for i, width in enumerate(widths) if width != n)
    raise _invalid(f"{name}/{i}", f"must have {n} numbers, one for each row, got {widths[i]}")


def _invalid(name: str, demand: str) -> Refusal:
    detail = f"{name} {demand}"
    fault = Fault(pointer=f"/{name}", detail=detail)
    return Refusal(422, "invalid-request", detail, errors=[fault])
