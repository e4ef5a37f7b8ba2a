"""Arrays in requests: matrices and maps from rows of numbers, and their checks.

Every function raises a refusal that points at the row or the number at fault.
"""

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import GetPydanticSchema, ValidationInfo
from pydantic_core.core_schema import with_info_after_validator_function

from service.errors import invalid
from service.requests.fields import LARGEST
from service.requests.validation import too_many_cells

Array = NDArray[np.float64]
Rows = list[list[float]]
CostRows = list[list[float | None]]
AnyRows = TypeVar("AnyRows", Rows, CostRows)


def array_field(parse: Callable[[Any, str], Array], rows_type: Any) -> GetPydanticSchema:
    """Return the schema of a field of rows of a type, parsed with its name into an array."""

    def parse_named(rows: Any, info: ValidationInfo) -> Array:
        return parse(rows, str(info.field_name))

    return GetPydanticSchema(
        lambda _, handler: with_info_after_validator_function(parse_named, handler(rows_type))
    )


def stack_matrices(matrices: list[CostRows], name: str = "matrices") -> Array:
    """Return the costs of each objective as one array, shape (m, n, n), as `cost_matrix` does.

    Raises:
        Refusal: A matrix is not square, or they differ in size, or an entry is not finite.
    """
    arrays = [cost_matrix(rows, f"{name}/{m}") for m, rows in enumerate(matrices)]
    n = len(arrays[0])
    for m, array in enumerate(arrays):
        if len(array) != n:
            other = f"/{name}/0"
            raise invalid(f"{name}/{m}", "other-height", rows=n, other=other, came=len(array))
    return np.stack(arrays)


def cost_matrix(rows: CostRows, name: str) -> Array:
    """Return rows of costs as an array, shape (n, n), infinite where they have null.

    The diagonal becomes 0; its values are ignored.

    Raises:
        Refusal: The rows are not those of a square matrix, or an entry is not finite.
    """
    matrix = rectangular_array(rows, name)
    n, width = matrix.shape
    if n != width:
        raise invalid(name, "not-square", rows=n, columns=width)
    np.fill_diagonal(matrix, 0.0)
    if np.isfinite(matrix).all():
        return matrix
    null = np.array([[cost is None for cost in row] for row in rows])
    np.fill_diagonal(null, False)
    matrix[null] = 0.0
    for i, j in np.argwhere(~np.isfinite(matrix))[:1]:
        raise invalid(f"{name}/{i}/{j}", "not-a-cost", came=float(matrix[i, j]))
    matrix[null] = np.inf
    return matrix


def costs_array(costs: Sequence[float | None]) -> Array:
    """Return finite costs as an array, shape (n,), infinite where they have None."""
    array = np.array(costs, dtype=np.float64)
    array[np.isnan(array)] = np.inf
    return array


def rectangular_array(rows: AnyRows, name: str) -> Array:
    """Return rows of numbers as an array, shape (rows, columns), NaN where they have null.

    Raises:
        Refusal: It has no numbers, or the rows differ in length.
    """
    if not rows or not rows[0]:
        raise invalid(name, "no-rows")
    width = len(rows[0])
    for i, row in enumerate(rows):
        if len(row) != width:
            raise invalid(f"{name}/{i}", "other-width", numbers=width, came=len(row))
    return np.array(rows, dtype=np.float64)


def costs_between(rows: CostRows, name: str, n: int) -> Array:
    """Return the costs between n stops, shape (n, n), as `cost_matrix` does, checked.

    Raises:
        Refusal: There is not a row for each stop, a matrix is not square, or an entry no cost.
    """
    check_rows(name, n, len(rows))
    matrix = cost_matrix(rows, name)
    check_costs(matrix, name)
    return matrix


def check_rows(part: str, n: int, rows: int) -> None:
    """Raise a refusal unless there is a row for each of n stops."""
    if rows != n:
        raise invalid(part, "row-each", stops=n, came=rows)


def check_grid(grid: Array) -> None:
    """Raise a refusal unless all cells of a map, shape (rows, columns), are 0 or 1."""
    binary = (grid == 0) | (grid == 1)
    if not binary.all():
        row, column = np.unravel_index(binary.argmin(), binary.shape)
        raise invalid(f"grid/{row}/{column}", "not-0-or-1", came=float(grid[row, column]))


def check_size(columns: int, rows: int, most: int) -> None:
    """Raise a refusal unless a map has a cell or more and at most `most`, before it is read."""
    if columns * rows > most:
        raise too_many_cells(most, columns * rows, f"{rows} x {columns}")
    if columns * rows == 0:
        raise invalid("grid", "no-cells", rows=rows, columns=columns)


def check_costs(matrix: Array, name: str) -> None:
    """Raise a refusal unless all entries of a matrix, shape (n, n), off its diagonal are costs.

    An infinite entry forbids its leg.

    Raises:
        Refusal: An entry is not a number, negative or too large.
    """
    # A comparison with NaN is false, so NaN is found as well.
    with np.errstate(invalid="ignore"):
        is_cost = (matrix >= 0) & ((matrix <= LARGEST) | (matrix == np.inf))
    is_cost |= np.eye(len(matrix), dtype=np.bool_)
    if is_cost.all():
        return
    i, j = np.unravel_index(is_cost.argmin(), is_cost.shape)
    entry = float(matrix[i, j])
    where = f"{name}/{i}/{j}"
    if entry > LARGEST:
        raise invalid(where, "cost-too-large", most=LARGEST, came=entry)
    raise invalid(where, "negative-cost" if entry < 0 else "not-a-number", came=entry)
