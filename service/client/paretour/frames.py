"""Members of requests that are DataFrames, as arrays and stops. No library of them is imported."""

from collections.abc import Mapping
from typing import Any

_IDS = ("id", "name")
_LONGITUDES = ("lon", "lng", "longitude")
_LATITUDES = ("lat", "latitude")
_OF_FLEETS = ("demand", "service", "prize", "window")


def without_frames(value: Any, name: str = "") -> Any:
    """Return members of a request with arrays, or stops, in place of DataFrames.

    A DataFrame of `stops` has columns id, lon and lat, and maybe those of a fleet's stops; every
    other one is a table of numbers.

    Raises:
        ValueError: Stops lack a column; the message names it.
    """
    if isinstance(value, Mapping):
        return {key: without_frames(each, key) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [without_frames(each) for each in value]
    if not hasattr(value, "to_numpy"):
        return value
    return _stops(value) if name == "stops" else value.to_numpy()


def _stops(frame: Any) -> list[dict[str, Any]]:
    columns = {str(column).lower(): column for column in frame.columns}
    ids = _column(columns, _IDS)
    longitudes, latitudes = _column(columns, _LONGITUDES), _column(columns, _LATITUDES)
    places = zip(frame[ids], frame[longitudes], frame[latitudes], strict=True)
    stops: list[dict[str, Any]] = [
        {"id": str(id_), "location": [float(longitude), float(latitude)]}
        for id_, longitude, latitude in places
    ]
    for name in _OF_FLEETS:
        if name in columns:
            for stop, value in zip(stops, frame[columns[name]], strict=True):
                _add(stop, name, value.tolist() if hasattr(value, "tolist") else value)
    return stops


def _add(stop: dict[str, Any], name: str, value: Any) -> None:
    """Add a member to a stop, unless its cell is empty."""
    if value is None or value != value:  # not a number: how an empty cell is read
        return
    stop[name] = [value] if name == "demand" and not isinstance(value, list | tuple) else value


def _column(columns: Mapping[str, Any], names: tuple[str, ...]) -> Any:
    for name in names:
        if name in columns:
            return columns[name]
    raise ValueError(f"stops must have a column {' or '.join(names)}, got {', '.join(columns)}")
