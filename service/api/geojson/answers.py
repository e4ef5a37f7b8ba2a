"""Answers of fronts and tours: in JSON, or in GeoJSON or text where the request accepts that.

Lines of tours are straight from stop to stop, or follow the streets as a routing engine knows them.
"""

import asyncio
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from paretour.text_sets import label, text_set, unnamed
from pydantic_core import to_json
from starlette.requests import Request
from starlette.responses import Response

from service.api.auth import client_of
from service.api.body_budget import BodyBudget
from service.api.disconnect import unless_disconnected
from service.api.geojson.features import Drawing
from service.api.request_headers import GEOJSON, TEXT, accepts_geojson, prefers_text
from service.api.responses import compressed, json_bytes, record_under, root_path_of
from service.errors import Fault, Refusal
from service.jobs.record import Record
from service.kinds.table import KINDS
from service.objectives import OBJECTIVES
from service.requests.fields import Geometry
from service.roads.client import RoadClient

VARY = {"Vary": "Accept"}
# For the OpenAPI document.
_EXAMPLE = {
    "type": "FeatureCollection",
    "features": [
        {
            "type": "Feature",
            "geometry": {"type": "LineString", "coordinates": [[24.94, 60.17], [24.95, 60.18]]},
            "properties": {"names": ["distance", "risk"], "lengths": [1241.6, 3.0]},
        }
    ],
}
CONTENT: dict[str, Any] = {
    "content": {
        GEOJSON: {
            "schema": {
                "title": "FeatureCollection",
                "description": "a line for each tour or route, a point for each stop (RFC 7946)",
                "type": "object",
                "required": ["type", "features"],
                "properties": {
                    "type": {"const": "FeatureCollection"},
                    "features": {"type": "array", "items": {"type": "object"}},
                },
            },
            "example": _EXAMPLE,
        }
    }
}
TEXT_CONTENT: dict[str, Any] = {
    "content": {
        TEXT: {
            "schema": {
                "description": "the lengths of each tour or plan in a line, as a set of points that"
                " moocore reads",
                "type": "string",
            }
        }
    }
}
FRONT_CONTENT = {"content": {**CONTENT["content"], **TEXT_CONTENT["content"]}}
Stops = Sequence[dict[str, Any]]


