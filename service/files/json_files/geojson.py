"""Read GeoJSON (RFC 7946): the points of features are stops, and their properties are columns."""

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from typing import Any, NamedTuple, cast

from service.files.cells.times import read_calendar
from service.files.chosen import IGNORED
from service.files.column_names import FLEET, field_of_each
from service.files.columns import Columns, columns_of, place_in
from service.files.depots import for_stops
from service.files.fleets import Stop, Vehicle, fleet_of_tables, have_times
from service.files.groups import groups_of, have_waits
from service.files.json_files.records import check_lists, is_place, members_of
from service.files.reading import Reading, Request, Source, quoted
from service.files.stop_tables import reading_of_columns, visits_of
from service.files.tables import MOST_COLUMNS, ColumnLeftOut, Table, number_in, table_of
from service.files.visits import add_visits

_STRUCTURE = ("type", "features", "bbox", "name", "crs", "metadata", "xy_coordinate_resolution")
_LONGEST_CRS = 200  # characters of its name
_DEGREES = re.compile(r"(OGC:.*CRS84$|EPSG:+4326$|CRS84$|WGS ?84)", re.IGNORECASE)
_GEOMETRY = ("id", "longitude", "latitude")  # the columns that are not properties
_CLOSE = 0.001  # degrees: about 100 m
_UNITS_OF_TIME = ("s", "sec", "seconds", "min", "minutes", "h", "hours")
_TIMED = re.compile(r"time|duration|dauer|zeit", re.IGNORECASE)
_OF_OBJECTIVES = ("cost", "x", "y")  # columns that are not objectives beside `objectives`


class _Record(NamedTuple):
    """The id and the place of a stop, and its properties as texts."""

    id: str
    place: tuple[float, float]
    properties: Mapping[str, str]


def read_geojson(source: Source, value: dict[str, Any]) -> Reading:
    """Return the request whose stops are the points; other members are those of the request."""
    _check_crs(source, value)
    features = [value] if value["type"] == "Feature" else value.get("features")
    if not isinstance(features, list):
        raise source.refusal("no-features", "a FeatureCollection")
    source.check_count("features", source.bounds.cities, len(features))
    records = [each for at, feature in enumerate(features) for each in _points(source, feature, at)]
    if any(_id(each, _properties(each)) is None for each in features):
        source.note("ids", "Features without an id, or a property id or name, are numbered from 1.")
    if not records:
        raise source.refusal("no-points", "a FeatureCollection")
    structure = value.keys() if value["type"] == "Feature" else _STRUCTURE
    rest = {name: member for name, member in value.items() if name not in structure}
    check_lists(source, rest)
    columns = columns_of(source, _table(source, records))
    if rest.keys() & {"vehicles", "shipments"} or any(each in FLEET for each in columns.fields):
        return source.reading("fleet", _with_given(_fleet(columns, rest), rest))
    if "objectives" in rest:
        return source.reading("front", _with_given(rest, {"stops": _stops(columns)}))
    reading = reading_of_columns(columns)
    return source.reading(reading.kind, _with_given(reading.request, rest))


def _with_given(made: Mapping[str, Any], given: Mapping[str, Any]) -> Request:
    """Return a request with members that the file gives, which are checked when it is parsed."""
    return cast(Request, {**made, **given})


def _stops(columns: Columns) -> list[Stop]:
    """Return stops with their places alone, beside objectives that are given."""
    for at, each in enumerate(columns.fields):
        columns.fields[at] = None if each in _OF_OBJECTIVES else each
    stops, _ = visits_of(columns)
    columns.report()
    return stops


