"""A picture of two tours of a front on one map: the shortest, and one of little risk."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, ListedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy import ndimage

from models.data.generators import drawn_map
from service.coverage.grid import covering_places, free_cells, largest_region
from service.coverage.survey import Coverage, Survey, survey
from service.search.improve import improve
from tests.benchmarks.provenance import PICTURES, picture

Array = NDArray[np.float64]

SEED = 1
SIDE = 64
SPACING = 10.0
RADIUS = 1.0
OFFSET = 0.3  # cells, by which a path keeps to the right
RISKY = 7  # places around which it is risky
SPREAD = 5.0  # cells, how far around
SAFE = 1.5  # of 10
LITTLE = 0.06  # of the span of risks on the front, above the least
WALL, PATH, PLACE, START = "#3d3d3d", "#1f4e9c", "#c1272d", "#1a9850"
RISK = LinearSegmentedColormap.from_list("risk", ["#ffffff", "#fdd49e", "#f5884a"])


def draw() -> None:
    """Draws `service/guide/pictures/coverage.png`."""
    rng = np.random.default_rng(SEED)
    free = drawn_map(rng, "blocks", SIDE)
    risk = _risk(rng)
    found = survey(_coverage(free, risk), 1000, lambda: False)
    front = improve(found.instance, np.empty((0, found.instance.n), np.int32), iterations=100_000)
    figure = Figure(figsize=(15, 5.4), layout="constrained")
    panels = figure.subplots(1, 3, width_ratios=(1, 1, 0.8))
    risks = front.points[:, 1]
    little = int(np.argmax(risks <= risks.min() + LITTLE * np.ptp(risks)))
    marked = {"A": 0, "B": little}
    for panel, (name, index) in zip(panels, marked.items(), strict=False):
        _draw_map(panel, free, risk)
        _draw_tour(panel, found, front.tours[index])
        length, cost = front.points[index]
        panel.set_title(f"{name}: {length:.0f} m, risk {cost:.0f}")
    _draw_front(panels[2], front.points, marked)
    figure.savefig(picture(PICTURES / "coverage.png"), dpi=130)


def _coverage(free: NDArray[np.bool_], risk: Array) -> Coverage:
    """Places all over the map where it is safe."""
    region = largest_region(free_cells(~free, 1.0, RADIUS))
    places = covering_places(region, SPACING)
    safe = places[risk[tuple(places.T)] < SAFE]
    return Coverage(
        blocked=~free, cell_size=1.0, robot_radius=RADIUS, places=safe, cost_layers=risk[np.newaxis]
    )


def _risk(rng: np.random.Generator) -> Array:
    """A layer between 0 and 10 that is high around a few places."""
    layer = np.zeros((SIDE, SIDE))
    layer[tuple(rng.integers(SIDE, size=(2, RISKY)))] = 1.0
    layer = ndimage.gaussian_filter(layer, SPREAD)
    return 10 * layer / layer.max()


def _draw_map(panel: Axes, free: NDArray[np.bool_], risk: Array) -> None:
    panel.imshow(risk, cmap=RISK)
    walls = np.ma.masked_where(free, np.ones(free.shape))
    panel.imshow(walls, cmap=ListedColormap([WALL]))
    panel.set_xticks([])
    panel.set_yticks([])
    panel.set_xlabel("orange: risk; black: obstacles; red: places to visit; green: the start")


def _draw_tour(panel: Axes, found: Survey, tour: NDArray[np.integer]) -> None:
    # Both tours begin at the same place.
    tour = np.roll(tour, -np.flatnonzero(tour == 0)[0])
    [path] = found.paths(tour[np.newaxis])
    rows, columns = _beside(path.cells).T
    panel.plot(columns, rows, color=PATH, lw=1.6)
    for at in range(4, len(path.cells) - 1, 9):
        panel.annotate(
            "",
            (columns[at + 1], rows[at + 1]),
            (columns[at], rows[at]),
            arrowprops={"arrowstyle": "-|>", "color": PATH, "lw": 0, "mutation_scale": 12},
        )
    panel.plot(*found.places.T[::-1], "o", color=PLACE, ms=5)
    panel.plot(*found.places[tour[0]][::-1], "o", color=START, ms=10, mec="white")


def _beside(cells: NDArray[np.int64]) -> Array:
    """A way a little to the right of its direction, so that there and back are told apart."""
    steps = np.diff(cells, axis=0).astype(np.float64)
    ahead = ndimage.uniform_filter1d(np.concatenate((steps, steps[-1:])), 3, axis=0)
    length = np.maximum(np.hypot(*ahead.T), 1e-9)[:, np.newaxis]
    return cells + OFFSET * np.stack((ahead[:, 1], -ahead[:, 0]), axis=1) / length


def _draw_front(panel: Axes, points: Array, marked: dict[str, int]) -> None:
    panel.plot(*points.T, ".", color=PATH, ms=5)
    for name, index in marked.items():
        panel.plot(*points[index], "o", color=PLACE, ms=8)
        panel.annotate(name, points[index], xytext=(8, 6), textcoords="offset points", fontsize=13)
    panel.set_xlabel("length, m")
    panel.set_ylabel("risk along the path")
    panel.set_title(f"the front: {len(points)} tours")
    panel.margins(0.1)
    panel.grid(color="0.9")
