"""Paths over a map as poses, as messages for ROS and as CSV."""

import csv
import io
import math

import numpy as np
import pytest
from paretour import Path

from tests.helpers.answers import Connect

REQUEST = {
    "grid": [[0, 0, 0, 0], [0, 1, 1, 0], [0, 0, 0, 0]],
    "cell_size": 0.5,
    "origin": [-2.0, 1.0, 0.25],
    "places": [[0, 0], [2, 0], [2, 3], [0, 2]],
    "cost_layer": [[1, 1, 1, 1], [0, 0, 0, 9], [0, 0, 0, 1]],
    "paths": True,
}


def test_a_path_is_poses_a_message_and_rows(connect: Connect, url: str) -> None:
    front = connect(url).coverage(**REQUEST)
    for tour in front:
        path = tour.path
        assert path is not None
        assert path.poses.shape == (len(path.cells), 3)
        message = path.to_nav_path("floor")
        assert message["header"] == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "floor"}
        read = []
        for pose in message["poses"]:
            assert pose["header"] == message["header"]
            turned = pose["pose"]["orientation"]
            assert (turned["x"], turned["y"], pose["pose"]["position"]["z"]) == (0, 0, 0)
            assert math.hypot(turned["z"], turned["w"]) == pytest.approx(1)
            position = pose["pose"]["position"]
            read.append((position["x"], position["y"], 2 * math.atan2(turned["z"], turned["w"])))
        np.testing.assert_allclose(read, path.poses)
        rows = list(csv.DictReader(io.StringIO(path.to_csv())))
        values = [[float(row[name]) for name in ("x", "y", "yaw")] for row in rows]
        np.testing.assert_allclose(values, path.poses)
        order = [int(row["place"]) for row in rows if row["place"]]
        assert order == [*tour.tour.tolist(), tour.tour[0]]


def test_two_places_in_one_cell_share_a_row_of_csv() -> None:
    path = Path(
        np.array([[0, 0], [0, 1]]),
        1.0,
        points=np.array([[0.5, 0.5], [1.5, 0.5]]),
        yaws=np.zeros(2),
        visits=np.array([[0, 0], [1, 2], [1, 1]]),
    )
    assert path.to_csv() == "x,y,yaw,place\n0.5,0.5,0.0,0\n1.5,0.5,0.0,2 1\n"


def test_a_path_without_an_origin_has_no_poses(connect: Connect, url: str) -> None:
    request = {name: value for name, value in REQUEST.items() if name != "origin"}
    [path, *_] = connect(url).coverage(**request).paths
    assert path.visits is not None
    for poses in (lambda: path.poses, path.to_nav_path, path.to_csv):
        with pytest.raises(ValueError, match="on a map with an origin"):
            poses()
