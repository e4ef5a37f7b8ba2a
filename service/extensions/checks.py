"""Call a function of another package, and check that it returns tours.

So a fault of the function becomes an error of the request, and not a wrong front.
"""

import logging
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.errors import Cancelled, Refusal
from service.instance import Instance

Tours = NDArray[np.int64]
_MOST_TOURS = 50_000  # that a function may return: to choose among more takes too long
_CHECKED_AT_ONCE = 2**22  # cities of tours, to bound the memory


class _Raised(NamedTuple):
    """The name of the error that a function raised."""

    name: str


def called(function: Callable[..., Any], *arguments: Any) -> Any:
    """Return the result of a function, or a `_Raised` if it raised; the traceback is logged.

    Raises:
        Cancelled: The function raised it.
    """
    try:
        return function(*arguments)
    except Cancelled:
        raise
    except Exception as error:
        logging.getLogger("paretour").exception("an extension failed")
        return _Raised(type(error).__name__)


def checked(found: Any, instance: Instance, at: str, rows: int | None = None) -> Tours:
    """Return the result of `called(...)` as tours, shape (t, n).

    Args:
        instance: The instance with n cities.
        at: The function in words, for the error.
        rows: The number of tours that there must be; None for any number, of a search. Only the
            tours of a search must have the start and the end of an open route.

    Raises:
        Refusal: The function raised, or its result is not such tours.
    """
    if fault := _fault(found, instance, rows):
        raise Refusal("extension-failed", extension=at, fault=fault)
    tours: Tours = np.asarray(found).astype(np.int64)
    if not instance.closed and rows is None and (fault := _fault_of_ends(tours, instance)):
        raise Refusal("extension-failed", extension=at, fault=fault)
    return tours


def _fault(found: Any, instance: Instance, rows: int | None) -> str | None:
    """Return a sentence that says what is wrong with a result, or None."""
    if isinstance(found, _Raised):
        return f"must return tours, and raised {found.name}"
    n = instance.n
    try:
        tours = np.asarray(found)
    except ValueError:  # rows of different lengths
        return "must return an array of tours, got rows of different lengths"
    if tours.dtype.kind not in "iu":
        return f"must return tours of whole numbers, got {tours.dtype}"
    wanted = f"({'t' if rows is None else rows}, {n})"
    if tours.ndim != 2 or tours.shape[1] != n or rows not in (None, len(tours)):
        return f"must return tours of shape {wanted}, got {tours.shape}"
    if len(tours) > _MOST_TOURS:
        return f"must return at most {_MOST_TOURS} tours, got {len(tours)}"
    return _fault_of_permutations(tours, n)


def _fault_of_permutations(tours: NDArray[np.integer], n: int) -> str | None:
    step = max(1, _CHECKED_AT_ONCE // n)
    for first in range(0, len(tours), step):
        wrong = (np.sort(tours[first : first + step], axis=1) != np.arange(n)).any(axis=1)
        if wrong.any():
            row = first + int(wrong.argmax())
            return f"must visit each of {n} cities once in each tour, and does not in row {row}"
    return None


def _fault_of_ends(tours: Tours, instance: Instance) -> str | None:
    for place, city in ((0, instance.start), (-1, instance.end)):
        if city is not None and (tours[:, place] != city).any():
            word = "start" if place == 0 else "end"
            return f"must {word} each route at city {city}, and does not"
    return None
