"""Turn DataFrames in requests into arrays and stops, without importing pandas or polars."""

import math
import re
from collections.abc import Mapping, Sequence
from decimal import Decimal
from numbers import Integral, Real
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from paretour.arrays import plain_array
from paretour.labels import Labelled, aligned, check_same, texts_of

COSTS = ("matrices", "matrix", "second_matrix", "costs")  # members that hold costs
_IDS = ("id", "name")
_LONGITUDES = ("lon", "lng", "longitude")
_LATITUDES = ("lat", "latitude")
_NUMBERS = ("service", "prize", "due", "release")
_OF_FLEETS = ("demand", *_NUMBERS, "window", "windows", "skills")
_DEGREES = 4326  # the EPSG code of WGS84: longitude and latitude
_SIDES = ("rows", "columns")
_ENDS = 2  # of a window
_PLAIN = {bool, float, int, str, type(None)}
_SEPARATOR = re.compile(r"[;|,]")  # between skills in one text
_MOST_SHOWN = 80  # characters of a wrong value in a sentence
# A row for each city, with its costs to all cities; None or infinity forbids the leg.
Costs = ArrayLike | Sequence[Sequence[float | None] | ArrayLike]
_Cells = list[tuple[str, Any]]  # the cells of a column: the position and the value of each


class Frame(Protocol):
    """A DataFrame of any library."""

    def to_numpy(self) -> Any:
        """Return its cells as an array."""


def without_frames(value: Any, name: str = "", ids: Sequence[str] = ()) -> Any:
    """Return the members of a request with plain arrays or stops in place of DataFrames.

    A DataFrame of `stops` has columns id, lon and lat, or a GeoDataFrame points in place of the
    last two. For fleets it has those of their stops: `windows` are lists, and `skills` lists or a
    text with semicolons, commas or bars. Any other DataFrame is a table of numbers. Costs may be
    infinite, and empty on the diagonal. A matrix of costs is put in the order of the stops by its
    labels. Where a masked array has masked costs, they are infinite.

    Args:
        value: The members, or one of them.
        name: Its name; "" for all members.
        ids: The ids of the stops of the request.

    Raises:
        ValueError: A column is missing, or a cell does not fit its column; the message names it. Or
            points have no coordinate reference system, or none that is one of the earth; or labels
            are not the ids of the stops; or an array has no numbers.
    """
    if isinstance(value, Mapping):
        if not name and "stops" in value:
            value = {**value, "stops": without_frames(value["stops"], "stops")}
            ids = _ids_of(value["stops"])
        return {key: without_frames(each, key, ids) for key, each in value.items()}
    if isinstance(value, list | tuple):
        if _PLAIN.issuperset(map(type, value)):  # as are rows of large matrices
            return list(value)
        if name in COSTS and not ids:
            check_same(name, [_labels(each) for each in value if hasattr(each, "to_numpy")])
        return [without_frames(each, name, ids) for each in value]
    if hasattr(value, "to_numpy"):
        return _stops(value) if name == "stops" else _numbers(value, name, ids)
    if isinstance(value, np.ndarray):
        return plain_array(value, name, is_cost=name in COSTS)
    return value


def _ids_of(stops: Any) -> list[str]:
    """Return the ids of stops, if each has one."""
    if not isinstance(stops, list) or not all(isinstance(each, Mapping) for each in stops):
        return []
    ids = [str(each["id"]) for each in stops if "id" in each]
    return ids if len(ids) == len(stops) else []


def has_ids(frame: Any) -> bool:
    """Return whether a DataFrame is one of stops: it names them, or has points."""
    return hasattr(frame, "to_crs") or bool(_column(frame, _IDS, needed=False))


def _numbers(frame: Any, name: str, ids: Sequence[str]) -> NDArray[Any]:
    """Return the numbers of a DataFrame, or of one column, as an array."""
    cells = np.asarray(frame.to_numpy())
    rows, columns, costs = _labels(frame), list(getattr(frame, "columns", ())), name in COSTS
    if costs and ids and cells.ndim == len(_SIDES):
        cells, rows, columns = aligned(name, Labelled(cells, rows, columns), ids)
    elif costs and rows != columns and set(rows) == set(columns):
        raise ValueError(f"{name} must have its rows and columns in the same order")
    numbers = cells if cells.dtype.kind in "iuf" else _as_floats(cells)
    wrong = ~(np.isfinite(numbers) | (costs & np.isposinf(numbers)))
    if costs and wrong.any() and len(rows) == len(columns):
        np.fill_diagonal(wrong, val=False)  # the diagonal does not count
        numbers = np.where(np.eye(len(rows), dtype=bool), 0, numbers)
    for at in map(tuple, np.argwhere(wrong)):
        column = f", column {columns[at[1]]!r}" if columns else ""
        raise _wrong(f"{name}: row {rows[at[0]]!r}{column}", "a number", cells[at])
    return numbers


def _as_floats(cells: NDArray[Any]) -> NDArray[np.float64]:
    """Return cells as numbers; a cell that is not a number becomes nan."""
    floats = [float(each) if isinstance(each, Real | Decimal) else np.nan for each in cells.flat]
    return np.array(floats, dtype=np.float64).reshape(cells.shape)


def _stops(frame: Any) -> list[dict[str, Any]]:
    ids = _ids(_column(frame, _IDS))
    locations = _points(frame) if hasattr(frame, "to_crs") else _places(frame)
    stops: list[dict[str, Any]] = [
        {"id": id_, "location": location} for id_, location in zip(ids, locations, strict=True)
    ]
    for name in _OF_FLEETS:
        for stop, (where, cell) in zip(stops, _column(frame, (name,), needed=False), strict=False):
            if not _is_empty(cell):
                stop[name] = _of_fleet(name, cell, where)
    _add_vehicles(stops, _column(frame, ("vehicle",), needed=False))
    return stops