def _fleet(columns: Columns, rest: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the request of a fleet, with the vehicles and objectives that are given."""
    stops, _ = visits_of(columns)
    read_calendar([columns])
    add_visits(columns, stops)
    groups = groups_of(columns, stops)
    waits = have_waits(groups)
    vehicles: list[Vehicle] = rest.get("vehicles", [])
    if "vehicles" not in rest:
        stops, vehicles = for_stops(columns, stops, None)
    columns.report()
    if "objectives" not in rest:
        tables = fleet_of_tables(columns.source, stops, vehicles, None, waits=waits)
        return {**tables, **groups}
    request: dict[str, Any] = {"stops": stops, "vehicles": vehicles, **groups}
    if (waits or have_times(stops, vehicles)) and "clock" not in rest:
        request["clock"] = _clock(columns, rest["objectives"])
    return request


def _clock(columns: Columns, objectives: Sequence[Mapping[str, Any]]) -> str:
    """Return the name of the one objective that is time."""
    timed = [
        str(each.get("name"))
        for each in objectives
        if str(each.get("from", "")).endswith("time")
        or each.get("unit") in _UNITS_OF_TIME
        or "speed" in each
        or _TIMED.search(str(each.get("name", ""))[:_LONGEST_CRS])
    ]
    if len(timed) != 1:
        raise columns.source.refusal("no-member-clock")
    return timed[0]


def _table(source: Source, records: Sequence[_Record]) -> Table:
    """Return the table of records. Properties that say where a stop is are left out of it."""
    names = list(dict.fromkeys(name for record in records for name in record.properties))
    source.check_count("properties", MOST_COLUMNS, len(names))
    aside = _placed(records, names)
    _note_differences(source, records, aside)
    kept = [name for name in names if name not in aside]
    rows = (
        [record.id, *map(str, record.place), *(record.properties.get(name, "") for name in kept)]
        for record in records
    )
    table = table_of(source, chain([[*_GEOMETRY, *kept]], rows))
    left_out = {
        len(_GEOMETRY) + len(kept) + at: ColumnLeftOut(
            f"{name} (property)" if name in _GEOMETRY else name,
            IGNORED,
            [record.properties.get(name, "") for record in records],
        )
        for at, name in enumerate(aside)
    }
    return Table(table.heading, table.rows, left_out)


def _placed(records: Sequence[_Record], names: Sequence[str]) -> list[str]:
    """Return the properties that say where a stop is, as its geometry does; or have its names."""
    fields = dict(zip(names, field_of_each(names), strict=True))
    placed = [
        name
        for name in names
        if fields[name] in ("longitude", "latitude", "place") or name in _GEOMETRY
    ]
    plane = [name for name in names if fields[name] in ("x", "y")]
    near = plane and all(_off(records, name, fields[name]) < _CLOSE for name in plane)
    return [*placed, *plane] if near else placed


def _note_differences(source: Source, records: Sequence[_Record], names: Sequence[str]) -> None:
    """Note properties that say that stops are elsewhere than the geometry says."""
    fields = zip(names, field_of_each(names), strict=True)
    off = {name: _off(records, name, field) for name, field in fields}
    differ = {name: most for name, most in off.items() if most > _CLOSE}
    if differ:
        named = " and ".join(map(quoted, differ))
        lies = "lies" if len(differ) == 1 else "lie"
        source.note(
            "place",
            f"{named} of the properties {lies} up to {max(differ.values()):.3g} degrees from the"
            " geometry, which counts (RFC 7946).",
        )


def _off(records: Sequence[_Record], name: str, field: str | None) -> float:
    """Return by how many degrees a property differs from the geometry, at most."""
    most = 0.0
    for record in records:
        text = record.properties.get(name, "")
        if field == "place":
            place = place_in(text)
            pairs = list(zip(place, record.place, strict=True)) if place else []
        else:
            number = number_in(text)
            axis = 0 if field in ("longitude", "x") else 1
            known = number is not None and field is not None and field != "id"
            pairs = [(number, record.place[axis])] if known and number is not None else []
        most = max([most, *(abs(one - other) for one, other in pairs)])
    return most


def _check_crs(source: Source, value: dict[str, Any]) -> None:
    """Raise UnreadableFile if places are not in degrees of WGS84."""
    match value.get("crs"):
        case None | {"properties": {"name": None}}:
            return
        case {"properties": {"name": str(name)}} if _DEGREES.search(name[:_LONGEST_CRS]):
            return
        case {"properties": {"name": came}} | came:
            raise source.refusal("other-crs", "crs", came=came)


def _points(source: Source, feature: Any, at: int) -> Iterator[_Record]:
    """Yield a record for each point of a feature."""
    match feature:
        case {"geometry": {"type": "Point", "coordinates": [x, y, *_]}}:
            places = [(x, y)]
        case {"geometry": {"type": "MultiPoint", "coordinates": [*several]}} if several:
            places = [tuple(each[:2]) if isinstance(each, list) else () for each in several]
        case {"geometry": {"type": kind}}:
            raise source.refusal("no-feature-point", f"features/{at}", came=kind)
        case _:
            raise source.refusal("no-degrees-of-point", f"features/{at}")
    named = _properties(feature)
    for number, place in enumerate(places, 1):
        if not is_place(list(place)):
            raise source.refusal("no-place-of-numbers", f"features/{at}", came=place)
        name = _id(feature, named) or str(at + 1)
        own_id = name if len(places) == 1 else f"{name}-{number}"
        properties = dict(members_of(named))
        if properties.get("id", name) == name:
            properties.pop("id", None)
        yield _Record(own_id, (place[0], place[1]), properties)


def _id(feature: dict[str, Any], named: dict[str, Any]) -> str | None:
    for found in (feature.get("id"), named.get("id"), named.get("name")):
        if isinstance(found, str | int | float) and not isinstance(found, bool):
            return str(found)
    return None


def _properties(feature: dict[str, Any]) -> dict[str, Any]:
    properties = feature.get("properties")
    return properties if isinstance(properties, dict) else {}
