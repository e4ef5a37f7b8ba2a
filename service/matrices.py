"""Two matrices of costs as they travel, and every demand on them."""

from collections.abc import Callable, Mapping
from io import BytesIO
from math import prod
from typing import Any

import numpy as np
from numpy.lib.format import read_array_header_1_0, read_array_header_2_0, read_magic
from numpy.typing import NDArray
from pydantic_core import to_json

from service.problems import Fault, Refusal

Array = NDArray[np.float64]
Rows = list[list[float]]
Header = Callable[[BytesIO], tuple[tuple[int, ...], bool, np.dtype[Any]]]

_HEADERS: Mapping[tuple[int, int], Header] = {
    (1, 0): read_array_header_1_0,
    (2, 0): read_array_header_2_0,
}


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


def loaded(content: bytes, most: int) -> Array:
    """Two matrices from a file as numpy.save writes it. Its header is checked before all else.

    Raises:
        Refusal: it is no such file, not of numbers, not two square matrices, or too large.
    """
    stream = BytesIO(content)
    try:
        read_header = _HEADERS[read_magic(stream)]
        shape, by_columns, dtype = read_header(stream)
    except (KeyError, ValueError, EOFError):
        raise _invalid("matrices", "must be a .npy file of version 1 or 2") from None
    _check_header(shape, dtype, most)
    demanded, came = prod(shape) * dtype.itemsize, len(content) - stream.tell()
    if came != demanded:
        raise _invalid("matrices", f"must have {demanded} bytes after its header, got {came}")
    numbers = np.frombuffer(content, dtype, offset=stream.tell())
    return numbers.reshape(shape, order="F" if by_columns else "C").astype(np.float64)


def too_many_cities(name: str, limit: int, actual: int) -> Refusal:
    """The refusal of more cities than are allowed."""
    return Refusal(
        413,
        "too-many-cities",
        f"{name} must have at most {limit} rows, got {actual}",
        errors=[Fault(pointer=f"/{name}", detail="too many rows")],
        limit=limit,
        actual=actual,
    )


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


def _check_header(shape: tuple[int, ...], dtype: np.dtype[Any], most: int) -> None:
    if dtype.kind not in "fiu" or dtype.itemsize > 8:
        raise _invalid("matrices", f"must be of real numbers of at most 8 bytes, got {dtype}")
    if len(shape) != 3 or shape[0] != 2 or shape[1] != shape[2] or shape[1] < 1:
        raise _invalid("matrices", f"must have shape (2, n, n) with n at least 1, got {shape}")
    if shape[1] > most:
        raise too_many_cities("matrices", most, shape[1])


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
