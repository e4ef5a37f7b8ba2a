"""Metres and seconds along straight lines over the earth, by the haversine formula in plain Python.

A second implementation, to check the arrays of the service by.
"""

from collections.abc import Sequence
from math import asin, cos, radians, sin, sqrt

_RADIUS = 6371008.8  # metres
_KMH = 3.6  # km/h that are one metre per second
_Place = Sequence[float]  # longitude and latitude in degrees


def metres_between(one: _Place, other: _Place) -> float:
    """Return the metres along the great circle from one place to another."""
    (x, y), (u, v) = (map(radians, place) for place in (one, other))
    square = sin((v - y) / 2) ** 2 + cos(y) * cos(v) * sin((u - x) / 2) ** 2
    return 2 * _RADIUS * asin(sqrt(square))


def seconds_between(one: _Place, other: _Place, speed: float) -> float:
    """Return the seconds that this way takes at a speed in km/h."""
    return metres_between(one, other) / (speed / _KMH)


def matrix_of(places: Sequence[_Place], speed: float | None = None) -> list[list[float]]:
    """Return the metres between all places, or at a speed in km/h the seconds."""
    return [
        [
            metres_between(one, other) if speed is None else seconds_between(one, other, speed)
            for other in places
        ]
        for one in places
    ]
