"""Read a FeatureCollection of points (GeoJSON, RFC 7946) as the stops of a request."""

from typing import Any

from service.cli.errors import UnreadableFile
from service.cli.inputs.csv_tables import Ids

_STRUCTURE = ("type", "features", "bbox")  # members of every collection; others are the request's


def is_collection(value: dict[str, Any]) -> bool:
    """Return whether a JSON object is a FeatureCollection."""
    return value.get("type") == "FeatureCollection"


def read_stops(collection: dict[str, Any]) -> tuple[dict[str, Any], Ids]:
    """Return the request whose stops are the points of a collection, and the ids of the stops.

    A feature's id is that of its stop; without one, its property `id` or `name`. Members that
    GeoJSON does not know, `objectives` among them, are members of the request.

    Raises:
        UnreadableFile: A feature is no point or has no id, or there are no objectives.
    """
    features = collection.get("features")
    if not isinstance(features, list):
        raise UnreadableFile("a FeatureCollection must have a list of features")
    if "objectives" not in collection:
        raise UnreadableFile("a FeatureCollection of stops must have a member objectives beside it")
    stops = [_stop(feature, number) for number, feature in enumerate(features)]
    rest = {name: value for name, value in collection.items() if name not in _STRUCTURE}
    return {**rest, "stops": stops}, tuple(stop["id"] for stop in stops)


def _stop(feature: Any, number: int) -> dict[str, Any]:
    match feature:
        case {"geometry": {"type": "Point", "coordinates": [x, y, *_]}}:
            return {"id": _id(feature, number), "location": [x, y]}
    raise UnreadableFile(f"features/{number} must be a Point with a longitude and a latitude")


def _id(feature: dict[str, Any], number: int) -> str:
    properties = feature.get("properties") or {}
    named = properties if isinstance(properties, dict) else {}
    for found in (feature.get("id"), named.get("id"), named.get("name")):
        if isinstance(found, str | int | float) and not isinstance(found, bool):
            return str(found)
    raise UnreadableFile(f"features/{number} must have an id, or a property id or name")
