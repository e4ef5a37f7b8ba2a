"""Arrays in requests: matrices and maps from rows of numbers, and their checks.

Every function raises a refusal that points at the row or the number at fault.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from pydantic import GetPydanticSchema, ValidationInfo
from pydantic_core import to_json
from pydantic_core.core_schema import with_info_after_validator_function

from service.requests.schemas import ArrayRows
from service.requests.validation import invalid

Array = NDArray[np.float64]
Rows = list[list[float]]


def array_field(parse: Callable[[Rows, str], Array]) -> GetPydanticSchema:
    """Return the schema of a field of rows that is parsed with its name into an array."""

    def parse_named(rows: Rows, info: ValidationInfo) -> Array:
        return parse(rows, str(info.field_name))

    return GetPydanticSchema(
        lambda _, handler: with_info_after_validator_function(parse_named, handler(ArrayRows))
    )


def stack_matrices(matrices: list[Rows]) -> Array:
    """Return one matrix for each objective as an array, shape (2, n, n).

    Raises:
        Refusal: A matrix is not square, or they differ in size.
    """
    arrays = [square_array(rows, f"matrices/{m}") for m, rows in enumerate(matrices)]
    n = len(arrays[0])
    for m, array in enumerate(arrays):
        if len(array) != n:
            demand = f"must have {n} rows, as many as matrices/0, got {len(array)}"
            raise invalid(f"matrices/{m}", demand)
    return np.stack(arrays)


def square_array(rows: Rows, name: str) -> Array:
    """Return the rows of a matrix as an array, shape (n, n).

    Raises:
        Refusal: A row is not as long as there are rows.
    """
    matrix = rectangular_array(rows, name)
    n, width = matrix.shape
    if n != width:
        raise invalid(name, f"must be square, got {n} rows of {width} numbers")
    return matrix


def rectangular_array(rows: Rows, name: str) -> Array:
    """Return rows of numbers as an array, shape (rows, columns).

    Raises:
        Refusal: There is no number, or the rows differ in length.
    """
    if not rows or not rows[0]:
        raise invalid(name, "must have a row of numbers or more, got none")
    width = len(rows[0])
    for i, row in enumerate(rows):
        if len(row) != width:
            raise invalid(f"{name}/{i}", f"must have {width} numbers, as the first, got {len(row)}")
    return np.array(rows, dtype=np.float64)


def check_costs(matrix: Array, name: str, largest: float) -> None:
    """Raise a refusal unless all entries of a matrix, shape (n, n), off its diagonal are costs.

    Raises:
        Refusal: An entry is not finite, negative or too large.
    """
    # A comparison with NaN is false, so what is not a number is found as well.
    with np.errstate(invalid="ignore"):
        is_cost = (matrix >= 0) & (matrix <= largest) | np.eye(len(matrix), dtype=np.bool_)
    if is_cost.all():
        return
    i, j = np.unravel_index(is_cost.argmin(), is_cost.shape)
    entry = float(matrix[i, j])
    if not np.isfinite(entry):
        demand = "must be a finite number"
    else:
        demand = "must not be negative" if entry < 0 else f"must be at most {largest:g}"
    shown = to_json(entry, inf_nan_mode="constants").decode()
    raise invalid(f"{name}/{i}/{j}", f"{demand}, got {shown}")
