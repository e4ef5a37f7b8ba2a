"""OSRM's interface: /table and /route, version 1, by its HTTP API documentation."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal
from urllib.parse import quote

import numpy as np
from pydantic import BaseModel, Field

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

_NO_WAY = frozenset({"NoRoute", "NoTable", "NoSegment"})
_PRECISION = 6  # decimals of a line


class _Error(BaseModel):
    code: Annotated[str, Field(max_length=40, pattern=r"^\w+$")]


class _Waypoint(BaseModel):
    location: tuple[Longitude, Latitude]


class _Snapped(BaseModel):
    code: Literal["Ok"]
    sources: list[_Waypoint]


class _Table(BaseModel):
    code: Literal["Ok"]
    durations: Rows
    distances: Rows


class _Step(BaseModel):
    geometry: str


class _Leg(BaseModel):
    steps: list[_Step]


class _Trip(BaseModel):
    legs: list[_Leg]


class _Route(BaseModel):
    code: Literal["Ok"]
    routes: Annotated[list[_Trip], Field(min_length=1)]


@dataclass(frozen=True)
class Osrm:
    """Asks for ways by one profile."""

    profile: str
    most_route_stops: int = 50  # its default limit is 500, and a line to ask is some thousand long

    def ask_snapped(self, places: Sequence[Location]) -> RouterRequest:
        """Return the question which roads are nearest to places: a table of times to the first."""
        # Once more, since a table is of two places or more.
        everywhere = [*places, places[0]]
        options = f"annotations=duration&destinations=0&sources={_joined(range(len(places)))}"
        return self._question("table", everywhere, options, BYTES_OF_PLACE * len(everywhere))

    def read_snapped(self, answer: Answer, places: Sequence[Location]) -> Array:
        """Return the metres from each place to its road, shape (n,)."""
        _check(answer)
        snapped = [each.location for each in read(_Snapped, answer.content).sources]
        if len(snapped) != len(places):
            raise Unintelligible(f"{len(places)} sources must come back, got {len(snapped)}")
        return great_circle_distances(np.array(places), np.array(snapped))

    def ask_table(self, sources: Sequence[Location], targets: Sequence[Location]) -> RouterRequest:
        """Return the question for the times and distances from each source to each target."""
        places = [*sources, *targets]
        rows, columns = range(len(sources)), range(len(sources), len(places))
        options = (
            f"annotations=duration,distance&sources={_joined(rows)}&destinations={_joined(columns)}"
        )
        size = BYTES_OF_PAIR * len(sources) * len(targets) + BYTES_OF_PLACE * len(places)
        return self._question("table", places, options, size)

    def read_table(self, answer: Answer, shape: tuple[int, int]) -> Array:
        """Return seconds and metres, shape (2, sources, targets), infinite where there is none."""
        _check(answer)
        table = read(_Table, answer.content)
        return costs_of(table.durations, table.distances, shape)

    def ask_route(self, places: Sequence[Location]) -> RouterRequest:
        """Return the question for the way through places in this order."""
        options = "overview=false&steps=true&geometries=polyline6"
        return self._question("route", places, options, BYTES_OF_ROUTE)

    def read_route(self, answer: Answer, legs: int) -> list[Line]:
        """Return the line of each leg of a route."""
        _check(answer)
        trip = read(_Route, answer.content).routes[0]
        if len(trip.legs) != legs:
            raise Unintelligible(f"a route must have {legs} legs, got {len(trip.legs)}")
        return [_line(leg) for leg in trip.legs]

    def _question(
        self, service: str, places: Sequence[Location], options: str, size: int
    ) -> RouterRequest:
        coordinates = ";".join(f"{lon:.6f},{lat:.6f}" for lon, lat in places)
        profile = quote(self.profile, safe="")
        path = f"/{service}/v1/{profile}/{coordinates}?generate_hints=false&{options}"
        return RouterRequest(path, BYTES_OF_ANSWER + size)


def _check(answer: Answer) -> None:
    if answer.status == 200:
        return
    code = read(_Error, answer.content).code
    if code in _NO_WAY:
        raise NoWay
    raise Unintelligible(f"it refuses the question as {code}")


def _line(leg: _Leg) -> Line:
    """Return the line of a leg: the lines of its steps, one after another."""
    lines = [decode_polyline(step.geometry, _PRECISION) for step in leg.steps]
    return np.concatenate(lines) if lines else np.empty((0, 2))


def _joined(indices: range) -> str:
    return ";".join(map(str, indices))