class FrontAnswers:
    """Answers requests with fronts and tours.

    Args:
        streets: The routing engine, whose streets lines may follow; None where there is none.
        budget: The bytes of all answers that are being made and sent.
    """

    def __init__(self, streets: RoadClient | None, budget: BodyBudget) -> None:
        self._streets = streets
        self._budget = budget

    def check(self, request: Request, stops: Stops | None, geometry: Geometry) -> None:
        """Raise a refusal where a request accepts GeoJSON that cannot be made.

        Raises:
            Refusal: A stop lacks an id or a location; or the lines are to follow streets, but the
                answer is not GeoJSON or no routing engine is set.
        """
        if geometry == "roads":
            self._check_roads(request)
        if accepts_geojson(request):
            _check_located(stops)

    async def front(
        self,
        request: Request,
        record: Record,
        geometry: Geometry,
        seconds: float = math.inf,
        plan: int | None = None,
    ) -> Response:
        """Return a front as GeoJSON or text where the request accepts that, else as JSON.

        A front that was planned for this request is sent even where the budget has no room.

        Args:
            geometry: What the lines follow.
            seconds: The time that is left for this.
            plan: The number of the one plan to draw; None draws all that the front holds.

        Raises:
            Refusal: As `check` and RoadClient.lines do; or the plan does not exist, or too many
                answers are being sent.
        """
        self.check(request, record.front.stops, geometry)
        record = record_under(root_path_of(request.scope), record)
        if plan is not None:
            _check_plan(request, record, plan)
        items = record.front.tours if plan is None else record.front.tour(plan)
        alone = request.method == "POST" and "idempotency-key" not in request.headers
        with self._budget.open(client_of(request), len(items), always=alone) as allowance:
            if accepts_geojson(request):
                drawing = await asyncio.to_thread(Drawing.of, record, b"[%b]" % items, plan or 0)
                response = await self._drawn(request, drawing, geometry, seconds)
            elif prefers_text(request):
                text = points_text(record.front.objectives or (), record.front.lengths.tolist())
                response = Response(text, media_type=TEXT, headers=VARY)
                response = await compressed(request, response)
            else:
                response = await compressed(request, json_bytes(record.json()))
            return allowance.until_sent(response)

    async def tour(
        self, request: Request, record: Record, index: int, geometry: Geometry
    ) -> Response:
        """Return one tour of a front, in the same way."""
        self.check(request, record.front.stops, geometry)
        tour = record.front.tour(index)
        if not accepts_geojson(request):
            answer = json_bytes(b'{"front":' + to_json(record.id) + b"," + tour[1:])
            return await compressed(request, answer)
        drawing = await asyncio.to_thread(Drawing.of, record, b"[" + tour + b"]")
        return await self._drawn(request, drawing, geometry, math.inf)

    async def close(self) -> None:
        """Close the connections to the routing engine."""
        if self._streets is not None:
            await self._streets.close()

    def _check_roads(self, request: Request) -> None:
        if not accepts_geojson(request):
            fault = _fault(request, "roads-need-geojson", accept=GEOJSON)
            raise Refusal("invalid-request", errors=[fault])
        if self._streets is None:
            refusal = Refusal("no-router", name="geometry", measure="roads")
            refusal.errors = (_fault(request, "no-router", said=refusal.detail),)
            raise refusal

    async def _drawn(
        self, request: Request, drawing: Drawing, geometry: Geometry, seconds: float
    ) -> Response:
        if geometry == "roads" and drawing.tours:
            assert self._streets is not None
            ways = [np.array(way, dtype=np.int64) for way in drawing.ways]
            places = drawing.locations, drawing.ids
            asked = self._streets.lines(*places, ways, seconds, drawing.profiles)
            lines = await unless_disconnected(request, asked)
        else:
            lines = drawing.straight_lines
        collection = await asyncio.to_thread(drawing.encode, lines)
        response = Response(collection, media_type=GEOJSON, headers=VARY)
        return await compressed(request, response)


def points_text(objectives: Sequence[Mapping[str, Any]], lengths: Sequence[Sequence[float]]) -> str:
    """Return the lengths of all tours or plans, as text that moocore reads.

    Args:
        objectives: The name and unit of each objective; none where the request named none.
    """
    labels = [label(each["name"], each.get("unit")) for each in objectives]
    return text_set(labels or unnamed(len(lengths[0]) if len(lengths) else OBJECTIVES), lengths)


def _fault(request: Request, code: str, said: str = "", **values: str) -> Fault:
    """Return what is wrong with the geometry, which is in the body or in the query."""
    if request.method == "POST":
        return Fault(code, pointer="/geometry", values=values, said=said)
    return Fault(code, parameter="geometry", values=values, said=said)


def _check_plan(request: Request, record: Record, plan: int) -> None:
    """Raise a refusal unless the front has a plan of this number, if one is asked for."""
    plans = len(record.front.lengths)
    if not accepts_geojson(request):
        fault = _of_plan("needs-geojson", accept=GEOJSON)
    elif not KINDS[record.front.kind].mover:
        fault = _of_plan("plan-of-tours", front=record.id)
    elif plan >= plans:
        fault = _of_plan("no-such-plan", plans=plans, came=plan)
    else:
        return
    raise Refusal("invalid-request", errors=[fault])


def _of_plan(code: str, **values: float | str) -> Fault:
    return Fault(code, "plan", parameter="plan", values=values)


def _check_located(stops: Stops | None) -> None:
    """Raise a refusal unless there are stops, and all have locations."""
    if stops is None:
        raise Refusal("no-locations", came="a front of cities without stops")
    without = [stop["id"] for stop in stops if stop["location"] is None]
    if without:
        more = f" and {len(without) - 1} more" if len(without) > 1 else ""
        raise Refusal("no-locations", came=f"none of stop {without[0]!r}{more}")
