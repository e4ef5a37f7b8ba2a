"""Read JSON: requests, GeoJSON, records with columns by name, and rows of cities."""

import json
import re
from collections.abc import Iterator
from math import isfinite
from typing import Any

from pydantic_core import from_json

from service.files.planners.others import refuse_others
from service.files.planners.vroom import is_vroom, read_vroom
from service.files.reading import Kind, Reading, Source, quoted
from service.files.stop_tables import reading_of
from service.files.tables import table_of
from service.files.texts import text_of

_STRUCTURE = ("type", "features", "bbox", "name", "crs", "metadata", "xy_coordinate_resolution")
_OBJECTS = {"stops", "vehicles", "robots", "shipments", "objectives", "cost_layers"}
_ROWS = {"coordinates", "grid", "cost_layer"}
_WINDOWS = ("window", "windows", "time_window", "time_windows")
_FIRST, _SECOND = r"\\u[dD][89abAB][0-9a-fA-F]{2}", r"\\u[dD][c-fC-F][0-9a-fA-F]{2}"
_HALF = re.compile(rf"{_FIRST}(?!{_SECOND})|(?<!{_FIRST}){_SECOND}")
_LONGEST_CRS = 200  # characters of its name
_NOT_A_NUMBER = re.compile(r"(?<=[\s,:\[])(NaN|-?Infinity)(?=[\s,\]}])")
_LARGE = re.compile(r"(?<=[\s,:\[])-?\d[\d.]{0,400}[eE]\+?\d{3,}(?=[\s,\]}])")
_DEGREES = re.compile(r"(OGC:.*CRS84$|EPSG:+4326$|CRS84$|WGS ?84)", re.IGNORECASE)


def looks_like_json(text: str) -> bool:
    """Return whether a text begins like a JSON object or array."""
    return text.lstrip()[:1] in ("{", "[")


def read_json(source: Source, text: str, wanted: Kind | None) -> Reading:
    """Return the request in a text of JSON, or the request that is made from it.

    Args:
        source: The file.
        text: Its content.
        wanted: The kind of a request that does not show its own kind; None refuses such a request.

    Raises:
        UnreadableFile: It is not JSON, or not of a known format.
    """
    value = _parsed(source, text)
    if isinstance(value, list):
        return _read_list(source, value)
    if not isinstance(value, dict):
        raise source.refusal("must be a request, an object, or its coordinates, a list")
    if value.get("type") in ("FeatureCollection", "Feature"):
        return _read_geojson(source, value)
    refuse_others(source, value)
    if is_vroom(value):
        return read_vroom(source, value)
    if value.get("type") == "Topology":
        raise source.refusal("must be GeoJSON, got TopoJSON: export it as GeoJSON")
    if {"info", "data"} <= value.keys():
        return source.reading("coverage", {"occupancy_grid": value})
    _check_lists(source, value)
    kind = _kind_of(value) or wanted
    if kind is None:
        names = ", ".join(map(quoted, list(value)[:5])) or "none"
        raise source.refusal(f"must be a request, GeoJSON or VROOM's, got members {names}")
    return source.reading(kind, value)


def read_object(source: Source) -> dict[str, Any]:
    """Return the JSON object in a file.

    Raises:
        UnreadableFile: The file does not hold a JSON object.
    """
    value = _parsed(source, text_of(source))
    if not isinstance(value, dict):
        raise source.refusal("must be a request, an object")
    return value


def _parsed(source: Source, text: str) -> Any:
    """Return a text of JSON as a value, under the rules of bodies of requests."""
    try:
        value = from_json(text, allow_inf_nan=False)
    except (ValueError, RecursionError) as error:
        _check_characters(source, text)
        came = _NOT_A_NUMBER.search(text)
        hint = f". {came[1]} is not JSON: write null where there is no way" if came else ""
        raise source.refusal(f"must be JSON: {str(error)[:200]}{hint}") from None
    for found in _LARGE.finditer(text):
        if not isfinite(float(found[0])):
            raise source.refusal("must have numbers that are finite", found[0])
    return value


def _check_characters(source: Source, text: str) -> None:
    """Raise UnreadableFile if a text that is no JSON has half of a character of UTF-16."""
    halves = _HALF.search(text)
    if halves:
        raise source.refusal(f"must be text, got {halves[0].lower()}, which is half a character")


def _kind_of(request: dict[str, Any]) -> Kind | None:
    if request.keys() & {"vehicles", "shipments"}:
        return "fleet"
    if request.keys() & {"grid", "occupancy_grid", "robots", "cost_layer", "cost_layers"}:
        return "coverage"
    return "front" if request.keys() & {"coordinates", "matrices", "stops"} else None


def _check_lists(source: Source, request: dict[str, Any]) -> None:
    """Raise UnreadableFile if a member that the page draws is not a list of objects or of rows."""
    for names, kind, what in ((_OBJECTS, dict, "objects"), (_ROWS, list, "rows")):
        for name in names & request.keys():
            items = request[name]
            if not isinstance(items, list) or not all(isinstance(each, kind) for each in items):
                raise source.refusal(f"{name} must be a list of {what}", items)
    layers = dict(_layers(source, request))
    for name, rows in layers.items():
        if not rows or not rows[0]:
            raise source.refusal(f"{name} must have a cell or more")
    for name, rows in layers.items():
        if "grid" in layers and len(rows) != len(layers["grid"]):
            raise source.refusal(f"{name} and grid must have as many rows")


