"""Valhalla's interface: /locate, /sources_to_targets and /route, by its API documentation."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, Field
from pydantic_core import to_json

from service.roads.answers import (
    BYTES_OF_ANSWER,
    BYTES_OF_PAIR,
    BYTES_OF_PLACE,
    BYTES_OF_ROUTE,
    Latitude,
    Longitude,
    Rows,
    costs_of,
    read,
)
from service.roads.great_circle import great_circle_distances
from service.roads.polyline import decode_polyline
from service.roads.router import Answer, Array, Line, Location, NoWay, RouterRequest, Unintelligible

# "Locations are in unconnected regions", "no suitable edges near location", "path distance exceeds
# the maximum", and "no path could be found": each about some of the places, unnamed.
_NO_WAY = frozenset({170, 171, 154, 442})
_METRES = 1000.0  # of a kilometre, in which distances come
_PRECISION = 6  # decimals of a line


class _Error(BaseModel):
    error_code: int


class _Edge(BaseModel):
    correlated_lat: Latitude
    correlated_lon: Longitude


class _Located(BaseModel):
    # Older versions send null for a place far from every road.
    edges: Annotated[list[_Edge], Field(max_length=1000)] | None = None


class _LocatedList(BaseModel):
    located: list[_Located]


class _Tables(BaseModel):
    durations: Rows
    distances: Rows


class _Matrix(BaseModel):
    sources_to_targets: _Tables
    units: Literal["kilometers"]


class _Leg(BaseModel):
    shape: str


class _Trip(BaseModel):
    legs: list[_Leg]


class _Route(BaseModel):
    trip: _Trip


@dataclass(frozen=True)
class Valhalla:
    """Asks for ways by one costing model, between places within some metres of a road.

    Args:
        departure: When ways begin, as 2026-11-27T07:30 in the time of the place: tables then are of
            the historical traffic at that time.
        most_route_stops: The most places of a route.
    """

    costing: str
    snap: float
    departure: str | None = None
    most_route_stops: int = 20  # its default limit, of the costing models for cars

    def ask_snapped(self, places: Sequence[Location]) -> RouterRequest:
        """Return the question which roads are nearest to places."""
        return self._question("/locate", BYTES_OF_PLACE * len(places), {"locations": places})

    def read_snapped(self, answer: Answer, places: Sequence[Location]) -> Array:
        """Return the metres from each place to its road, shape (n,); infinity if it has none."""
        self._check(answer)
        located = read(_LocatedList, b'{"located":%b}' % answer.content).located
        if len(located) != len(places):
            raise Unintelligible(f"{len(places)} places must be located, got {len(located)}")
        return np.array(
            [_nearest(place, each.edges) for place, each in zip(places, located, strict=True)]
        )

    def ask_table(self, sources: Sequence[Location], targets: Sequence[Location]) -> RouterRequest:
        """Return the question for the times and distances from each source to each target."""
        size = BYTES_OF_PAIR * len(sources) * len(targets)
        members = {"sources": sources, "targets": targets}
        # Verbose, an answer has a hundred bytes more for each pair.
        options = {"verbose": False, **self._at_departure}
        return self._question("/sources_to_targets", size, members, **options)

    def read_table(self, answer: Answer, shape: tuple[int, int]) -> Array:
        """Return seconds and metres, shape (2, sources, targets), infinite where there is none."""
        self._check(answer)
        tables = read(_Matrix, answer.content).sources_to_targets
        costs = costs_of(tables.durations, tables.distances, shape)
        # As many decimals as it writes: 0.932 km are 932 m.
        costs[1] = (_METRES * costs[1]).round(3)
        return costs

    def ask_route(self, places: Sequence[Location]) -> RouterRequest:
        """Return the question for the way through places in this order."""
        members = {"locations": places}
        return self._question("/route", BYTES_OF_ROUTE, members, directions_type="none")

    def read_route(self, answer: Answer, legs: int) -> list[Line]:
        """Return the line of each leg of a route."""
        self._check(answer)
        trip = read(_Route, answer.content).trip
        if len(trip.legs) != legs:
            raise Unintelligible(f"a route must have {legs} legs, got {len(trip.legs)}")
        return [decode_polyline(leg.shape, _PRECISION) for leg in trip.legs]

    @property
    def _at_departure(self) -> dict[str, Any]:
        if self.departure is None:
            return {}
        # Its default, where times are given, is a search from each source alone: far slower.
        date_time = {"type": 1, "value": self.departure}
        return {"date_time": date_time, "prioritize_bidirectional": True}

    def _question(
        self, path: str, size: int, places: dict[str, Sequence[Location]], **options: Any
    ) -> RouterRequest:
        cutoff = math.ceil(self.snap)
        members = {
            name: [{"lon": lon, "lat": lat, "search_cutoff": cutoff} for lon, lat in each]
            for name, each in places.items()
        }
        body = {"costing": self.costing, "units": "kilometers", **options, **members}
        return RouterRequest(path, BYTES_OF_ANSWER + size, to_json(body))

    def _check(self, answer: Answer) -> None:
        if answer.status == 200:
            return
        code = read(_Error, answer.content).error_code
        if code in _NO_WAY:
            raise NoWay
        raise Unintelligible(f"it refuses the question by its error {code}")


def _nearest(place: Location, edges: list[_Edge] | None) -> float:
    """Return the metres from a place to the nearest of its edges."""
    if not edges:
        return math.inf
    ends = np.array([(edge.correlated_lon, edge.correlated_lat) for edge in edges])
    return float(great_circle_distances(np.array([place]), ends).min())