def _places(frame: Any) -> list[list[float]]:
    """Return longitude and latitude from the columns that hold them."""
    longitudes, latitudes = (
        [_number(cell, where) for where, cell in _column(frame, names)]
        for names in (_LONGITUDES, _LATITUDES)
    )
    return [list(place) for place in zip(longitudes, latitudes, strict=True)]


def _points(frame: Any) -> list[list[float]]:
    """Return longitude and latitude of the points of a GeoDataFrame."""
    geometry = getattr(frame, "geometry", None)
    if geometry is None:
        raise ValueError("stops must have a column of points as their geometry, got none")
    if geometry.crs is None:
        raise ValueError(
            "stops must have a coordinate reference system, got none; for degrees: set_crs(4326)"
        )
    rows = [f"stops: row {row!r}, column {geometry.name!r}" for row in _labels(frame)]
    for where, point in zip(rows, geometry, strict=True):
        if getattr(point, "geom_type", None) != "Point" or point.is_empty:
            raise _wrong(where, "a point", point)
    try:
        in_degrees = geometry.to_crs(_DEGREES)
    except RuntimeError as error:  # of pyproj
        demand = f"in a coordinate reference system that can become EPSG:{_DEGREES}"
        raise ValueError(f"stops must be {demand}, got {geometry.crs.name}: {error}") from None
    return [
        [_number(point.x, where), _number(point.y, where)]
        for where, point in zip(rows, in_degrees, strict=True)
    ]


def _add_vehicles(stops: list[dict[str, Any]], cells: _Cells) -> None:
    """Add the ids of the vehicles that must visit stops, where cells have some."""
    filled = [row for row, (_, cell) in enumerate(cells) if not _is_empty(cell)]
    for where, cell in (cells[row] for row in filled):
        if not isinstance(cell, str | Real):
            raise _wrong(where, "an id", cell)
    for row, id_ in zip(filled, _ids([cells[row] for row in filled]), strict=True):
        stops[row]["vehicle"] = id_


def _column(frame: Any, names: Sequence[str], *, needed: bool = True) -> _Cells:
    """Return the cells of the first column with one of these names; none if it is not needed."""
    columns = list(getattr(frame, "columns", ()))
    plain = [str(column).lower() for column in columns]
    name = next((each for each in names if each in plain), None)
    if name is None and not needed:
        return []
    if name is None or plain.count(name) > 1:
        demand = f"a column {' or '.join(names)}" if name is None else f"one column {name}"
        came = ", ".join(map(repr, columns))[:_MOST_SHOWN] or "none"
        raise ValueError(f"stops must have {demand}, got {came}")
    column = columns[plain.index(name)]
    rows = zip(_labels(frame), frame[column], strict=True)
    return [(f"stops: row {row!r}, column {column!r}", _plain(cell)) for row, cell in rows]


def _plain(cell: Any) -> Any:
    """Return a cell, or a list if it is an array or a column of polars."""
    if isinstance(cell, np.ndarray):
        return cell.tolist()
    return cell.to_list() if hasattr(cell, "to_list") else cell


def _labels(frame: Any) -> list[Any]:
    """Return the label of each row: that of its index, or its position in a frame without one."""
    return list(getattr(frame, "index", range(len(frame))))


def _ids(cells: _Cells) -> list[str]:
    """Return ids as texts. A gap makes a column of whole numbers one of floats."""
    for where, cell in cells:
        if _is_empty(cell):
            raise _wrong(where, "an id", cell)
    return texts_of([cell for _, cell in cells])


def _of_fleet(name: str, cell: Any, where: str) -> Any:
    """Return a member of a fleet's stop: a number, or a list of numbers, windows or skills."""
    if name in _NUMBERS:
        return _number(cell, where)
    if name == "skills":
        return _skills(cell, where)
    listed = isinstance(cell, list | tuple)
    if name == "window" and not listed:
        raise _wrong(where, "two times, as [0, 3600]", cell)
    if name == "windows":
        return _windows(cell, where)
    return [_number(each, where) for each in (cell if listed else [cell])]


def _windows(cell: Any, where: str) -> list[list[float]]:
    """Return several windows, each of two times."""
    windows = [_plain(each) for each in cell] if isinstance(cell, list | tuple) else [cell]
    if not all(isinstance(each, list | tuple) and len(each) == _ENDS for each in windows):
        raise _wrong(where, "windows of two times, as [[0, 3600], [7200, 9000]]", cell)
    return [[_number(time, where) for time in each] for each in windows]


def _skills(cell: Any, where: str) -> list[str]:
    """Return skills, which are texts in a list, or in one text with separators."""
    if isinstance(cell, str):
        return [text for each in _SEPARATOR.split(cell) if (text := each.strip())]
    if not isinstance(cell, list | tuple) or not all(isinstance(each, str) for each in cell):
        raise _wrong(where, "skills, as ['fridge', 'crane']", cell)
    return list(cell)


def _number(cell: Any, where: str) -> float:
    if not isinstance(cell, Real | Decimal) or not math.isfinite(cell):
        raise _wrong(where, "a number", cell)
    return int(cell) if isinstance(cell, Integral) else float(cell)


def _is_empty(cell: Any) -> bool:
    """Return whether a cell is empty: None, or unequal to itself, as NaN, NaT and NA are."""
    if cell is None:
        return True
    same = cell == cell  # NA of pandas for NA
    return not isinstance(same, np.ndarray) and not (isinstance(same, bool | np.bool_) and same)


def _wrong(where: str, demand: str, cell: Any) -> ValueError:
    return ValueError(f"{where} must be {demand}, got {cell!r:.{_MOST_SHOWN}}")
