"""Requests with stops and objectives: the instances that they become, and every refusal."""

import io
import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pydantic_core import to_json

from service.errors import Refusal
from service.objectives import Objective
from service.requests.front import FrontRequest, parse_front_request
from service.requests.stops import Measured, Stop
from service.roads.great_circle import great_circle_matrix
from tests.helpers.serving import LIMITS

LOCATIONS = [[24.94, 60.17], [24.95, 60.171], [24.952, 60.18], [24.9, 60.16]]
STOPS = [
    {"id": name, "location": location}
    for name, location in zip(("depot", "order-17", "3", "ключ 🔑"), LOCATIONS, strict=True)
]
COSTS = [[0, 1, 2, 3], [4, 0, 5, 6], [7, 8, 0, 9], [1, 2, 3, 0]]
POINTS = [[0, 0], [3, 4], [6, 0], [3, 0]]
WAY = {"name": "way", "from": "great_circle"}
RISK = {"name": "risk", "unit": "accidents", "matrix": COSTS}
PLANE = {"name": "plane", "coordinates": POINTS}
OTHER_PLANE = {"name": "other", "coordinates": POINTS[::-1]}
ROADS = replace(LIMITS, roads=True)


def body(**members: Any) -> bytes:
    """A request with these members, and without those that are None."""
    whole = {"stops": STOPS, "objectives": [WAY, RISK], **members}
    return json.dumps({name: each for name, each in whole.items() if each is not None}).encode()


def parsed(**members: Any) -> FrontRequest:
    return parse_front_request(body(**members), LIMITS)


def refusal(content: bytes, npy: bytes | None = None) -> Refusal:
    with pytest.raises(Refusal) as refused:
        parse_front_request(content, LIMITS, npy)
    return refused.value


def npy(matrices: Any) -> bytes:
    stream = io.BytesIO()
    np.save(stream, np.array(matrices, dtype=np.float64))
    return stream.getvalue()


def test_two_planes_are_an_instance_of_coordinates() -> None:
    request = parsed(objectives=[PLANE, OTHER_PLANE])
    subject = request.subject.instance
    assert (request.kind, subject.kind) == ("coordinates", "coordinates")
    np.testing.assert_array_equal(subject.coordinates, np.hstack((POINTS, POINTS[::-1])))


def test_a_plane_beside_a_matrix_is_an_instance_of_matrices() -> None:
    request = parsed(objectives=[PLANE, RISK])
    subject = request.subject.instance
    assert (request.kind, subject.kind) == ("matrices", "matrices")
    distances = [[0, 5, 6, 3], [5, 0, 5, 4], [6, 5, 0, 3], [3, 4, 3, 0]]
    np.testing.assert_array_equal(subject.matrices, [distances, COSTS])


def test_great_circles_are_measured_once_the_job_runs() -> None:
    request = parsed()
    subject = request.subject
    assert (subject.n, subject.kind, request.kind) == (4, "matrices", "matrices")
    assert not subject.road_profiles
    expected = [great_circle_matrix(np.array(LOCATIONS)), COSTS]
    np.testing.assert_allclose(subject.instance.matrices, expected)


def test_road_matrices_complete_an_instance() -> None:
    objectives = [{"name": "time", "from": "road_time"}, WAY]
    request = parse_front_request(body(objectives=objectives), ROADS)
    subject = request.subject
    assert subject.sources == (Measured("road_time"), Measured("great_circle"))
    assert subject.road_profiles == [None]
    measured = subject.measured_by_road({Measured("road_time"): np.array(COSTS, np.float64)})
    assert not measured.road_profiles
    instance = measured.instance
    np.testing.assert_allclose(instance.matrices, [COSTS, great_circle_matrix(np.array(LOCATIONS))])


def test_matrices_may_come_as_a_file() -> None:
    objectives = [{"name": "time", "unit": "s"}, {"name": "risk"}]
    request = parse_front_request(body(objectives=objectives), LIMITS, npy([COSTS, COSTS]))
    subject = request.subject.instance
    np.testing.assert_array_equal(subject.matrices, [COSTS, COSTS])
    assert request.labels is not None
    assert request.labels.objectives == (Objective("time", "s"), Objective("risk"))


def test_the_stops_of_a_checked_request_are_read_already() -> None:
    request = parsed()
    assert "repairs" not in request.model_fields_set
    assert request.repairs == LIMITS.repairs
    assert vars(request)["labels"].stops[0].id == "depot"


def test_names_are_kept_and_measures_have_their_own_units() -> None:
    labels = parsed(stops=[*STOPS[:3], {"id": "far", "location": [0, 0]}]).labels
    assert labels is not None
    assert labels.objectives == (Objective("way", "m"), Objective("risk", "accidents"))
    assert labels.stops[0] == Stop("depot", (24.94, 60.17))
    unplaced = parsed(stops=[{"id": f"{i}"} for i in range(4)], objectives=[RISK, PLANE]).labels
    assert unplaced is not None
    assert unplaced.stops[3] == Stop("3", None)


