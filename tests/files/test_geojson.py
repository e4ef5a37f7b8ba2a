"""GeoJSON: the geometry says where a stop is, and no property vanishes in silence."""

import json
from typing import Any

import pytest

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile

PLACES = {"a": [24.941, 60.171], "b": [24.952, 60.169], "c": [24.933, 60.165]}
GREAT = {"name": "distance", "from": "great_circle"}
MATRIX = {"name": "m", "matrix": [[0, 1, 2], [1, 0, 3], [2, 3, 0]]}
TIME = {"name": "drive", "from": "great_circle", "speed": 30}
VANS = [{"id": "van", "start": "a", "end": "a", "capacity": [9]}]


def read(*properties: dict[str, Any], **members: Any) -> Reading:
    """Read three stops with these properties."""
    features = [
        {
            "type": "Feature",
            "properties": {"id": name, **own},
            "geometry": {"type": "Point", "coordinates": place},
        }
        for (name, place), own in zip(PLACES.items(), properties, strict=True)
    ]
    value = {"type": "FeatureCollection", "features": features, **members}
    data = json.dumps(value).encode()
    return read_files([NamedFile("a.geojson", data)], Bounds(), wanted=None)


def same(**properties: Any) -> list[dict[str, Any]]:
    return [properties] * 3


STALE = "of the properties lie up to"


@pytest.mark.parametrize(
    ("properties", "note"),
    [
        (same(latitude=59, longitude=20), f"'latitude' and 'longitude' {STALE} 4.95 degrees"),
        (same(lat=59, lon=20), f"'lat' and 'lon' {STALE} 4.95 degrees"),
        (same(Latitude="59.0", Longitude="20.0"), f"'Latitude' and 'Longitude' {STALE}"),
        (same(lat=59), "'lat' of the properties lies up to 1.17 degrees"),
        (
            [{"lon": x, "lat": 59} for x, _ in PLACES.values()],
            "'lat' of the properties lies up to 1.17 degrees",
        ),
        (same(WKT="POINT (20 59)"), "'WKT' of the properties lies up to"),
        (same(coordinates=[20, 59]), f"'longitude' and 'latitude' {STALE}"),
        (same(location={"lat": 59, "lng": 20}), f"'lat' and 'lng' {STALE}"),
        (same(position="59.0, 20.0"), "'position' of the properties lies up to"),
        ([{"lon": x, "lat": y} for x, y in PLACES.values()], None),
        ([{"X": x, "Y": y} for x, y in PLACES.values()], None),
        ([{"lon": x, "lat": y} for y, x in PLACES.values()], f"'lon' and 'lat' {STALE}"),
        (same(lat="", lon=None), None),
        (same(note="ring twice"), None),
        (same(City="Oulu"), None),
    ],
)
def test_the_geometry_counts(properties: list[dict[str, Any]], note: str | None) -> None:
    reading = read(*properties)
    assert reading.request["stops"] == [{"id": k, "location": v} for k, v in PLACES.items()]
    assert "coordinates" not in json.dumps(reading.request["objectives"])
    notes = [each.text for each in reading.notes if each.code == "place"]
    assert notes == [] if note is None else [each.startswith(note) for each in notes] == [True]
    named = {each.name.removesuffix(" (property)") for each in reading.columns}
    assert {"id", "longitude", "latitude"} <= named


def test_columns_that_the_geometry_replaces_are_told_as_ignored() -> None:
    columns = {each.name: each.taken_for for each in read(*same(latitude=59, lon=20)).columns}
    assert columns["latitude (property)"] == columns["lon"] == "ignored"
    assert columns["latitude"] == "latitude"


def test_columns_beside_them_can_be_chosen() -> None:
    value = {
        "type": "Feature",
        "properties": {"id": "a", "lat": 59, "sacks": 3},
        "geometry": {"type": "Point", "coordinates": [24, 60]},
    }
    chosen = {"sacks": "demand", "lat": "ignored"}
    file = NamedFile("a.json", json.dumps(value).encode(), chosen)
    reading = read_files([file], Bounds(), wanted=None)
    assert reading.request["stops"] == [{"id": "a", "location": [24, 60], "demand": [3]}]
    assert [each.taken_for for each in reading.columns if each.name == "lat"] == ["ignored"]


@pytest.mark.parametrize(
    ("properties", "members", "kind", "stop"),
    [
        (same(), {"objectives": [GREAT, MATRIX]}, "front", {}),
        (same(risk=2), {"objectives": [GREAT, MATRIX]}, "front", {}),
        (same(demand=2), {"objectives": [GREAT, MATRIX]}, "fleet", {"demand": [2]}),
        (same(qty=2), {"objectives": [GREAT, MATRIX], "vehicles": VANS}, "fleet", {"demand": [2]}),
        (same(), {"vehicles": VANS}, "fleet", {}),
        (same(demand=2), {"vehicles": VANS}, "fleet", {"demand": [2]}),
        (same(demand=2, service=300), {"objectives": [GREAT, TIME]}, "fleet", {"service": 300}),
        (
            same(service=300),
            {"objectives": [GREAT, MATRIX], "clock": "m"},
            "fleet",
            {"service": 300},
        ),
        (same(skills=["crane"]), {"vehicles": VANS}, "fleet", {"skills": ["crane"]}),
    ],
)
def test_properties_are_kept_beside_members(
    properties: list[dict[str, Any]], members: dict[str, Any], kind: str, stop: dict[str, Any]
) -> None:
    reading = read(*properties, **members)
    assert reading.kind == kind
    assert {**reading.request["stops"][1], **stop} == reading.request["stops"][1]
    for name, value in members.items():
        assert reading.request[name] == value
    if "service" in stop:
        assert reading.request["clock"] in ("drive", "m")


@pytest.mark.parametrize(
    "members", [{"objectives": [GREAT, MATRIX]}, {"objectives": [TIME, {**TIME, "name": "walk"}]}]
)
def test_times_without_a_clock_are_refused(members: dict[str, Any]) -> None:
    with pytest.raises(UnreadableFile, match="must have the member clock"):
        read(*same(demand=2, service=300), **members)


def test_a_property_id_beside_another_id_is_a_detail() -> None:
    value = {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "id": at,
                "properties": {"id": f"A{at}"},
                "geometry": {"type": "Point", "coordinates": [24, 60 + at]},
            }
            for at in range(3)
        ],
    }
    file = NamedFile("a.json", json.dumps(value).encode())
    reading = read_files([file], Bounds(), wanted=None)
    assert [stop["id"] for stop in reading.request["stops"]] == ["0", "1", "2"]
    assert "id (property)" in {each.name for each in reading.columns}


def test_dates_of_stops_count_as_in_a_table() -> None:
    days = [{"from": f"2026-03-0{day} 8:00", "to": f"2026-03-0{day} 10:00"} for day in (2, 3, 4)]
    reading = read(*days, vehicles=VANS)
    begins = [stop["window"][0] for stop in reading.request["stops"]]
    assert begins == [28800, 28800 + 86400, 28800 + 2 * 86400]
    assert [note.text for note in reading.notes if note.code == "dates"] == [
        "Times count from 2026-03-02 0:00, the first date: 2026-03-04 0:00 is 48:00."
    ]
