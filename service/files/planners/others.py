"""Recognise the JSON of planners and routing engines that is not read, by its members."""

from collections.abc import Callable
from typing import Any, NamedTuple

from service.files.reading import Source

_TABLES = (
    "write its stops as a table with columns such as id, lat, lon, demand, from and to, and its"
    " vehicles as a second one with id, capacity and shift; or a request of POST /fleet"
)
_MATRICES = "write its matrices as objectives of a request of POST /front or /fleet"
_LOCATIONS = "write its places as a table with columns id, lat and lon"
_PROBLEM = "bring the problem that it is an answer to"


class _Other(NamedTuple):
    """A format: whose it is, how it is recognised, and what to do instead."""

    whose: str
    is_it: Callable[[dict[str, Any]], bool]
    instead: str


def _has(*members: str) -> Callable[[dict[str, Any]], bool]:
    return lambda value: value.keys() >= {*members}


def _within(member: str, *inner: str) -> Callable[[dict[str, Any]], bool]:
    """Return whether a member is an object, or a list that begins with one, with inner members."""

    def is_it(value: dict[str, Any]) -> bool:
        found = value.get(member)
        first = found[0] if isinstance(found, list) and found else found
        return isinstance(first, dict) and first.keys() >= {*inner}

    return is_it


def _is_routific(value: dict[str, Any]) -> bool:
    return isinstance(value.get("visits"), dict) and isinstance(value.get("fleet"), dict)


def _is_optimoroute(value: dict[str, Any]) -> bool:
    members = ("orderNo", "stopTimeWindows", "timeWindows", "acceptDuplicateOrderNo")
    return any(_within("orders", each)(value) for each in members)


def _is_of_places(value: dict[str, Any]) -> bool:
    """Return whether an object is about places, with what engines ask for beside them."""
    beside = {"costing", "metrics", "profile", "sources", "destinations", "range"}
    return bool(value.keys() & beside) and _are_places(value.get("locations"))


def _is_directions(value: dict[str, Any]) -> bool:
    """Return whether an object is a request for directions: rows of two degrees."""
    beside = {"elevation", "instructions", "preference", "geometry_simplify", "radiuses", "options"}
    rows = value.get("coordinates")
    pairs = isinstance(rows, list) and all(
        isinstance(each, list) and len(each) == 2 for each in rows
    )
    return bool(rows) and pairs and bool(value.keys() & beside)


def _are_places(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and isinstance(value[0], list | dict)


_OTHERS = (
    _Other("Timefold's", _has("modelInput"), _TABLES),
    _Other("Timefold's", _within("vehicles", "shifts", "homeLocation"), _TABLES),
    _Other("Timefold's", _has("southWestCorner", "northEastCorner"), _TABLES),
    _Other("Timefold's", lambda v: _has("vehicles", "visits")(v) and "stops" not in v, _TABLES),
    _Other("GraphHopper's", _has("vehicle_types"), _TABLES),
    _Other("GraphHopper's", _within("vehicles", "vehicle_id"), _TABLES),
    _Other("Routific's", _is_routific, _TABLES),
    _Other("Routific's", _has("routeScenario"), _TABLES),
    _Other("Google Route Optimization's", _within("model", "shipments"), _TABLES),
    _Other("Google Route Optimization's", _within("model", "vehicles"), _TABLES),
    _Other("OptimoRoute's", _is_optimoroute, _TABLES),
    _Other("HERE Tour Planning's", _has("plan", "fleet"), _TABLES),
    _Other("cuOpt's", _has("fleet_data", "task_data"), _TABLES),
    _Other("Geoapify's", _has("agents", "jobs"), _TABLES),
    _Other("Bing Maps'", _has("agents", "itineraryItems"), _TABLES),
    _Other("Mapbox's", _has("locations", "vehicles", "services"), _TABLES),
    _Other("NextBillion's", _has("locations", "vehicles", "jobs"), _TABLES),
    _Other("OR-Tools'", _has("distance_matrix", "num_vehicles"), _MATRICES),
    _Other("OR-Tools'", _has("time_matrix", "num_vehicles"), _MATRICES),
    _Other("a routing engine's matrix", _has("durations", "sources"), _MATRICES),
    _Other("a routing engine's matrix", _has("distances", "sources"), _MATRICES),
    _Other("a routing engine's request", _has("sources", "targets"), _LOCATIONS),
    _Other("a routing engine's request", _is_of_places, _LOCATIONS),
    _Other("Openrouteservice's directions", _is_directions, _LOCATIONS),
    _Other("VROOM's answer", _has("summary", "routes"), _PROBLEM),
    _Other("a routing engine's answer", _has("routes", "waypoints"), _LOCATIONS),
)


def refuse_others(source: Source, value: dict[str, Any]) -> None:
    """Raise UnreadableFile if an object is that of another planner, with what to do."""
    for other in _OTHERS:
        if other.is_it(value):
            raise source.refusal("another-planner", whose=other.whose, instead=other.instead)
