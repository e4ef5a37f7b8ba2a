"""Draw a map with tours of a front on it, and the front, with matplotlib."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray
from paretour import Front, Plan

from service.coverage.coverage import Coverage
from service.coverage.frame import MapFrame
from service.requests.coverage import parse_coverage_request
from service.requests.limits import Limits

Array = NDArray[np.float64]

_WALL, _PATH, _PLACE, _START = "#3d3d3d", "#1f4e9c", "#c1272d", "#1a9850"
_MARGIN = 4  # cells drawn around the free ones
_NO_LIMIT = 2**62  # the request was planned already, within the limits
_LIMITS = Limits(
    body_bytes=_NO_LIMIT,
    cities=_NO_LIMIT,
    cells=_NO_LIMIT,
    preferences=_NO_LIMIT,
    size=_NO_LIMIT,
    seconds=_NO_LIMIT,
)


def plot_map(front: Front, plan: Plan, path: Path, choices: Mapping[str, int]) -> None:
    """Draw some tours of a front over the map of its plan, and the lengths of all, into a file.

    Args:
        front: A front with paths.
        plan: The request whose answer the front is.
        path: The file to draw into.
        choices: The indexes of the tours to draw, by their titles.
    """
    blocked, frame = map_of(plan)
    figure, maps, chart = panels(len(choices))
    for panel, (title, index) in zip(maps, choices.items(), strict=True):
        draw_map(panel, blocked, frame)
        _draw_tour(panel, front, index, frame)
        first, second = front.lengths[index]
        panel.set_title(f"{title}\n{first:.6g} m, second length {second:.6g}")
    draw_front(chart, front.lengths, ("first length, m", "second length"))
    chart.set_title(f"{len(front.tours)} tours, hypervolume {front.hypervolume:.2%}")
    figure.savefig(path, dpi=150)


def panels(maps: int) -> tuple[Figure, Sequence[Axes], Axes]:
    """Return a figure with a panel for each map, and one for the front on their right."""
    figure = Figure(figsize=(5 * maps + 5, 5), layout="constrained")
    *for_maps, chart = figure.subplots(1, maps + 1)
    return figure, for_maps, chart


def map_of(plan: Plan) -> tuple[NDArray[np.bool_], MapFrame]:
    """Return the blocked cells of the map of a plan, and the frame of the map."""
    picture = None if plan.file is None else plan.file.content
    coverage: Coverage = parse_coverage_request(plan.json, _LIMITS, picture).coverage()
    return coverage.blocked, coverage.frame or _own_frame(coverage)


def _own_frame(coverage: Coverage) -> MapFrame:
    """Return a frame with its origin at the lower left corner, for a map without a frame."""
    return MapFrame(origin=(0, 0, 0), cell_size=coverage.cell_size, rows=len(coverage.blocked))


def draw_map(panel: Axes, blocked: NDArray[np.bool_], frame: MapFrame) -> None:
    """Draw the blocked cells of a map, and leave out its rim without free cells."""
    height, width = (side * frame.cell_size for side in blocked.shape)
    x, y, yaw = frame.origin
    to_frame = Affine2D().rotate(yaw).translate(x, y)
    image = panel.imshow(blocked, cmap=ListedColormap(["white", _WALL]), vmin=0, vmax=1)
    image.set_extent((0, width, 0, height))
    image.set_transform(to_frame + panel.transData)
    # Robots save large maps, but know only a small part of them.
    free = frame.points(np.argwhere(~blocked))
    margin = _MARGIN * frame.cell_size
    (left, bottom), (right, top) = free.min(axis=0) - margin, free.max(axis=0) + margin
    panel.set(xlim=(left, right), ylim=(bottom, top), aspect="equal", xlabel="x, m", ylabel="y, m")


def _draw_tour(panel: Axes, front: Front, index: int, frame: MapFrame) -> None:
    assert front.paths is not None
    assert front.places is not None
    places = frame.points(front.places)
    panel.plot(*frame.points(front.paths[index].cells).T, color=_PATH, linewidth=1.2)
    panel.plot(*places.T, "o", color=_PLACE, markersize=3)
    panel.plot(*places[front.tours[index, 0]], "o", color=_START, markersize=7)


def draw_front(chart: Axes, lengths: Array, labels: Sequence[str]) -> None:
    """Draw the lengths of all tours or plans, shape (m, 2), with the labels of both lengths."""
    first, second = lengths.T
    chart.step(first, second, where="post", color="0.8", linewidth=1)
    chart.scatter(first, second, s=14)
    chart.set(xlabel=labels[0], ylabel=labels[1])
    chart.spines[["top", "right"]].set_visible(False)