def _layers(source: Source, request: dict[str, Any]) -> Iterator[tuple[str, list[Any]]]:
    """Yield the rows of the grid and of each layer of costs, with its name."""
    for name in ("grid", "cost_layer"):
        if name in request:
            yield name, request[name]
    for index, item in enumerate(request.get("cost_layers", ())):
        rows, name = item.get("layer"), f"cost_layers/{index}/layer"
        if not isinstance(rows, list) or not all(isinstance(row, list) for row in rows):
            raise source.refusal(f"{name} must be a list of rows", rows)
        yield name, rows


def _read_list(source: Source, value: list[Any]) -> Reading:
    """Return the request of rows of four numbers, or of records."""
    if value and all(isinstance(each, dict) for each in value):
        source.check_count("objects", source.bounds.cities, len(value))
        return reading_of(source, table_of(source, _records(value)))
    source.check_count("cities", source.bounds.cities, len(value))
    for each in value:
        if not isinstance(each, list):
            raise source.refusal(f"must be a list of rows, or of objects, got {quoted(each)[1:-1]}")
    return source.reading("front", {"coordinates": value})


def _records(records: list[dict[str, Any]]) -> Iterator[list[str]]:
    """Yield a heading, the names of all members of records; then the members of each record."""
    flat = [dict(_members(record)) for record in records]
    names = list(dict.fromkeys(name for record in flat for name in record))
    yield names
    for record in flat:
        yield [record.get(name, "") for name in names]


def _members(record: dict[str, Any], depth: int = 0) -> Iterator[tuple[str, str]]:
    """Yield the members of a record as text, also those of inner objects and coordinates."""
    for name, value in record.items():
        if isinstance(value, dict) and depth < 2:
            yield from _members(value, depth + 1)
        elif name in ("location", "coordinates") and _is_place(value):
            yield "longitude", str(value[0])
            yield "latitude", str(value[1])
        elif name in _WINDOWS and _is_place(value):
            yield name, f"{value[0]}-{value[1]}"
        elif name in _WINDOWS and isinstance(value, list) and all(map(_is_place, value)):
            yield name, "; ".join(f"{each[0]}-{each[1]}" for each in value)
        elif isinstance(value, list) and all(isinstance(each, str) for each in value):
            yield name, "; ".join(value)
        elif isinstance(value, list) and len(value) == 1:
            yield name, _text(value[0])
        else:
            yield name, _text(value)


def _is_place(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len(value) >= 2
        and all(isinstance(each, int | float) and not isinstance(each, bool) for each in value[:2])
    )


def _text(value: Any) -> str:
    if value is None:
        return ""
    return value if isinstance(value, str) else json.dumps(value)


def _read_geojson(source: Source, value: dict[str, Any]) -> Reading:
    """Return the request whose stops are the points; other members are those of the request."""
    _check_crs(source, value)
    features = [value] if value["type"] == "Feature" else value.get("features")
    if not isinstance(features, list):
        raise source.refusal("a FeatureCollection must have a list of features")
    source.check_count("features", source.bounds.cities, len(features))
    records = [each for at, feature in enumerate(features) for each in _points(source, feature, at)]
    if any(_id(each, _properties(each)) is None for each in features):
        source.note("ids", "Features without an id, or a property id or name, are numbered from 1.")
    if not records:
        raise source.refusal("a FeatureCollection must have a point for each stop, got none")
    structure = value.keys() if value["type"] == "Feature" else _STRUCTURE
    rest = {name: member for name, member in value.items() if name not in structure}
    _check_lists(source, rest)
    if "objectives" in rest and "vehicles" not in rest:
        stops = [{"id": each["id"], "location": each["location"]} for each in records]
        return source.reading("front", {**rest, "stops": stops})
    reading = reading_of(source, table_of(source, _records(records)))
    return source.reading(reading.kind, {**reading.request, **rest})


def _check_crs(source: Source, value: dict[str, Any]) -> None:
    """Raise UnreadableFile if places are not in degrees of WGS84."""
    match value.get("crs"):
        case None | {"properties": {"name": None}}:
            return
        case {"properties": {"name": str(name)}} if _DEGREES.search(name[:_LONGEST_CRS]):
            return
        case {"properties": {"name": name}}:
            came = quoted(name)
        case other:
            came = quoted(other)
    demand = "crs must be WGS 84 (EPSG:4326 or CRS84)"
    raise source.refusal(f"{demand}, got {came}: export it in EPSG:4326, as RFC 7946 demands")


def _points(source: Source, feature: Any, at: int) -> Iterator[dict[str, Any]]:
    """Yield a record for each point of a feature."""
    match feature:
        case {"geometry": {"type": "Point", "coordinates": [x, y, *_]}}:
            places = [(x, y)]
        case {"geometry": {"type": "MultiPoint", "coordinates": [*several]}} if several:
            places = [tuple(each[:2]) if isinstance(each, list) else () for each in several]
        case {"geometry": {"type": kind}}:
            raise source.refusal(f"features/{at} must be a Point", kind)
        case _:
            raise source.refusal(f"features/{at} must be a Point with a longitude and a latitude")
    named = _properties(feature)
    for number, place in enumerate(places, 1):
        if not _is_place(list(place)):
            raise source.refusal(f"features/{at} must have a place of numbers", place)
        name = _id(feature, named) or str(at + 1)
        kept = {k: v for k, v in named.items() if k != "id"}
        several_id = name if len(places) == 1 else f"{name}-{number}"
        yield {"id": several_id, "location": list(place), **kept}


def _id(feature: dict[str, Any], named: dict[str, Any]) -> str | None:
    for found in (feature.get("id"), named.get("id"), named.get("name")):
        if isinstance(found, str | int | float) and not isinstance(found, bool):
            return str(found)
    return None


def _properties(feature: dict[str, Any]) -> dict[str, Any]:
    properties = feature.get("properties")
    return properties if isinstance(properties, dict) else {}
