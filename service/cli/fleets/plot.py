"""Draw a map with plans of several robots on it, and their front, with matplotlib."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import AbstractPathEffect, Normal, Stroke
from paretour import Plan, RobotFront, RobotPlan

from service.cli.labels import labels_of, lengths_as_text
from service.cli.plot_map import draw_front, draw_map, map_of, panels
from service.coverage.frame import MapFrame

# The colours of Okabe and Ito (2008), which colour-blind people can tell apart; as on the page.
_COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#1b2430", "#f0e442")
_DASHES = ("-", (0, (6, 3)), (0, (2, 3)))
_CASING: list[AbstractPathEffect] = [Stroke(linewidth=3, foreground="#1b2430"), Normal()]
_MOST_NAMED = 8  # robots: a longer list of names has no room beside the map


def plot_robots(front: RobotFront, plan: Plan, path: Path, choices: Mapping[str, int]) -> None:
    """Draw some plans of a front over its map, and the lengths of all, into a file.

    Args:
        front: A front whose routes have paths.
        plan: The request whose answer the front is.
        path: The file to draw into.
        choices: The indexes of the plans to draw, by their titles.
    """
    blocked, frame = map_of(plan)
    ids = [robot["id"] for robot in plan.request["robots"]]
    figure, maps, chart = panels(len(choices))
    for panel, (title, index) in zip(maps, choices.items(), strict=True):
        draw_map(panel, blocked, frame)
        panel.plot(*frame.points(front.places).T, "o", color=_COLOURS[6], markersize=2, zorder=3)
        _draw_routes(panel, front.plans[index], frame, ids)
        first, second = front.lengths[index].tolist()
        panel.set_title(f"{title}\n{lengths_as_text(front, (first, second))}", fontsize=9)
    draw_front(chart, front.lengths, labels_of(front))
    chart.set_title(f"{len(front.plans)} plans, hypervolume {front.hypervolume:.2%}")
    figure.savefig(path, dpi=150)


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
        panel.plot(*points[0], "o", color=colour, markeredgecolor=_COLOURS[6], markersize=8)
        names.append(f"{route.path.metres:.6g} m, {route.robot}")
    if len(lines) <= _MOST_NAMED:
        legend = panel.legend(lines, names, loc="upper center", bbox_to_anchor=(0.5, -0.15))
        for text in legend.get_texts():
            text.set_parse_math(False)  # an id may have a dollar sign in it
