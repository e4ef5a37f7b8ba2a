"""DataFrames in place of arrays and of stops, in requests of the client."""

import json
import re
from decimal import Decimal
from io import BytesIO
from typing import Any

import geopandas as gpd
import numpy as np
import pandas as pd
import pytest
from paretour import fleet_plan, front_plan
from shapely import Point

FLOOR = (
    'ENGCRS["floor plan",EDATUM["the corner of a hall"],CS[Cartesian,2],'
    'AXIS["x",east],AXIS["y",north],LENGTHUNIT["metre",1]]'
)
COSTS = pd.DataFrame([[0.0, 2.0], [3.0, 0.0]], index=["a", "b"], columns=["a", "b"])
IDS = ["#1001", "7"]
STOPS = pd.DataFrame(
    {
        "ID": ["#1001", 7],
        "lat": [60.1, 60.2],
        "Lon": [24.9, 25.0],
        "demand": [3, None],
        "note": ["ring twice", ""],
    }
)


def test_a_frame_of_coordinates_is_its_rows() -> None:
    frame = pd.DataFrame([[0, 1, 2, 3], [4, 5, 6, 7]], columns=["x", "y", "u", "v"])
    assert json.loads(front_plan({"coordinates": frame}).json) == {
        "coordinates": [[0, 1, 2, 3], [4, 5, 6, 7]]
    }


@pytest.mark.parametrize(
    ("instance", "member"),
    [
        (np.ones((5, 4)), "coordinates"),
        ([[0, 1, 2, 3], [4, 5, 6, 7]], "coordinates"),
        ([], "coordinates"),
        (pd.DataFrame(np.ones((5, 6))), "coordinates"),
        (np.ones((2, 5, 5)), "matrices"),
        ([[[0, None], [1, 0]], [[0, 1], [1, 0]]], "matrices"),
        ([COSTS, COSTS], "matrices"),
        ([{"id": "a"}, {"id": "b"}], "stops"),
        (STOPS, "stops"),
    ],
)
def test_an_instance_is_the_member_that_it_looks_like(instance: Any, member: str) -> None:
    plan, named = front_plan({"size": 7}, instance), front_plan({"size": 7, member: instance})  # type: ignore[misc]
    assert (plan.json, plan.file) == (named.json, named.file)


def test_what_is_no_instance_is_refused_and_so_are_two() -> None:
    with pytest.raises(ValueError, match=r"instance must be coordinates .*, got 1 dimensions"):
        front_plan({}, "berlin52.tsp")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"an instance before the members .*, and matrices"):
        front_plan({"matrices": np.ones((2, 3, 3))}, np.ones((3, 4)))


def test_two_frames_of_costs_are_a_file() -> None:
    plan = front_plan({"matrices": [COSTS, 10 * COSTS]})
    assert plan.file is not None
    np.testing.assert_array_equal(
        np.load(BytesIO(plan.file.content)), np.stack([COSTS, 10 * COSTS])
    )


def test_an_infinite_cost_of_a_frame_is_null() -> None:
    request: Any = {
        "stops": STOPS,
        "objectives": [
            {"name": "way", "from": "great_circle"},
            {
                "name": "risk",
                "matrix": COSTS.replace(3.0, np.inf).set_axis(IDS).set_axis(IDS, axis=1),
            },
        ],
    }
    body = json.loads(front_plan(request).json)
    assert body["objectives"][1]["matrix"] == [[0, 2], [None, 0]]
    assert body["stops"][0] == {"id": "#1001", "location": [24.9, 60.1], "demand": [3.0]}
    assert body["stops"][1] == {"id": "7", "location": [25.0, 60.2]}


def test_a_frame_of_stops_is_a_fleet_s_too() -> None:
    request: Any = {"stops": STOPS, "vehicles": [{"id": "van"}]}
    assert json.loads(fleet_plan(request).json)["stops"][0]["demand"] == [3.0]


def test_a_frame_of_stops_without_a_place_is_refused_with_what_it_lacks() -> None:
    request: Any = {"stops": STOPS.drop(columns="Lon")}
    with pytest.raises(ValueError, match=r"stops must have a column lon or lng or longitude, got"):
        front_plan(request)


PLACES = pd.DataFrame({"id": ["a", "b"], "lat": [60.1, 60.2], "lon": [24.9, 25.0]}, [5, 6])
PLANES = pd.DataFrame([[0.0, 1, 2, 3], [4, 5, 6, 7]], columns=["x", "y", "u", "v"])


def at(frame: pd.DataFrame, row: int, column: Any, cell: Any) -> pd.DataFrame:
    """A frame with another cell."""
    changed = frame.astype(object)
    changed.iat[row, list(frame.columns).index(column)] = cell
    return changed


