"""Align the matrix in a DataFrame by its labels with the ids of the stops of a request."""

from collections import Counter
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

_MOST_SHOWN = 80  # characters of a label


class Labelled(NamedTuple):
    """The cells of a matrix with the labels of its rows and columns."""

    cells: NDArray[Any]
    rows: list[Any]
    columns: list[Any]


def aligned(name: str, matrix: Labelled, ids: Sequence[str]) -> Labelled:
    """Return a matrix whose rows and columns are in the order of ids.

    Rows and columns that are counted from 0 have no labels: they are in the order of the ids. So
    are those of a DataFrame that must name its columns, as of polars, if no name is an id.

    Raises:
        ValueError: A label is not an id, an id has no label, or only one side has labels, and these
            are in another order.
    """
    if matrix.cells.shape != (len(matrix.rows), len(matrix.columns)):
        return matrix
    known = set(ids)
    rows, columns = (texts_of(each) for each in (matrix.rows, matrix.columns))
    by_row = not _is_counted(matrix.rows)
    by_column = not _is_counted(matrix.columns) and (by_row or bool(known & {*columns}))
    for side, texts, is_used in (("row", rows, by_row), ("column", columns, by_column)):
        if is_used:
            _check(name, side, texts, ids)
        elif {*texts} == known and texts != [*ids]:
            raise ValueError(
                f"{name} has {side}s that are counted from 0, and the stops have these numbers as"
                " ids in another order: name its rows and columns by ids, or give an array"
            )
    if by_row != by_column:
        used = rows if by_row else columns
        if used != [*ids]:
            raise ValueError(
                f"{name} must name both its rows and its columns by the ids of the stops, as they"
                " are in another order"
            )
        return matrix
    if not by_row:
        return matrix
    down, across = ([texts.index(each) for each in ids] for texts in (rows, columns))
    return Labelled(
        matrix.cells[np.ix_(down, across)],
        [matrix.rows[at] for at in down],
        [matrix.columns[at] for at in across],
    )


def check_same(name: str, labels: Sequence[Sequence[Any]]) -> None:
    """Raise ValueError if matrices without stops have labels, and these differ.

    Args:
        name: The member that has the matrices.
        labels: The labels of the rows of each matrix.
    """
    named = [texts_of(each) for each in labels if not _is_counted(each)]
    if any(each != named[0] for each in named[1:]):
        raise ValueError(
            f"{name} must have the same labels in the same order, as there are no stops whose ids"
            f" they are; got {_few(named[0])} and {_few(next(n for n in named if n != named[0]))}"
        )


def _check(name: str, side: str, texts: Sequence[str], ids: Sequence[str]) -> None:
    known = set(ids)
    strange = [each for each in texts if each not in known]
    if strange:
        raise ValueError(
            f"{name}: {side} {strange[0]!r:.{_MOST_SHOWN}} must be the id of a stop; ids are"
            f" {_few(ids)}. For a matrix in the order of the stops, give an array: .to_numpy()"
        )
    double = [each for each, count in Counter(texts).items() if count > 1]
    if double:
        raise ValueError(f"{name}: {side} {double[0]!r:.{_MOST_SHOWN}} must come once")
    missing = [each for each in ids if each not in {*texts}]
    if missing:
        raise ValueError(f"{name} must have a {side} of stop {missing[0]!r:.{_MOST_SHOWN}}")


def _is_counted(labels: Sequence[Any]) -> bool:
    """Return whether labels are 0, 1, 2, as where none were given."""
    return all(isinstance(each, int) for each in labels) and [*labels] == [*range(len(labels))]


def texts_of(labels: Sequence[Any]) -> list[str]:
    """Return labels as ids are sent: whole numbers without a fraction, so that 1.0 becomes 1."""
    floats = [each for each in labels if isinstance(each, float)]
    whole = all(each.is_integer() for each in floats)
    return [str(int(each) if whole and isinstance(each, float) else each) for each in labels]


def _few(texts: Sequence[str]) -> str:
    more = ", ..." if len(texts) > 3 else ""
    return ", ".join(f"{each!r:.{_MOST_SHOWN}}" for each in texts[:3]) + more
