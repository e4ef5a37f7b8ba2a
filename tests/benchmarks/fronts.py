"""`python -m tests.benchmarks fronts`: the fronts of one instance of 40 and one of 500 cities.

The paper's first instance of each size, and rows of its main table that take no longer than a few
minutes. Stores the points in `results/fronts.json`, row by row, and draws `results/fronts.png`.
"""

import argparse
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from service.instance import Instance, tour_lengths
from service.pareto import nondominated
from service.search.best_subset import best_subset
from service.search.front_points import FrontPoints
from service.search.improve import improve
from tests.benchmarks.instances import paper_instances
from tests.benchmarks.methods import methods
from tests.benchmarks.provenance import RESULTS, load, picture
from tests.benchmarks.rows import TOURS, Method, Points, resume

SIZES = (40, 500)
ROUNDS = 200_000  # of the search, some seconds at 500 cities
PARETOUR = "Paretour's search"
STYLES = {
    "NSGA-II (20K)": ("#8b5fbf", "."),
    "MOEA/D (20K)": ("#009e73", "."),
    "Greedy edge": ("0.5", "."),
    "DRL-MOA": ("#e69f00", "x"),
    "PA-EAN": ("#0072b2", "+"),
    "PA-AT": ("#56b4e9", "+"),
    "PA-One": ("black", "."),
    "OR-Tools (n_l = 10)": ("#d55e00", "."),
    PARETOUR: ("#c1272d", "."),
}


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks fronts", description=__doc__)
    parser.add_argument("--rows", nargs="+", choices=STYLES, help="names of rows; default: all")
    options = parser.parse_args(arguments)
    known = {**methods(), PARETOUR: Method(_searched)}
    for n in SIZES:
        instances = [Instance(coordinates=x) for x in paper_instances(n, 1)]
        for row in options.rows or STYLES:
            if row in known:
                find = partial(_points, known[row])
                resume("fronts", f"{n} {row}", known[row].digest, instances, find)
    draw(load("fronts"))


def _searched(instance: Instance) -> Points:
    nothing = np.empty((0, instance.n), np.int32)
    points = tour_lengths(instance, improve(instance, nothing, iterations=ROUNDS).tours)
    return points[best_subset(FrontPoints(points, np.full(2, float(instance.n))), TOURS)]


def _points(method: Method, instance: Instance) -> list[list[float]]:
    points = method.find(instance)
    front: list[list[float]] = points[nondominated(points)].round(4).tolist()
    return front


def draw(stored: dict[str, Any]) -> None:
    """The figure: one panel a size, the rows that are stored."""
    figure = Figure(figsize=(12, 6), layout="constrained")
    panels = figure.subplots(1, len(SIZES))
    for panel, n in zip(panels, SIZES, strict=True):
        _draw_panel(panel, n, stored)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=5, frameon=False)
    figure.savefig(picture(RESULTS / "fronts.png"), dpi=110)


def _draw_panel(panel: Axes, n: int, stored: dict[str, Any]) -> None:
    for row, (color, marker) in STYLES.items():
        if f"{n} {row}" in stored:
            [points] = stored[f"{n} {row}"]["instances"]
            panel.plot(*np.transpose(points), marker, color=color, ms=4, label=row)
    panel.set(title=f"{n} cities", xlabel="first length", ylabel="second length")
    panel.grid(color="0.9")
