"""Write fronts and tours as FeatureCollections: lines of tours or routes, points of stops."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import from_json, to_json

from service.jobs.record import Record
from service.kinds.front_document import with_member
from service.kinds.table import KINDS

Line = NDArray[np.float64]  # longitude and latitude in degrees of each position, shape (m, 2)
_HALF_WAY_ROUND = 180.0  # degrees of longitude
_PART = 2**14  # positions that are written at once: a list takes ten times the memory of its text


@dataclass(frozen=True, eq=False)
class Drawing:
    """Tours of a front to be drawn on the earth.

    Args:
        record: The record of the front, whose stops all have locations.
        tours: The tours, as in its JSON.
        ways: The stops of each tour in order, two or more, with its end.
    """

    record: Record
    tours: Sequence[dict[str, Any]]
    ways: Sequence[Sequence[int]]

    @classmethod
    def of(cls, record: Record, tours: bytes, first: int = 0) -> "Drawing":
        """Return the drawing of tours of a front, or of the routes of its plans.

        Args:
            record: The record of the front, whose stops all have locations.
            tours: Tours or plans that follow one another in the front, a JSON array.
            first: The number of the first one.
        """
        parsed = from_json(tours)
        if KINDS[record.front.kind].mover:
            return cls._of_plans(record, parsed, first)
        # Fronts have this member only if their tours are open routes.
        returns = record.front.closed is None or record.front.cities == 1
        orders = [tour["tour"] for tour in parsed]
        ways = [[*order, order[0]] if returns else order for order in orders]
        return cls(record, parsed, ways)

    @classmethod
    def _of_plans(cls, record: Record, plans: Sequence[dict[str, Any]], first: int) -> "Drawing":
        """Return the drawing of all routes, each with the number of its plan and its lengths."""
        indexes = {stop["id"]: index for index, stop in enumerate(record.front.stops or ())}
        routes = [
            {"plan": number, **_place(plan), "plan_lengths": plan["lengths"], **route}
            for number, plan in enumerate(plans, first)
            for route in plan["routes"]
        ]
        ways = [[indexes[stop] for stop in route["stops"]] for route in routes]
        # A line has two or more positions, even the line of a route of one stop.
        return cls(record, routes, [way if len(way) > 1 else way * 2 for way in ways])

    @property
    def profiles(self) -> list[str | None]:
        """The profile of the vehicle of each route, if it has one."""
        return [tour.get("profile") for tour in self.tours]

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
        return [self.locations[np.array(way, dtype=np.int64)] for way in self.ways]

    def encode(self, lines: Sequence[Line]) -> bytes:
        """Return the FeatureCollection of the tours along these lines, and of all stops.

        It also has the front's id and status, and the problem of a failed front.
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
            yield with_member(ends, b"geometry", encode_line(line))


def _point(stop: dict[str, Any]) -> bytes:
    geometry = {"type": "Point", "coordinates": stop["location"]}
    properties = {"stop": stop["id"]}
    feature = {"type": "Feature", "id": stop["id"], "geometry": geometry, "properties": properties}
    return to_json(feature)


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
    """Return where a step crosses longitude 180: the end of one part, and the start of the next."""
    edge = _HALF_WAY_ROUND if from_x > x else -_HALF_WAY_ROUND
    rest = x + 2 * edge - from_x
    latitude = from_y + (y - from_y) * ((edge - from_x) / rest if rest else 0.0)
    return (edge, latitude), (-edge, latitude)


def _encode_positions(line: Line) -> bytes:
    parts = (line[i : i + _PART] for i in range(0, len(line), _PART))
    return b"[" + b",".join(to_json(part.tolist())[1:-1] for part in parts) + b"]"


def _place(plan: dict[str, Any]) -> dict[str, Any]:
    """Return where a plan stands in its front: its balance, or its losses."""
    return {name: plan[name] for name in ("balance", "losses") if name in plan}