def test_an_id_stands_where_an_index_may() -> None:
    tour = ["3", 0, "depot", "ключ 🔑"]
    request = parsed(start="3", initial_tours=[[0, 1, 2, 3], [*tour[:2], 1, tour[3]]])
    options = request.options()
    assert options.start == 2
    np.testing.assert_array_equal(options.initial_tours, [[0, 1, 2, 3], [2, 0, 1, 3]])
    assert parsed(start=3).options().start == 3
    assert parsed().options().start == 0


@pytest.mark.parametrize(
    ("members", "pointer", "sentence"),
    [
        ({"objectives": None}, "/objectives", "objectives is required with stops"),
        (
            {"stops": None, "coordinates": [[1, 2, 3, 4]]},
            "/stops",
            "stops is required with objectives",
        ),
        (
            {"matrices": [COSTS, COSTS]},
            "/matrices",
            "one of coordinates, matrices and stops is required, got matrices and stops",
        ),
        ({"stops": []}, "/stops", "stops must have 1 item or more, got 0"),
        ({"stops": {}}, "/stops", "stops must be a valid array, got an object"),
        ({"stops": ["depot"]}, "/stops/0", 'stops/0 must be an object, got "depot"'),
        ({"stops": [{}]}, "/stops/0/id", "stops/0/id is required"),
        ({"stops": [{"id": 7}]}, "/stops/0/id", "stops/0/id must be a valid string, got 7"),
        ({"stops": [{"id": ""}]}, "/stops/0/id", "must have 1 character or more, got 0"),
        ({"stops": [{"id": 101 * "x"}]}, "/stops/0/id", "must have 100 characters or fewer, got"),
        ({"stops": [{"id": "a\nb"}]}, "/stops/0/id", 'must be printable, in one line, got "a\\nb"'),
        ({"stops": [{"id": "a\u202eb"}]}, "/stops/0/id", "must be printable, in one line"),
        (
            {"stops": [{"id": "a", "idd": "a"}]},
            "/stops/0/idd",
            "that this request has; did you mean id?",
        ),
        (
            {"stops": [*STOPS[:3], STOPS[1]]},
            "/stops/3/id",
            'stops/3/id must not be that of stops/1, got "order-17" twice',
        ),
        (
            {"stops": [{"id": "a", "location": [24.9]}]},
            "/stops/0/location/1",
            "stops/0/location/1 is required",
        ),
        ({"stops": [{"id": "a", "location": [1, 2, 3]}]}, "/stops/0/location", "2 items or fewer"),
        (
            {"stops": [{"id": "a", "location": [60.17, 124.94]}]},
            "/stops/0/location/1",
            "stops/0/location/1 must be at most 90, got 124.94",
        ),
        (
            {"stops": [{"id": "a", "location": [-180.5, 0]}]},
            "/stops/0/location/0",
            "stops/0/location/0 must be at least -180, got -180.5",
        ),
        ({"objectives": [WAY]}, "/objectives", "objectives must have 2 items or more, got 1"),
        ({"objectives": [WAY] * 5}, "/objectives", "objectives must have 4 items or fewer, got 5"),
        (
            {"objectives": [WAY, {**RISK, "name": "way"}]},
            "/objectives/1/name",
            'objectives/1/name must not be that of objectives/0, got "way" twice',
        ),
        ({"objectives": [{"from": "great_circle"}, RISK]}, "/objectives/0/name", "is required"),
        (
            {"objectives": [{"name": "way", "form": "great_circle"}, RISK]},
            "/objectives/0/form",
            "objectives/0/form is not a field that this request has; did you mean from?",
        ),
        (
            {"objectives": [{"name": "way", "from": "great-circle"}, RISK]},
            "/objectives/0/from",
            "objectives/0/from must be 'great_circle', 'road_time' or 'road_distance', got",
        ),
        (
            {"objectives": [{**WAY, "unit": "km"}, RISK]},
            "/objectives/0/unit",
            'objectives/0/unit must be m, the unit of great_circle, got "km"',
        ),
        (
            {"objectives": [WAY, {"name": "risk"}]},
            "/objectives/1",
            "objectives/1 must have one of matrix, coordinates, from, slices, breakpoints and days,"
            " got none",
        ),
        (
            {"objectives": [WAY, {**RISK, "coordinates": POINTS}]},
            "/objectives/1",
            "must have one of matrix, coordinates, from, slices, breakpoints and days, got matrix",
        ),
        (
            {"objectives": [WAY, {**RISK, "matrix": COSTS[:3]}]},
            "/objectives/1/matrix",
            "objectives/1/matrix must have 4 rows, one for each stop, got 3",
        ),
        (
            {"objectives": [WAY, {**RISK, "matrix": [row[:3] for row in COSTS]}]},
            "/objectives/1/matrix",
            "objectives/1/matrix must be square, got 4 rows of 3 numbers",
        ),
        (
            {"objectives": [WAY, {**RISK, "matrix": [*COSTS[:3], [1, 2, -3, 0]]}]},
            "/objectives/1/matrix/3/2",
            "objectives/1/matrix/3/2 must not be negative, got -3",
        ),
        (
            {"objectives": [WAY, {**PLANE, "coordinates": [*POINTS, [1, 2]]}]},
            "/objectives/1/coordinates",
            "objectives/1/coordinates must have 4 rows, one for each stop, got 5",
        ),
        (
            {"objectives": [WAY, {**PLANE, "coordinates": [[0, 0, 0]]}]},
            "/objectives/1/coordinates/0",
            "objectives/1/coordinates/0 must have 2 items, got 3",
        ),
        (
            {"stops": [*STOPS[:3], {"id": "nowhere"}]},
            "/stops/3/location",
            "stops/3/location is required by objectives/0/from great_circle",
        ),
        ({"start": 4}, "/start", "start must be a city, 0 to 3, got 4"),
        (
            {"start": "order17"},
            "/start",
            'start must be the id of a stop, got "order17"; did you mean "order-17"?',
        ),
        (
            {"stops": [{**STOPS[0], "id": f"a-{i}"} for i in (1, 12, 132, 9)], "start": "a-32"},
            "/start",
            'start must be the id of a stop, got "a-32"; did you mean "a-132"?',
        ),
        ({"start": "x"}, "/start", 'start must be the id of a stop, got "x"'),
        ({"start": "elsewhere"}, "/start", 'start must be the id of a stop, got "elsewhere"'),
        (
            {"initial_tours": [[0, 1, 2, 3], [0, 1, "Depot", 3]]},
            "/initial_tours/1/2",
            'initial_tours/1/2 must be the id of a stop, got "Depot"; did you mean "depot"?',
        ),
        (
            {"initial_tours": [["depot", 0, 1, 2]]},
            "/initial_tours/0",
            "initial_tours/0 must visit each city, 0 to 3, once",
        ),
    ],
)
def test_what_is_no_request_with_stops_is_named(
    members: dict[str, Any], pointer: str, sentence: str
) -> None:
    refused = refusal(body(**members))
    assert (refused.code, refused.errors[0].pointer) == ("invalid-request", pointer)
    assert sentence in refused.detail


