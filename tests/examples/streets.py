"""The streets of central Helsinki, and the ways along them between stops, which the page draws.

Lines are those of a Valhalla whose tiles are built of OpenStreetMap's data, (c) OpenStreetMap
contributors, under the Open Database License (ODbL).
"""

from collections.abc import Iterable, Iterator, Mapping
from itertools import islice, pairwise
from typing import Any

import httpx
import numpy as np
from numpy.typing import NDArray

from service.roads.polyline import decode_polyline
from service.roads.router import Array, Line
from service.roads.streets import Leg

Place = tuple[int, int]  # steps east and north of the origin
Way = list[int]  # nodes; the first and the last are stops
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


def lines_of(drawn: Mapping[str, Any], kind: str) -> list[Array]:
    """Return the lines of a kind in what `streets` returns, each of longitude and latitude."""
    return [
        np.cumsum(np.reshape(row, (-1, 2)), axis=0) * drawn["step"] + drawn["origin"]
        for row in drawn[kind]
    ]


def _edges(router_url: str) -> Iterator[tuple[str | None, NDArray[np.int64]]]:
    """Return the kind and the line, in steps, of every edge of the road network, each once."""
    grid = _grid()
    found: set[tuple[str | None, str]] = set()
    while places := list(islice(grid, _AT_ONCE)):
        body = {"costing": "pedestrian", "verbose": True, "locations": places}
        answer = httpx.post(f"{router_url}/locate", json=body, timeout=120)
        for located in answer.raise_for_status().json():
            for edge in located["edges"] or []:
                found.add((_kind(edge["edge"]["classification"]), edge["edge_info"]["shape"]))
    return ((kind, _line(shape)) for kind, shape in found)


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


def legs(places: Array, lines: Mapping[Leg, Line]) -> dict[str, Any]:
    """Return the ways between all stops, at places of shape (n, 2), from the lines of all legs.

    Members: `nodes`, places in steps from the origin, those of the stops first; `next`, for each
    node those to which ways lead from it; `legs`, for each stop the ways to all of them, each as
    digits: at a node that leads to several, the next digit says to which.
    """
    nodes, ways = _ways(lines, _steps(places))
    ahead = _ahead(ways.values(), len(nodes))
    stops = range(len(places))
    pairs = [[ways.get((i, j), []) for j in stops] for i in stops]
    return {
        "credit": CREDIT,
        "origin": list(ORIGIN),
        "step": STEP,
        "nodes": [list(place) for place in nodes],
        "next": ahead,
        "legs": [[_digits(way, ahead) for way in row] for row in pairs],
    }


def _steps(places: Array) -> list[Place]:
    """Return places of longitude and latitude, shape (m, 2), in steps from the origin."""
    return [(x, y) for x, y in ((places - ORIGIN) / STEP).round().astype(int).tolist()]


def _ways(lines: Mapping[Leg, Line], stops: list[Place]) -> tuple[list[Place], dict[Leg, Way]]:
    """Return the places of all nodes, and the nodes of each way, from its stop to the other."""
    numbers: dict[Place, int] = {}

    def number(place: Place) -> int:
        return len(stops) + numbers.setdefault(place, len(numbers))

    ways = {}
    for (i, j), line in sorted(lines.items(), key=lambda item: item[0]):
        along = [number(place) for place in _steps(line)]
        moves = [node for node, after in pairwise([*along, j]) if node != after]
        ways[i, j] = [i, *moves, j]
    return [*stops, *numbers], ways


def _ahead(ways: Iterable[Way], nodes: int) -> list[list[int]]:
    """Return the nodes to which ways lead from each node."""
    found: list[set[int]] = [set() for _ in range(nodes)]
    for way in ways:
        for node, after in pairwise(way):
            found[node].add(after)
    return [sorted(each) for each in found]


def _digits(way: Way, ahead: list[list[int]]) -> str:
    """Return which way is taken at each node that leads to several."""
    choices = [ahead[node].index(after) for node, after in pairwise(way) if len(ahead[node]) > 1]
    return "".join(map(str, choices))
