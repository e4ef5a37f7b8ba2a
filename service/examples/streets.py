"""The streets of central Helsinki, which the page draws under the tours of the examples there.

Lines are those of a Valhalla whose tiles are built of OpenStreetMap's data, (c) OpenStreetMap
contributors, under the Open Database License (ODbL).
"""

from collections.abc import Iterator
from itertools import islice
from typing import Any

import httpx
import numpy as np
from numpy.typing import NDArray

from service.roads.polyline import decode_polyline

CREDIT = "Streets © OpenStreetMap contributors (ODbL)"
STEP = 1e-5  # degrees: half a metre to the east, one to the north
KINDS = ("main", "side", "path")
ORIGIN, _NORTH_EAST = (24.934, 60.162), (24.956, 60.180)  # all that the extract holds
_SPACING = (0.0011, 0.00055)  # degrees between places that are asked about: 60 metres either way
_REACH = 60  # metres around each
_AT_ONCE = 200  # places in a question
_MAIN = {"motorway", "trunk", "primary", "secondary", "tertiary"}
_SIDE = {"road", "service_road", "living_street"}
_PATH = {"footway", "pedestrian", "path", "cycleway", "steps"}


def streets(router_url: str) -> dict[str, Any]:
    """Return the streets that the Valhalla at this address knows, by kind.

    Each line is a row of whole steps: longitude and latitude from the origin, then from the place
    before.
    """
    lines: dict[str, set[tuple[int, ...]]] = {kind: set() for kind in KINDS}
    for kind, line in _edges(router_url):
        if kind and len(line) > 1:
            lines[kind].add(min(_row(line), _row(line[::-1])))  # both ways along it are one line
    drawn = {kind: sorted(map(list, rows)) for kind, rows in lines.items()}
    return {"credit": CREDIT, "origin": list(ORIGIN), "step": STEP, **drawn}


def _edges(router_url: str) -> Iterator[tuple[str | None, NDArray[np.int64]]]:
    """Return the kind and the line, in steps, of every edge of the road network."""
    grid = _grid()
    while places := list(islice(grid, _AT_ONCE)):
        body = {"costing": "pedestrian", "verbose": True, "locations": places}
        answer = httpx.post(f"{router_url}/locate", json=body, timeout=120)
        for located in answer.raise_for_status().json():
            for edge in located["edges"] or []:
                yield _kind(edge["edge"]["classification"]), _line(edge["edge_info"]["shape"])


def _grid() -> Iterator[dict[str, float]]:
    for lon in np.arange(ORIGIN[0], _NORTH_EAST[0], _SPACING[0]).tolist():
        for lat in np.arange(ORIGIN[1], _NORTH_EAST[1], _SPACING[1]).tolist():
            yield {"lon": lon, "lat": lat, "radius": _REACH}


def _kind(classification: dict[str, str]) -> str | None:
    """Return the kind of an edge; None of crossings, pavements and car parks."""
    if classification["classification"] in _MAIN:
        return "main"
    if classification["use"] in _SIDE:
        return "side"
    return "path" if classification["use"] in _PATH else None


def _line(shape: str) -> NDArray[np.int64]:
    """Return the places of a line in steps from the origin, none of them twice in a row."""
    places = ((decode_polyline(shape, 6) - ORIGIN) / STEP).round().astype(np.int64)
    moved = np.append(True, (np.diff(places, axis=0) != 0).any(axis=1))
    return places[moved]


def _row(line: NDArray[np.int64]) -> tuple[int, ...]:
    return tuple(np.diff(line, axis=0, prepend=0).ravel().tolist())
