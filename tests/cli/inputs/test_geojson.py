"""GeoJSON on the command line: points are stops, everything else is refused by name."""

import json
from pathlib import Path
from typing import Any

import pytest

from service.cli.errors import UnreadableFile
from service.cli.inputs.files import read_request

OBJECTIVES = [{"name": name, "from": "great_circle"} for name in ("way", "again")]


def point(**members: Any) -> dict[str, Any]:
    geometry = {"type": "Point", "coordinates": [24.9, 60.2, 7.0]}
    return {"type": "Feature", "geometry": geometry, **members}


def written(path: Path, features: Any, **more: Any) -> Path:
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features, **more}))
    return path


@pytest.mark.parametrize("name", ["stops.geojson", "stops.json"])
def test_points_are_stops_by_their_ids(tmp_path: Path, name: str) -> None:
    features = [
        point(id="depot"),
        point(id=17),
        point(properties={"id": "a", "name": "b"}),
        point(id=None, properties={"name": "c"}),
    ]
    path = written(tmp_path / name, features, objectives=OBJECTIVES, size=3, bbox=[0, 0, 1, 1])
    request, ids = read_request([path])
    assert ids == ("depot", "17", "a", "c")
    assert request == {
        "objectives": OBJECTIVES,
        "size": 3,
        "stops": [{"id": each, "location": [24.9, 60.2]} for each in ids],
    }


@pytest.mark.parametrize(
    ("features", "more", "sentence"),
    [
        (None, {}, "must have a list of features"),
        ([point(id="a")], {}, "must have a member objectives"),
        ([point(id="a"), 3], {"objectives": OBJECTIVES}, "features/1 must be a Point"),
        ([{"geometry": None}], {"objectives": OBJECTIVES}, "features/0 must be a Point"),
        (
            [{"geometry": {"type": "LineString", "coordinates": [[0, 0], [1, 1]]}}],
            {"objectives": OBJECTIVES},
            "features/0 must be a Point",
        ),
        ([point(properties=[1])], {"objectives": OBJECTIVES}, "features/0 must have an id"),
        ([point(id=True)], {"objectives": OBJECTIVES}, "features/0 must have an id"),
    ],
)
def test_what_are_no_stops_is_named(
    tmp_path: Path, features: Any, more: dict[str, Any], sentence: str
) -> None:
    path = written(tmp_path / "stops.geojson", features, **more)
    with pytest.raises(UnreadableFile, match=f"stops.geojson: .*{sentence}"):
        read_request([path])
