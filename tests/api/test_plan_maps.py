"""POST /coverage with the maps of robots, against a live server: pictures, messages, poses."""

import json
import math
from typing import Any

import httpx
import numpy as np
import pytest

from tests.helpers.serving import LIMITS, problem

# A map without any symmetry, from the top: free ., obstacle #, unknown ?.
DRAWN = """
?????????
?.......?
?.##.##.?
?.#...#.?
?.#.....?
?...#...?
?????????
"""
CELLS = [list(row) for row in DRAWN.split()]
SHADES = {".": 254, "#": 0, "?": 205}  # as map_saver writes them
OCCUPANCY = {".": 0, "#": 100, "?": -1}
ROWS, COLUMNS = len(CELLS), len(CELLS[0])
ORIGIN = [-2.0, 5.0, 0.5]
SIDE = 0.05
READING = {"negate": False, "occupied_thresh": 0.65, "free_thresh": 0.196, "mode": "trinary"}
PGM = f"P5\n# CREATOR: map_saver.cpp\n{COLUMNS} {ROWS}\n255\n".encode() + bytes(
    SHADES[cell] for row in CELLS for cell in row
)
MESSAGE = {
    "header": {"frame_id": "map"},
    "info": {
        "resolution": SIDE,
        "width": COLUMNS,
        "height": ROWS,
        "origin": {
            "position": {"x": ORIGIN[0], "y": ORIGIN[1], "z": 0},
            "orientation": {"z": math.sin(ORIGIN[2] / 2), "w": math.cos(ORIGIN[2] / 2)},
        },
    },
    "data": [OCCUPANCY[cell] for row in CELLS[::-1] for cell in row],
}
PLAN: dict[str, Any] = {
    "spacing": 0.1,
    "cost_layer": np.random.default_rng(0).random((ROWS, COLUMNS)).tolist(),
    "time_limit": 0,
    "paths": True,
}
OF_PICTURE = {**PLAN, **READING, "cell_size": SIDE, "origin": ORIGIN}


def with_picture(
    client: httpx.Client, request: dict[str, Any], picture: bytes = PGM
) -> httpx.Response:
    files = {"request": (None, json.dumps(request)), "map": ("map.pgm", picture)}
    return client.post("/coverage", files=files)


