"""Lines of GeoJSON: from positions to a geometry, cut where it crosses longitude 180."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

Line = NDArray[np.float64]  # longitude and latitude in degrees of each position, shape (m, 2)
_HALF_WAY_ROUND = 180.0  # degrees of longitude
_PART = 2**14  # positions that are written at once: a list takes ten times the memory of its text


def encode_line(way: Line) -> bytes:
    """Return the line through two or more positions as JSON.

    It is cut where it crosses longitude 180: a step takes the shorter way round the earth (RFC
    7946, section 3.1.9).
    """
    lines = [_encode_positions(line) for line in cut(way)]
    if len(lines) == 1:
        return b'{"type":"LineString","coordinates":' + lines[0] + b"}"
    return b'{"type":"MultiLineString","coordinates":[' + b",".join(lines) + b"]}"


def cut(way: Line) -> Iterator[Line]:
    """Yield the parts of a line between its crossings of longitude 180."""
    begin, crossing = 0, np.empty((0, 2))
    for i in np.flatnonzero(np.abs(np.diff(way[:, 0])) > _HALF_WAY_ROUND).tolist():
        end, opposite = _crossing(*way[i].tolist(), *way[i + 1].tolist())
        yield np.vstack((crossing, way[begin : i + 1], end))
        begin, crossing = i + 1, np.array([opposite])
    yield np.vstack((crossing, way[begin:]))


def _crossing(
    from_x: float, from_y: float, x: float, y: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return where a step crosses longitude 180, by the longitude before it and that behind it."""
    edge = _HALF_WAY_ROUND if from_x > x else -_HALF_WAY_ROUND
    rest = x + 2 * edge - from_x
    latitude = from_y + (y - from_y) * ((edge - from_x) / rest if rest else 0.0)
    return (edge, latitude), (-edge, latitude)


def _encode_positions(line: Line) -> bytes:
    parts = (line[i : i + _PART] for i in range(0, len(line), _PART))
    return b"[" + b",".join(to_json(part.tolist())[1:-1] for part in parts) + b"]"
