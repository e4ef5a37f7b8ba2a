"""Draw a front, and its tours or plans on a map, with matplotlib of the extra `plot`."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import AbstractPathEffect, Normal, Stroke
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray
from paretour import Front, FrontOfAnyKind, Plan, RobotFront, RobotPlan

from service.cli.errors import UsageError
from service.cli.output import labels_of, lengths_as_text
from service.coverage.frame import MapFrame

_WALL, _PATH, _PLACE, _START = "#3d3d3d", "#1f4e9c", "#c1272d", "#1a9850"
# The colours of Okabe and Ito (2008), which colour-blind people can tell apart; as on the page.
_COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#1b2430", "#f0e442")
_DASHES = ("-", (0, (6, 3)), (0, (2, 3)))
_DARK = _COLOURS[6]
_CASING: list[AbstractPathEffect] = [Stroke(linewidth=3, foreground=_DARK), Normal()]
_MOST_NAMED = 8  # robots: a longer list of names has no room beside the map
_MARGIN = 4  # cells drawn around the free ones
_NO_LIMIT = 2**62  # the request was planned already, within the limits


def check_path(path: Path) -> None:
    """Raise UsageError if a file's suffix is not that of a picture, or its directory is missing."""
    formats = sorted(FigureCanvasBase.get_supported_filetypes())
    if path.suffix.removeprefix(".") not in formats:
        raise UsageError(f"--plot must end in one of {', '.join(formats)}, got {path}")
    if path.exists() and not path.is_file():  # writing into a pipe could wait forever
        raise UsageError(f"--plot must be a file, got {path}")
    if not path.parent.is_dir():
        raise UsageError(f"--plot must be in a directory that exists, got {path}")


def plot_front(front: FrontOfAnyKind, path: Path, noun: str = "tours") -> None:
    """Draw the lengths of a front into a file, the first to the right and the second up."""
    figure = Figure(figsize=(6, 4.5), layout="constrained")
    _draw_lengths(figure.add_subplot(), front, labels_of(front), noun)
    figure.savefig(path, dpi=150)


def plot_map(front: Front | RobotFront, plan: Plan, path: Path, choices: Mapping[str, int]) -> None:
    """Draw some tours or plans of a front over its map, and the lengths of all, into a file.

    Args:
        front: A front with paths.
        plan: The request whose answer the front is.
        path: The file to draw into.
        choices: The indexes of the tours or plans to draw, by their titles.
    """
    blocked, frame = _map_of(plan)
    figure = Figure(figsize=(5 * len(choices) + 5, 5), layout="constrained")
    *panels, chart = figure.subplots(1, len(choices) + 1)
    for panel, (title, index) in zip(panels, choices.items(), strict=True):
        draw_map(panel, blocked, frame)
        if isinstance(front, Front):
            first, second = front.lengths[index]
            _draw_tour(panel, front, index, frame)
            panel.set_title(f"{title}\n{first:.6g} m, second length {second:.6g}")
        else:
            panel.plot(*frame.points(front.places).T, "o", color=_DARK, markersize=2, zorder=3)
            ids = [robot["id"] for robot in plan.request["robots"]]
            _draw_routes(panel, front.plans[index], frame, ids)
            panel.set_title(f"{title}\n{lengths_as_text(front, front.lengths[index])}", fontsize=9)
    if isinstance(front, Front):
        _draw_lengths(chart, front, ("first length, m", "second length"), "tours")
    else:
        _draw_lengths(chart, front, labels_of(front), "plans")
    figure.savefig(path, dpi=150)


def _map_of(plan: Plan) -> tuple[NDArray[np.bool_], MapFrame]:
    """Return the blocked cells of the map of a plan, and the frame of the map.

    A map without a frame gets one with its origin at the lower left corner.
    """
    from service.requests.coverage import parse_coverage_request
    from service.requests.limits import Limits

    limits = Limits(
        body_bytes=_NO_LIMIT,
        cities=_NO_LIMIT,
        cells=_NO_LIMIT,
        preferences=_NO_LIMIT,
        size=_NO_LIMIT,
        seconds=_NO_LIMIT,
    )
    picture = None if plan.file is None else plan.file.content
    coverage = parse_coverage_request(plan.json, limits, picture).coverage()
    blocked = coverage.blocked
    own = MapFrame(origin=(0, 0, 0), cell_size=coverage.cell_size, rows=len(blocked))
    return blocked, coverage.frame or own


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


def _draw_routes(panel: Axes, plan: RobotPlan, frame: MapFrame, ids: Sequence[str]) -> None:
    """Draw the path of each robot, in its colour, from the disc where it starts."""
    lines: list[Line2D] = []
    names = []
    for route in plan.routes:
        assert route.path is not None
        at = ids.index(route.robot)
        colour, dash = _COLOURS[at % len(_COLOURS)], _DASHES[at // len(_COLOURS) % len(_DASHES)]
        points = frame.points(route.path.cells)
        lines += panel.plot(*points.T, color=colour, linestyle=dash, linewidth=1.8)
        lines[-1].set_path_effects(_CASING)
        panel.plot(*points[0], "o", color=colour, markeredgecolor=_DARK, markersize=8)
        names.append(f"{route.path.metres:.6g} m, {route.robot}")
    if len(lines) <= _MOST_NAMED:
        legend = panel.legend(lines, names, loc="upper center", bbox_to_anchor=(0.5, -0.15))
        for text in legend.get_texts():
            text.set_parse_math(False)  # an id may have a dollar sign in it


def _draw_lengths(chart: Axes, front: FrontOfAnyKind, labels: Sequence[str], noun: str) -> None:
    """Draw the lengths of all tours or plans, with the labels of both lengths."""
    first, second = front.lengths.T
    chart.step(first, second, where="post", color="0.8", linewidth=1)
    chart.scatter(first, second, s=14)
    for label, text in zip((chart.xaxis.label, chart.yaxis.label), labels, strict=True):
        label.set(text=text, parse_math=False)  # a name may have a dollar sign in it
    chart.set_title(f"{len(front.lengths)} {noun}, hypervolume {front.hypervolume:.2%}")
    chart.spines[["top", "right"]].set_visible(False)
