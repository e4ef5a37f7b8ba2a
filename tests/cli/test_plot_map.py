"""A map with tours of its front drawn into a file, the right way up."""

from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from paretour import coverage_plan
from paretour.values import parse_front

from service.cli.plot import draw_map, plot_map
from service.coverage.frame import MapFrame
from tests.helpers.answers import FRONT

BLOCKED = np.array([[1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 1, 1]], dtype=np.bool_)
CELLS = [[0, 1], [1, 1], [1, 0], [2, 0], [1, 1], [0, 1]]
MAP: dict[str, Any] = {
    **FRONT,
    "places": [[0, 1], [1, 0], [2, 0]],
    "front": [{**item, "path": {"cells": CELLS, "metres": 6.0}} for item in FRONT["front"]],
}


@pytest.mark.parametrize("yaw", [0.0, 0.4, 2.0, -1.3])
def test_cells_are_drawn_where_their_frame_has_them(yaw: float) -> None:
    frame = MapFrame(origin=(-3.0, 7.0, yaw), cell_size=0.5, rows=3)
    figure = Figure(figsize=(6, 6))
    canvas = FigureCanvasAgg(figure)
    panel = figure.add_subplot()
    draw_map(panel, BLOCKED, frame)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., 0]
    for cell in np.argwhere(np.ones_like(BLOCKED)):
        [point] = frame.points(cell[np.newaxis])
        column, row = panel.transData.transform(point).astype(int)
        assert (pixels[len(pixels) - 1 - row, column] < 128) == BLOCKED[tuple(cell)]


@pytest.mark.parametrize(
    "members", [{}, {"origin": [1.0, 2.0, 0.5]}], ids=["without a frame", "in a frame"]
)
def test_a_front_over_a_map_is_a_picture_of_three_panels(
    tmp_path: Path, members: dict[str, Any]
) -> None:
    request: Any = {"grid": BLOCKED.astype(int), "cell_size": 1.0, "spacing": 1.0, **members}
    plan = coverage_plan({**request, "cost_layer": np.ones((3, 4))}, None)
    path = tmp_path / "map.png"
    plot_map(parse_front(MAP), plan, path, {"a": 0, "b": 1})
    height, width, _ = matplotlib.image.imread(path).shape
    assert (height, width) == (750, 2250)
