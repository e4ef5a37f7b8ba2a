"""Fronts and tours as FeatureCollections: a line for each tour, a point for each stop."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import from_json, to_json

from service.api.geojson.lines import Line, encode_line
from service.jobs.record import Record


@dataclass(frozen=True, eq=False)
class Drawing:
    """Tours of a front to be drawn on the earth.

    Args:
        record: The record of the front, whose stops all have locations.
        tours: The tours, as in its JSON.
        ways: The stops that each tour comes by, shape (tours, m), m at least 2: its end, too.
    """

    record: Record
    tours: Sequence[dict[str, Any]]
    ways: NDArray[np.int64]

    @classmethod
    def of(cls, record: Record, tours: bytes) -> "Drawing":
        """Return the drawing of tours of a front, a JSON array."""
        parsed = from_json(tours)
        # Fronts have this member where tours are open routes alone.
        returns = record.front.closed is None or record.front.cities == 1
        orders = [tour["tour"] for tour in parsed]
        ways = [[*order, order[0]] if returns else order for order in orders]
        return cls(record, parsed, np.array(ways, dtype=np.int64))

    @property
    def ids(self) -> list[str]:
        """The ids of all stops."""
        return [stop["id"] for stop in self._stops]

    @property
    def locations(self) -> NDArray[np.float64]:
        """Longitude and latitude of all stops in degrees, shape (n, 2)."""
        return np.array([stop["location"] for stop in self._stops], dtype=np.float64)

    @property
    def straight_lines(self) -> list[Line]:
        """The straight way of each tour from stop to stop."""
        return list(self.locations[self.ways])

    def encode(self, lines: Sequence[Line]) -> bytes:
        """Return the FeatureCollection of the tours along these lines, and of all stops.

        The front's id and status, and the problem of a failed one, are members of its own.
        """
        record = self.record
        foreign: dict[str, Any] = {"id": record.id, "status": record.status}
        if record.problem is not None:
            foreign["problem"] = record.problem
        head = to_json({"type": "FeatureCollection", **foreign})[:-1]
        features = [*self._tour_features(lines), *map(_point, self._stops)]
        return b"".join((head, b',"features":[', b",".join(features), b"]}"))

    @property
    def _stops(self) -> Sequence[dict[str, Any]]:
        return self.record.front.stops or ()

    def _tour_features(self, lines: Sequence[Line]) -> Iterator[bytes]:
        objectives = self.record.front.objectives or ()
        common = {
            "front": self.record.id,
            "names": [objective["name"] for objective in objectives],
            "units": [objective["unit"] for objective in objectives],
        }
        for tour, line in zip(self.tours, lines, strict=True):
            properties = {name: value for name, value in tour.items() if name != "tour"}
            ends = to_json({"type": "Feature", "properties": {**common, **properties}})
            yield b"".join((ends[:-1], b',"geometry":', encode_line(line), b"}"))


def _point(stop: dict[str, Any]) -> bytes:
    geometry = {"type": "Point", "coordinates": stop["location"]}
    properties = {"stop": stop["id"]}
    feature = {"type": "Feature", "id": stop["id"], "geometry": geometry, "properties": properties}
    return to_json(feature)
