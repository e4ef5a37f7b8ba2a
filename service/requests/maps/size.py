"""The bound on the size of a map, which is checked before any of its cells is read."""

from service.errors import invalid
from service.requests.validation import too_many_cells


def check_size(columns: int, rows: int, most: int) -> None:
    """Raise a refusal unless a map has a cell or more, and not too many.

    Raises:
        Refusal: It has none, or more than `most`.
    """
    if columns * rows > most:
        raise too_many_cells(most, columns * rows, f"{rows} x {columns}")
    if columns * rows == 0:
        raise invalid("grid", f"must have a cell or more, got {rows} x {columns}")