EMPTY = [None, np.nan, pd.NA, pd.NaT]
NO_NUMBERS = [*EMPTY, -np.inf, "60.1", pd.Timestamp(0), 1j, [1.0], "x" * 500]
NAMED: list[tuple[dict[str, Any], str]] = [
    *(
        ({"coordinates": at(PLANES, 1, "u", cell)}, "coordinates: row 1, column 'u' must be a n")
        for cell in [*NO_NUMBERS, np.inf]
    ),
    *(
        ({"matrices": [COSTS, at(COSTS, 0, "b", cell)]}, "matrices: row 'a', column 'b' must be a")
        for cell in NO_NUMBERS
    ),
    *(
        ({"stops": at(PLACES, 1, "lat", cell)}, "stops: row 6, column 'lat' must be a number, got")
        for cell in [*NO_NUMBERS, np.inf]
    ),
    *(
        ({"stops": at(PLACES, 0, "id", cell)}, "stops: row 5, column 'id' must be an id, got")
        for cell in EMPTY
    ),
    *(
        ({"stops": PLACES.assign(**{name: cell})}, f"stops: row 5, column '{name}' must be")
        for name in ("demand", "service", "prize", "window", "windows", "due", "release")
        for cell in ("8:00", pd.Timestamp(0), 1j)
    ),
    *(
        ({"stops": PLACES.assign(skills=[cell, None])}, "row 5, column 'skills' must be skills, as")
        for cell in (7, ["crane", 7], pd.Timestamp(0))
    ),
    *(
        ({"stops": PLACES.assign(windows=[None, cell])}, "row 6, column 'windows' must be")
        for cell in ([0, 60], [[0, 60, 90]], [[0, "9:00"]], 7)
    ),
    ({"stops": PLACES.assign(vehicle=[["van"], None])}, "row 5, column 'vehicle' must be an id"),
    ({"stops": PLACES.assign(window=7)}, "column 'window' must be two times, as [0, 3600], got 7"),
    (
        {"stops": PLACES.set_axis(["id", "lat", "lat"], axis=1).assign(lon=1)},
        "stops must have one column lat, got 'id', 'lat', 'lat', 'lon'",
    ),
    ({"stops": PLACES.assign(LAT=1)}, "stops must have one column lat, got"),
    ({"stops": PLACES["lat"]}, "stops must have a column id or name, got none"),
    ({"stops": PLACES.set_index("id")}, "stops must have a column id or name, got 'lat', 'lon'"),
    ({"coordinates": PLANES["u"].replace(6, np.nan)}, "coordinates: row 1 must be a number, got"),
    (
        {"matrices": [COSTS, COSTS[["b", "a"]]]},
        "matrices must have its rows and columns in the same order",
    ),
]


@pytest.mark.parametrize(("request_", "sentence"), NAMED)
def test_a_frame_with_a_cell_that_cannot_be_sent_is_refused_by_row_and_column(
    request_: Any, sentence: str
) -> None:
    for plan in (front_plan, fleet_plan):
        with pytest.raises(ValueError, match=f"^.*{re.escape(sentence)}") as refused:
            plan(request_)
        assert len(str(refused.value)) < 250


@pytest.mark.parametrize("cell", EMPTY)
def test_the_diagonal_of_costs_is_disregarded(cell: Any) -> None:
    plan = front_plan({"matrices": [at(COSTS, 1, "b", cell), COSTS]})
    assert plan.file is not None
    np.testing.assert_array_equal(np.load(BytesIO(plan.file.content))[0], COSTS)


@pytest.mark.parametrize(
    ("ids", "sent"),
    [
        ([1.0, 2.0], ["1", "2"]),
        ([1.5, 2.0], ["1.5", "2.0"]),
        ([1.0, "b"], ["1", "b"]),
        (["1.0", 7], ["1.0", "7"]),
        (pd.array([1, 2], dtype="Int64"), ["1", "2"]),
    ],
)
def test_ids_that_are_whole_numbers_have_no_fraction(ids: Any, sent: list[str]) -> None:
    body = json.loads(front_plan({"stops": PLACES.assign(id=ids)}).json)
    assert [stop["id"] for stop in body["stops"]] == sent


def test_empty_cells_of_what_a_stop_may_lack_are_left_out() -> None:
    frame = PLACES.assign(
        demand=pd.array([3, None], dtype="Int64"),
        prize=[pd.NA, 4],
        window=[[0, 60], None],
        service=[np.nan, 5],
        note=["", None],
    )
    first, second = json.loads(fleet_plan({"stops": frame}).json)["stops"]
    assert first == {"id": "a", "location": [24.9, 60.1], "demand": [3], "window": [0, 60]}
    assert second == {"id": "b", "location": [25.0, 60.2], "prize": 4, "service": 5}


