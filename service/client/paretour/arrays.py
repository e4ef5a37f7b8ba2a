"""Arrays of NumPy in requests: those of numbers as they are, masked ones, and those of objects."""

from decimal import Decimal
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

_NUMBERS = "biuf"  # kinds of types: booleans, whole numbers and floats
_TEXTS = "U"
_MOST_SHOWN = 80  # characters of a wrong value in a sentence


def plain_array(array: NDArray[Any], name: str, *, is_cost: bool) -> NDArray[Any]:
    """Return an array of numbers, of texts, or of numbers and None.

    A masked cost means that no way leads there: it becomes infinite.

    Raises:
        ValueError: It has another type, or is masked and has no costs.
    """
    if array.dtype.kind not in (*_NUMBERS, *_TEXTS, "O"):
        raise ValueError(f"{name} must be numbers, got an array of {array.dtype}")
    if isinstance(array, np.ma.MaskedArray):
        array = _filled(array, name, is_cost=is_cost)
    return _without_objects(array, name) if array.dtype.kind == "O" else array


def _filled(array: "np.ma.MaskedArray[Any, Any]", name: str, *, is_cost: bool) -> NDArray[Any]:
    masked = int(np.ma.count_masked(array))
    if masked and not is_cost:
        raise ValueError(f"{name} must have no masked cells, got {masked}")
    if not masked:
        return np.asarray(array.data)
    if array.dtype.kind == "O":
        cells = np.array(array.data)
        cells[np.ma.getmaskarray(array)] = None
        return cells
    return np.asarray(array.astype(np.float64).filled(np.inf))


def _without_objects(array: NDArray[Any], name: str) -> NDArray[Any]:
    """Return an array of objects as one of floats, if all are numbers, or with floats in it."""
    cells = [_plain(each, name) for each in array.flat]
    if cells and all(isinstance(each, float) for each in cells):
        return np.array(cells).reshape(array.shape)
    made = np.empty(len(cells), object)
    made[:] = cells
    return made.reshape(array.shape)


def _plain(cell: Any, name: str) -> Any:
    if isinstance(cell, np.ma.core.MaskedConstant):
        raise ValueError(f"{name} must have no masked cells, got 1")
    if isinstance(cell, Real | Decimal) and not isinstance(cell, bool):
        return float(cell)
    if cell is None or isinstance(cell, bool | str | list | dict):
        return cell
    raise ValueError(f"{name} must be numbers, got {cell!r:.{_MOST_SHOWN}}")


def plain_object(value: Any) -> Any:
    """Return a value that JSON does not know as one that it does.

    Raises:
        ValueError: It is not a number, text, array, list or mapping.
    """
    if isinstance(value, Decimal):
        return float(value)
    if isinstance(value, np.ndarray | np.generic):
        if value.dtype.kind in (*_NUMBERS, *_TEXTS, "O"):
            return value.tolist()
    elif hasattr(value, "tolist"):  # arrays of others
        return value.tolist()
    kind = type(value).__name__
    raise ValueError(
        "a request must consist of numbers, texts, lists and mappings, got"
        f" {value!r:.{_MOST_SHOWN}} of type {kind}"
    )
