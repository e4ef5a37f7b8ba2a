"""Costs of legs in straight lines, worked out where they are read: a matrix would be too large."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
_ALL = slice(None)


@dataclass(frozen=True, eq=False)
class Line:
    """One cost of the legs between n stops: a straight line, or the way along a sphere.

    Args:
        places: Where the stops are, shape (n, 3): in a plane, or on a sphere of radius 1.
        curved: Whether legs are along the sphere.
        factor: What a leg of length 1 costs.
    """

    places: Array
    curved: bool
    factor: float

    @classmethod
    def in_plane(cls, points: Array) -> "Line":
        """Return the lines between points of a plane, shape (n, 2).

        They are divided by a power of two, so that no square of a coordinate is infinite or 0.
        """
        centred = points - points.min(axis=0, initial=np.inf)
        unit = float(np.ldexp(1.0, np.frexp(centred.max(initial=0.0))[1]))
        places = np.column_stack((centred / unit, np.zeros(len(points))))
        return cls(places, curved=False, factor=unit)

    @classmethod
    def on_earth(cls, locations: Array, radius: float) -> "Line":
        """Return the ways between places on a sphere.

        Args:
            locations: Longitude and latitude of each place in degrees, shape (n, 2).
            radius: What an angle of 1 costs along the sphere.
        """
        longitude, latitude = np.radians(locations).T
        level = np.cos(latitude)
        places = np.column_stack(
            (level * np.cos(longitude), level * np.sin(longitude), np.sin(latitude))
        )
        return cls(places, curved=True, factor=radius)

    def legs(self, a: int | Indices, b: int | Indices) -> Array:
        """Return what legs from stops to others cost, of shapes that broadcast."""
        return self._costs(self._squares(a, b))

    def legs_from(self, stop: int) -> Array:
        """Return what the legs from a stop to all stops cost, or from all to it, shape (n,)."""
        return self._costs(self._squares(_ALL, stop))

    def _squares(self, a: int | slice | Indices, b: int | Indices) -> Array:
        """Return the squares of the lines from stops to others."""
        return sum((axis[a] - axis[b]) ** 2 for axis in self.places.T)

    def _costs(self, square: Array) -> Array:
        """Return what legs cost, of whose lines these are the squares."""
        lines = np.sqrt(square)
        if self.curved:
            lines = 2.0 * np.arcsin(np.minimum(1.0, 0.5 * lines))
        return self.factor * lines

    def greatest(self) -> float:
        """Return the greatest cost of a leg.

        Two stops are no farther apart than both are from the middle together, so that legs from
        stops near the middle need not be looked at.
        """
        radii = np.sqrt(((self.places - self.places.mean(axis=0)) ** 2).sum(axis=1))
        farthest = np.argsort(-radii)
        most = 0.0
        for stop in farthest.tolist():
            if radii[stop] + radii[farthest[0]] < most:
                break
            most = max(most, float(np.sqrt(np.max(self._squares(_ALL, stop)))))
        return float(self._costs(np.array(most**2)))

    def scaled(self, shift: int) -> "Line":
        """Return the line with costs times a power of two."""
        return replace(self, factor=float(np.ldexp(self.factor, shift)))

    def chosen(self, stops: Indices) -> "Line":
        """Return the line between some of the stops, which may repeat."""
        return replace(self, places=self.places[stops])
