"""Fronts and tours as GeoJSON (RFC 7946): a line for each tour, a point for each stop.

Requests that accept `application/geo+json` rather than JSON are answered with it, if the stops of
the front have locations. The geometry of a tour is made in `_line` alone.
"""

import asyncio
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

from pydantic_core import from_json, to_json
from starlette.requests import Request
from starlette.responses import Response

from service.api.responses import json_bytes
from service.errors import Refusal
from service.jobs.record import Record

GEOJSON = "application/geo+json"
VARY = {"Vary": "Accept"}
# For the OpenAPI document.
CONTENT: dict[str, Any] = {
    "content": {
        GEOJSON: {
            "schema": {
                "title": "FeatureCollection",
                "description": "a line for each tour, then a point for each stop (RFC 7946)",
                "type": "object",
                "required": ["type", "features"],
                "properties": {
                    "type": {"const": "FeatureCollection"},
                    "features": {"type": "array", "items": {"type": "object"}},
                },
            }
        }
    }
}
_HALF_WAY_ROUND = 180.0  # degrees of longitude
Position = Sequence[float]  # longitude and latitude in degrees
Stops = Sequence[dict[str, Any]]


def accepts_geojson(request: Request) -> bool:
    """Return whether the caller accepts GeoJSON, and no less than JSON."""
    ranges = dict(_media_ranges(",".join(request.headers.getlist("accept"))))
    quality = ranges.get(GEOJSON, 0.0)
    return quality > 0 and quality >= ranges.get("application/json", 0.0)


def check_acceptable(request: Request, stops: Stops | None) -> None:
    """Raise a refusal where a request accepts GeoJSON, and its stops cannot be drawn.

    Raises:
        Refusal: There are no stops with ids, or some have no location.
    """
    if not accepts_geojson(request):
        return
    if stops is None:
        raise Refusal("no-locations", came="a front of cities without stops")
    without = [stop["id"] for stop in stops if stop["location"] is None]
    if without:
        more = f" and {len(without) - 1} more" if len(without) > 1 else ""
        raise Refusal("no-locations", came=f"none of stop {without[0]!r}{more}")


async def front_response(request: Request, record: Record) -> Response:
    """Return a front as GeoJSON where the request accepts that, else as JSON.

    Raises:
        Refusal: Its stops have no locations.
    """
    check_acceptable(request, record.front.stops)
    if not accepts_geojson(request):
        return json_bytes(record.json())
    tours = b"[" + record.front.tours + b"]"
    return _geojson(await asyncio.to_thread(_collection, record, tours))


async def tour_response(request: Request, record: Record, index: int) -> Response:
    """Return one tour of a front, in the same way."""
    check_acceptable(request, record.front.stops)
    tour = record.front.tour(index)
    if not accepts_geojson(request):
        return json_bytes(b'{"front":' + to_json(record.id) + b"," + tour[1:])
    return _geojson(await asyncio.to_thread(_collection, record, b"[" + tour + b"]"))


def _geojson(collection: bytes) -> Response:
    return Response(collection, media_type=GEOJSON, headers=VARY)


def _collection(record: Record, tours: bytes) -> bytes:
    """Return these tours of a front, a JSON array, and its stops as a FeatureCollection.

    The front's id and status, and the problem of a failed one, are members of its own.
    """
    members = record.front.members()
    named = members["objectives"]
    common = {
        "front": record.id,
        "names": [objective["name"] for objective in named],
        "units": [objective["unit"] for objective in named],
    }
    # Fronts have this member where tours are open routes alone.
    closed = members.get("closed", True)
    lines = [_line(tour, common, members["stops"], closed) for tour in from_json(tours)]
    points = [_point(stop) for stop in members["stops"]]
    foreign: dict[str, Any] = {"id": record.id, "status": record.status}
    if record.problem is not None:
        foreign["problem"] = record.problem
    return to_json({"type": "FeatureCollection", **foreign, "features": lines + points})


def _line(
    tour: dict[str, Any], common: dict[str, Any], stops: Stops, closed: bool
) -> dict[str, Any]:
    """Return a tour as a feature: the straight way from stop to stop."""
    cities = [*tour["tour"], tour["tour"][0]] if closed or len(stops) == 1 else tour["tour"]
    properties = {name: value for name, value in tour.items() if name != "tour"}
    geometry = straight_line([stops[city]["location"] for city in cities])
    return {"type": "Feature", "geometry": geometry, "properties": {**common, **properties}}


def _point(stop: dict[str, Any]) -> dict[str, Any]:
    geometry = {"type": "Point", "coordinates": stop["location"]}
    properties = {"stop": stop["id"]}
    return {"type": "Feature", "id": stop["id"], "geometry": geometry, "properties": properties}


def straight_line(way: Sequence[Position]) -> dict[str, Any]:
    """Return the line through two or more positions, cut in two where it crosses longitude 180.

    A step takes the shorter way round the earth (RFC 7946, section 3.1.9).
    """
    lines: list[list[Position]] = [[way[0]]]
    for (from_x, from_y), (x, y) in pairwise(way):
        if abs(x - from_x) > _HALF_WAY_ROUND:
            edge = _HALF_WAY_ROUND if from_x > x else -_HALF_WAY_ROUND
            rest = x + 2 * edge - from_x
            crossing = from_y + (y - from_y) * ((edge - from_x) / rest if rest else 0.0)
            lines[-1].append((edge, crossing))
            lines.append([(-edge, crossing)])
        lines[-1].append((x, y))
    if len(lines) == 1:
        return {"type": "LineString", "coordinates": lines[0]}
    return {"type": "MultiLineString", "coordinates": lines}


def _media_ranges(accept: str) -> Iterator[tuple[str, float]]:
    """Yield the media types of an Accept header with their quality (RFC 9110, section 12.5.1)."""
    for each in accept.split(","):
        media, *parameters = (part.strip().lower() for part in each.split(";"))
        quality = next((each[2:] for each in parameters if each.startswith("q=")), "1")
        yield media, _number(quality)


def _number(text: str) -> float:
    """Return a quality, 0 where it is none."""
    try:
        return float(text)
    except ValueError:
        return 0.0
