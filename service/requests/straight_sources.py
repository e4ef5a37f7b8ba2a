"""Sources of costs that are straight lines, which need no matrix."""

from collections.abc import Sequence
from dataclasses import replace

from service.fleet.straight import Line
from service.requests.stops import KMH, Array, Measured, Plane, Source, Stops
from service.roads.great_circle import EARTH_RADIUS


def are_straight(sources: Sequence[Source]) -> bool:
    """Return whether all costs are straight lines, in planes or by great circle."""
    return all(
        isinstance(each, Plane) or (isinstance(each, Measured) and each.measure == "great_circle")
        for each in sources
    )


def lines_of(stops: Stops) -> list[Line]:
    """Return the lines that the costs between stops are; see are_straight()."""
    return [_line(source, stops.locations) for source in stops.sources]


def _line(source: Source, locations: Array) -> Line:
    match source:
        case Plane(points):
            return Line.in_plane(points)
        case Measured("great_circle", speed):
            metres = Line.on_earth(locations, EARTH_RADIUS)
            return metres if speed is None else replace(metres, factor=KMH * metres.factor / speed)
    raise ValueError("costs must be straight lines")