def test_bounds_of_stops_are_lists_in_cells_and_may_be_empty() -> None:
    frame = PLACES.assign(
        windows=[[[0, 60], [120, 180]], None],
        due=[np.nan, 50],
        release=[10, pd.NA],
        skills=[("fridge", "crane"), np.nan],
        vehicle=[None, "van"],
    )
    request = {"stops": frame, "vehicles": [{"id": "van"}], "clock": "time"}
    first, second = json.loads(fleet_plan(request).json)["stops"]
    assert first == {
        "id": "a",
        "location": [24.9, 60.1],
        "windows": [[0, 60], [120, 180]],
        "release": 10,
        "skills": ["fridge", "crane"],
    }
    assert second == {"id": "b", "location": [25.0, 60.2], "due": 50, "vehicle": "van"}


def test_bounds_of_stops_may_be_as_a_file_has_them() -> None:
    frame = PLACES.assign(
        skills=["fridge; tail lift", "crane"],
        vehicle=[np.nan, 7.0],
        windows=[[np.array([0, 60])], np.array([[0, 60], [90, 99]])],
    )
    first, second = json.loads(fleet_plan({"stops": frame}).json)["stops"]
    assert first["skills"] == ["fridge", "tail lift"]
    assert first["windows"] == [[0, 60]]
    assert "vehicle" not in first
    assert second["skills"] == ["crane"]
    assert second["vehicle"] == "7"
    assert second["windows"] == [[0, 60], [90, 99]]


class ListColumn(list[Any]):
    """A list in a cell as polars gives it: a column of its own, compared cell by cell."""

    def to_list(self) -> list[Any]:
        return list(self)

    def __eq__(self, other: object) -> Any:
        raise AssertionError("a column has no truth value")


def test_a_list_in_a_cell_of_polars_is_a_list() -> None:
    cells = pd.Series([ListColumn([0, 60]), None], index=PLACES.index, dtype=object)
    first, second = json.loads(fleet_plan({"stops": PLACES.assign(window=cells)}).json)["stops"]
    assert first["window"] == [0, 60]
    assert "window" not in second


@pytest.mark.parametrize(
    "frame",
    [
        at(PLANES, 0, "x", Decimal("0.5")),
        PLANES.astype("Float64"),
        PLANES.astype("Int64"),
        PLANES.astype("float32"),
    ],
)
def test_numbers_of_any_type_are_sent_as_numbers(frame: pd.DataFrame) -> None:
    body = json.loads(front_plan({"coordinates": frame}).json)
    assert body["coordinates"] == frame.astype(float).to_numpy().tolist()


def points(crs: Any, *places: tuple[float, float]) -> Any:
    ids = [f"p{number}" for number in range(len(places))]
    geometry = gpd.points_from_xy(*zip(*places, strict=True))
    return gpd.GeoDataFrame({"id": ids, "demand": 3}, geometry=geometry, crs=crs)


def test_points_in_degrees_are_the_locations_of_stops() -> None:
    frame = points("EPSG:4326", (24.94, 60.17), (24.92, 60.19))
    stops = json.loads(fleet_plan({"stops": frame, "vehicles": [], "objectives": []}).json)["stops"]
    assert stops == [
        {"id": "p0", "location": [24.94, 60.17], "demand": [3]},
        {"id": "p1", "location": [24.92, 60.19], "demand": [3]},
    ]


def test_points_in_metres_become_longitude_and_latitude() -> None:
    frame = points("EPSG:3857", (0, 0), (20037508.342789244, 20037508.342789244))
    stops = json.loads(front_plan({"stops": frame}).json)["stops"]
    assert [stop["location"] for stop in stops] == [
        [0, 0],
        pytest.approx([180, 85.05112877980659]),
    ]


def test_points_named_otherwise_are_found_by_being_the_geometry() -> None:
    frame = points("EPSG:4326", (24.94, 60.17)).rename_geometry("place")
    assert json.loads(front_plan({"stops": frame}).json)["stops"][0]["location"] == [24.94, 60.17]


@pytest.mark.parametrize(
    ("frame", "sentence"),
    [
        (points(None, (24.9, 60.2)), "must have a coordinate reference system, got none; for"),
        (
            gpd.GeoDataFrame({"id": ["a"]}),
            "must have a column of points as their geometry, got none",
        ),
        (
            points(4326, (24.9, 60.2)).set_geometry([Point(1, 1).buffer(1)], crs=4326),
            "row 0, column 'geometry' must be a point, got <POLYGON",
        ),
        (
            points(4326, (24.9, 60.2)).set_geometry([None], crs=4326),
            "row 0, column 'geometry' must be a point, got None",
        ),
        (points(4326, (24.9, 60.2)).set_geometry([Point()], crs=4326), "got <POINT EMPTY>"),
        (points(FLOOR, (1, 2)), "can become EPSG:4326, got floor plan"),
        (points(3067, (1e30, 2)), "must be a number, got inf"),
    ],
)
def test_stops_whose_places_are_not_known_are_refused(frame: Any, sentence: str) -> None:
    with pytest.raises(ValueError, match=f"^stops.*{re.escape(sentence)}"):
        front_plan({"stops": frame})