@pytest.mark.parametrize("measure", ["road_time", "road_distance"])
def test_roads_are_refused_where_no_routing_engine_is_configured(measure: str) -> None:
    refused = refusal(body(objectives=[RISK, {"name": "road", "from": measure}]))
    assert (refused.status, refused.code) == (422, "no-router")
    assert refused.errors[0].pointer == "/objectives/1/from"
    sentence = f"objectives/1/from {measure} needs a routing engine, and none is configured"
    assert refused.detail == sentence


def test_too_many_stops_are_refused() -> None:
    stops = [{"id": f"{i}"} for i in range(LIMITS.cities + 1)]
    refused = refusal(body(stops=stops, objectives=[{"name": "a", "matrix": []}, WAY]))
    assert (refused.status, refused.code, refused.limit) == (413, "too-many-cities", LIMITS.cities)
    assert refused.errors[0].pointer == "/stops"


def test_an_id_is_refused_where_cities_have_none() -> None:
    refused = refusal(json.dumps({"coordinates": [[1, 2, 3, 4]], "start": "depot"}).encode())
    sentence = 'start must be the index of a city, as there are no stops with ids, got "depot"'
    assert refused.detail == sentence


@pytest.mark.parametrize(
    ("objectives", "matrices", "pointer", "sentence"),
    [
        (
            [{"name": "time"}, RISK],
            [COSTS, COSTS],
            "/objectives/1",
            "must have no source where the part matrices holds them, got matrix",
        ),
        (
            [{"name": "time"}, {"name": "risk"}],
            [[[0, 1], [1, 0]]] * 2,
            "/matrices",
            "matrices must have 4 rows, one for each stop, got 2",
        ),
    ],
)
def test_a_file_of_matrices_that_does_not_fit_is_named(
    objectives: Any, matrices: Any, pointer: str, sentence: str
) -> None:
    refused = refusal(body(objectives=objectives), npy(matrices))
    assert (refused.code, refused.errors[0].pointer) == ("invalid-request", pointer)
    assert sentence in refused.detail


def test_long_ids_make_room_for_fewer_tours() -> None:
    def request(letter: str, **members: Any) -> FrontRequest:
        stops = [{"id": letter * 90 + f"{i}", "location": LOCATIONS[i]} for i in range(4)]
        few = replace(LIMITS, path_cells=5 * LIMITS.size)
        return parse_front_request(body(stops=stops, **members), few)

    assert request("x", size=LIMITS.size // 2).size == LIMITS.size // 2
    most = request("🔑").size
    assert most < LIMITS.size // 4
    assert len(to_json([stop.id for stop in request("🔑").stops])) * most < 40 * 5 * LIMITS.size
    with pytest.raises(Refusal, match=f"size must be at most {most} with 4 cities and ids so long"):
        request("🔑", size=most + 1)
    assert parsed().size == LIMITS.size