def cell_at(x: float, y: float) -> str:
    """What the drawing has at a point in the frame of the map: turned back, from below."""
    inside = complex(x - ORIGIN[0], y - ORIGIN[1]) * complex(
        math.cos(ORIGIN[2]), -math.sin(ORIGIN[2])
    )
    from_below, column = int(inside.imag // SIDE), int(inside.real // SIDE)
    return CELLS[ROWS - 1 - from_below][column]


def point_of(row: int, column: int) -> list[float]:
    """The middle of a cell of the drawing in the frame of the map."""
    inside = complex(column + 0.5, ROWS - row - 0.5) * SIDE
    turned = inside * complex(math.cos(ORIGIN[2]), math.sin(ORIGIN[2]))
    return [ORIGIN[0] + turned.real, ORIGIN[1] + turned.imag]


def test_paths_in_the_frame_of_the_map_keep_to_free_cells(client: httpx.Client) -> None:
    answer = with_picture(client, OF_PICTURE)
    assert answer.status_code == 200, answer.text
    assert len(answer.json()["places"]) > 5
    for item in answer.json()["front"]:
        path = item["path"]
        assert {cell_at(x, y) for x, y in path["points"]} == {"."}
        expected = [point_of(*cell) for cell in path["cells"]]
        np.testing.assert_allclose(path["points"], expected, atol=1e-6 * SIDE)
        moves = np.diff([complex(*point) for point in path["points"]])
        towards = np.append(moves, moves[-1]) / np.abs(np.append(moves, moves[-1]))
        np.testing.assert_allclose(np.exp(1j * np.array(path["yaws"])), towards, atol=1e-5)
        walked = np.hypot(*np.diff(path["points"], axis=0).T).sum()
        assert walked == pytest.approx(path["metres"]) == pytest.approx(item["lengths"][0])


def visited(path: dict[str, Any], places: list[list[int]]) -> list[int]:
    """The places of the visits of a path, whose cells must be theirs, in order along the path."""
    indexes = [index for index, _ in path["visits"]]
    assert (indexes[0], indexes[-1]) == (0, len(path["cells"]) - 1)
    assert indexes == sorted(indexes)
    assert [path["cells"][index] for index in indexes] == [
        places[place] for _, place in path["visits"]
    ]
    return [place for _, place in path["visits"]]


@pytest.mark.parametrize("closed", [True, False])
def test_a_path_tells_its_places_from_the_cells_on_the_way(
    client: httpx.Client, closed: bool
) -> None:
    answer = with_picture(client, {**OF_PICTURE, "closed": closed})
    assert answer.status_code == 200, answer.text
    for item in answer.json()["front"]:
        back = item["tour"][:1] if closed else []
        assert visited(item["path"], answer.json()["places"]) == item["tour"] + back


def test_the_routes_of_robots_tell_their_places_and_directions(client: httpx.Client) -> None:
    robots = [{"id": "a"}, {"id": "b", "start": 1}]
    request = {k: v for k, v in OF_PICTURE.items() if k != "cost_layer"}
    answer = with_picture(client, {**request, "robots": robots})
    assert answer.status_code == 200, answer.text
    for plan in answer.json()["front"]:
        for route in plan["routes"]:
            path = route["path"]
            assert visited(path, answer.json()["places"]) == route["tour"]
            moves = np.diff([complex(*point) for point in path["points"]])
            np.testing.assert_allclose(
                np.exp(1j * np.array(path["yaws"]))[:-1], moves / np.abs(moves), atol=1e-5
            )


def test_a_message_is_planned_as_the_picture_of_the_same_map(client: httpx.Client) -> None:
    answer = client.post("/coverage", json={**PLAN, "occupancy_grid": MESSAGE})
    assert answer.status_code == 200, answer.text
    of_picture = with_picture(client, OF_PICTURE).json()
    assert answer.json()["places"] == of_picture["places"]
    for item, other in zip(answer.json()["front"], of_picture["front"], strict=True):
        np.testing.assert_allclose(item["path"]["points"], other["path"]["points"], atol=1e-9)
        assert item["tour"] == other["tour"]


def test_tours_begin_and_end_at_the_pose_of_the_robot(client: httpx.Client) -> None:
    pose = point_of(3, 5)
    answer = with_picture(client, {**OF_PICTURE, "spacing": 0.2, "start_pose": [*pose, 1.57]})
    assert answer.status_code == 200, answer.text
    for item in answer.json()["front"]:
        assert answer.json()["places"][item["tour"][0]] == [3, 5]
        np.testing.assert_allclose(item["path"]["points"][0], pose, atol=1e-6)
        np.testing.assert_allclose(item["path"]["points"][-1], pose, atol=1e-6)


def test_open_routes_go_from_one_pose_to_the_other(client: httpx.Client) -> None:
    start, end = point_of(3, 5), point_of(1, 1)
    poses = {"closed": False, "start_pose": start, "end_pose": end}
    answer = with_picture(client, {**OF_PICTURE, "spacing": 0.2, **poses})
    assert answer.status_code == 200, answer.text
    n = answer.json()["cities"]
    for item in answer.json()["front"]:
        assert sorted(item["tour"]) == list(range(n))
        np.testing.assert_allclose(item["path"]["points"][0], start, atol=1e-6)
        np.testing.assert_allclose(item["path"]["points"][-1], end, atol=1e-6)
        walked = np.hypot(*np.diff(item["path"]["points"], axis=0).T).sum()
        assert walked == pytest.approx(item["path"]["metres"]) == pytest.approx(item["lengths"][0])


def test_unknown_cells_are_free_where_that_is_asked_for(client: httpx.Client) -> None:
    answer = with_picture(client, {**OF_PICTURE, "unknown": "free", "start_pose": point_of(0, 0)})
    assert answer.status_code == 200, answer.text
    corner = with_picture(client, {**OF_PICTURE, "start_pose": point_of(0, 0)})
    document = problem(corner, 422, "invalid-request")
    assert document["errors"][0] == {
        "detail": "start_pose must be a free cell, and [0, 0] is an obstacle",
        "pointer": "/start_pose",
        "code": "obstacle",
        "demand": "must be a free cell, and [0, 0] is an obstacle",
        "values": {"given": "[0, 0]"},
    }


def test_a_picture_without_an_origin_has_paths_without_points(client: httpx.Client) -> None:
    request = {name: value for name, value in OF_PICTURE.items() if name != "origin"}
    [item, *_] = with_picture(client, request).json()["front"]
    assert set(item["path"]) == {"cells", "metres", "visits"}


def test_a_stored_tour_has_its_points(client: httpx.Client) -> None:
    answer = with_picture(client, OF_PICTURE).json()
    tour = client.get("/tour", params={"angle": 45, "front": answer["id"]}).json()
    assert tour["path"] in [item["path"] for item in answer["front"]]
    assert len(tour["path"]["points"]) == len(tour["path"]["cells"])


@pytest.mark.parametrize(
    ("change", "pointer", "sentence"),
    [
        ({"start": 0}, "/start_pose", "start_pose or start must be left out"),
        (
            {"end_pose": [0, 0]},
            "/end_pose",
            "end_pose is for open routes, with closed false",
        ),
        (
            {"closed": False, "end": 1, "end_pose": [0, 0]},
            "/end_pose",
            "end_pose or end must be left out",
        ),
        ({"closed": False, "end_pose": [0, 0]}, "/end_pose", "end_pose must be a cell of the grid"),
        ({"origin": 1}, "/origin", "origin must be a valid array, got 1"),
        (
            {"initial_tours": [[0, 1]], "places": [[1, 1], [1, 2]]},
            "/initial_tours",
            "initial_tours must be left out where a pose may become a place",
        ),
        ({"start_pose": [0, 0, 0, 0]}, "/start_pose", "start_pose must have 3 items or fewer"),
        ({"start_pose": [0]}, "/start_pose", "start_pose must have 2 items or more, got 1"),
        ({"start_pose": [100, 0]}, "/start_pose", "start_pose must be a cell of the grid of 7 x 9"),
    ],
)
def test_a_pose_that_cannot_be_is_named(
    client: httpx.Client, change: dict[str, Any], pointer: str, sentence: str
) -> None:
    answer = with_picture(client, {**OF_PICTURE, "start_pose": point_of(1, 1), **change})
    document = problem(answer, 422, "invalid-request")
    assert document["errors"][0]["pointer"] == pointer
    assert sentence in document["errors"][0]["detail"]


def test_a_pose_needs_an_origin(client: httpx.Client) -> None:
    request = {"grid": [[0]], "cell_size": 1, "start_pose": [0, 0], "cost_layer": [[1]]}
    answer = client.post("/coverage", json={**request, "spacing": 1})
    document = problem(answer, 422, "invalid-request")
    assert document["detail"] == "start_pose must be in the frame of a map with an origin"


@pytest.mark.parametrize(
    ("picture", "status", "code"),
    [
        (b"P5 9000 9000 255\n", 413, "too-many-cells"),
        (b"P5 9 7 255\n", 422, "invalid-request"),
        (b"image: map.pgm\nresolution: 0.05\n", 422, "invalid-request"),
    ],
)
def test_a_broken_picture_is_refused(
    client: httpx.Client, picture: bytes, status: int, code: str
) -> None:
    assert problem(with_picture(client, OF_PICTURE, picture), status, code)


def test_a_message_of_too_many_cells_is_413(client: httpx.Client) -> None:
    info = {**MESSAGE["info"], "width": 100, "height": 100}  # type: ignore[dict-item]
    answer = client.post("/coverage", json={**PLAN, "occupancy_grid": {**MESSAGE, "info": info}})
    document = problem(answer, 413, "too-many-cells")
    assert (document["limit"], document["actual"]) == (LIMITS.cells, 10_000)
