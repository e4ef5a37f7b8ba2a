"""Read JSON: requests, GeoJSON, records with columns by name, and rows of cities."""

import re
from math import isfinite
from typing import Any, cast

from pydantic_core import from_json

from service.files.json_files.geojson import read_geojson
from service.files.json_files.records import check_lists, rows_of
from service.files.planners.others import refuse_others
from service.files.planners.vroom import is_vroom, read_vroom
from service.files.reading import Kind, Reading, Request, Source, quoted
from service.files.stop_tables import reading_of
from service.files.tables import table_of
from service.files.texts import text_of

_FIRST, _SECOND = r"\\u[dD][89abAB][0-9a-fA-F]{2}", r"\\u[dD][c-fC-F][0-9a-fA-F]{2}"
_HALF = re.compile(rf"{_FIRST}(?!{_SECOND})|(?<!{_FIRST}){_SECOND}")
_NOT_A_NUMBER = re.compile(r"(?<=[\s,:\[])(NaN|-?Infinity)(?=[\s,\]}])")
_LARGE = re.compile(r"(?<=[\s,:\[])-?\d[\d.]{0,400}[eE]\+?\d{3,}(?=[\s,\]}])")


def looks_like_json(text: str) -> bool:
    """Return whether a text begins like a JSON object or array."""
    return text.lstrip()[:1] in ("{", "[")


def read_json(source: Source, text: str, wanted: Kind | None) -> Reading:
    """Return the request in a text of JSON, or the request that is made from it.

    Args:
        wanted: The kind of a request that does not show its own kind; None refuses such a request.

    Raises:
        UnreadableFile: It is not JSON, or not of a known format.
    """
    value = _parsed(source, text)
    if isinstance(value, list):
        return _read_list(source, value)
    if not isinstance(value, dict):
        raise source.refusal("no-object-or-list")
    if value.get("type") in ("FeatureCollection", "Feature"):
        return read_geojson(source, value)
    refuse_others(source, value)
    if is_vroom(value):
        return read_vroom(source, value)
    if value.get("type") == "Topology":
        topology = "TopoJSON: export it as GeoJSON"
        raise source.refusal("another-format", wanted="GeoJSON", given=topology)
    if {"info", "data"} <= value.keys():
        return source.reading("coverage", {"occupancy_grid": value})
    check_lists(source, value)
    kind = _kind_of(value) or wanted
    if kind is None:
        names = ", ".join(map(quoted, list(value)[:5])) or "none"
        raise source.refusal("unknown-json", given=names)
    return source.reading(kind, cast(Request, value))  # which is checked when it is parsed


def read_object(source: Source) -> dict[str, Any]:
    """Return the JSON object in a file.

    Raises:
        UnreadableFile: The file does not hold a JSON object.
    """
    value = _parsed(source, text_of(source))
    if not isinstance(value, dict):
        raise source.refusal("no-object")
    return value


def _parsed(source: Source, text: str) -> Any:
    """Return a text of JSON as a value, under the rules of bodies of requests."""
    try:
        value = from_json(text, allow_inf_nan=False)
    except (ValueError, RecursionError) as error:
        _check_characters(source, text)
        came = _NOT_A_NUMBER.search(text)
        code, given = ("nan-in-json", {"given": came[1]}) if came else ("not-json", {})
        raise source.refusal(code, reason=str(error)[:200], **given) from None
    for found in _LARGE.finditer(text):
        if not isfinite(float(found[0])):
            raise source.refusal("infinite-number", came=found[0])
    return value


def _check_characters(source: Source, text: str) -> None:
    """Raise UnreadableFile if a text that is not JSON has half of a character of UTF-16."""
    halves = _HALF.search(text)
    if halves:
        raise source.refusal("half-a-character", given=halves[0].lower())


def _kind_of(request: dict[str, Any]) -> Kind | None:
    if request.keys() & {"vehicles", "shipments"}:
        return "fleet"
    if request.keys() & {"grid", "occupancy_grid", "robots", "cost_layer", "cost_layers"}:
        return "coverage"
    return "front" if request.keys() & {"coordinates", "matrices", "stops"} else None


def _read_list(source: Source, value: list[Any]) -> Reading:
    """Return the request of rows of four numbers, or of records."""
    if value and all(isinstance(each, dict) for each in value):
        source.check_count("objects", source.bounds.cities, len(value))
        return reading_of(source, table_of(source, rows_of(value)))
    source.check_count("cities", source.bounds.cities, len(value))
    for each in value:
        if not isinstance(each, list):
            raise source.refusal("no-rows-or-objects", given=quoted(each)[1:-1])
    return source.reading("front", {"coordinates": value})
