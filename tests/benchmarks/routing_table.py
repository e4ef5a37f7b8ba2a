"""What is stored of distance against vehicles beside solvers, as a table."""

import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from tests.benchmarks.cells import of
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load

OURS, PYVRP, VROOM, OR_TOOLS = "paretour, one front", "PyVRP alone", "VROOM", "OR-Tools"
METHODS = (OURS, PYVRP, VROOM, OR_TOOLS)
SETS = {  # by the names of their files
    "Solomon, 100": r"R?C?\d{3}",
    "Gehring and Homberger, 200": r"R?C?\d_2_\d+",
    "Li and Lim, 100": r"LR?C?\d{3}",
    "CVRPLIB X, 100 to 302": r"X-.*",
}
Entries = dict[str, dict[str, Any]]  # by method


def section() -> str:
    """The section of the page of results; nothing before the first run."""
    if not load("routing"):
        return ""
    return (
        "\n## Fleets beside solvers\n\nNot in the paper: `python -m tests.benchmarks routing`. In "
        "ten seconds on one core we plan one front of distance\nagainst vehicles; each rival plans "
        "twice, ten seconds for either end. The columns are means over the instances of a\nset: "
        "the vehicles of the plan with the fewest and its distance, and by how much the least "
        f"distance exceeds that of the\nbest of all methods.\n\n{routing_table()}"
    )


def routing_table() -> str:
    """A row for each set and method, over the instances that all methods were measured on."""
    rows = []
    for name, pattern in SETS.items():
        instances = list(_measured(pattern))
        if not instances:
            continue
        least = [min(_ends(entry)[2] for entry in each.values()) for each in instances]
        for method in METHODS:
            ends = np.array([_ends(each[method]) for each in instances])
            seconds = np.mean([each[method]["seconds"] for each in instances])
            excess = 100 * (ends[:, 2] / least - 1)
            failed = int(np.isinf(ends[:, 2]).sum())
            fewest, distance, _ = ends.mean(axis=0)
            cells = [f"{fewest:.2f}", f"{distance:.1f}", f"{excess.mean():+.2f} %"]
            if failed:
                cells = ["", "", f"no plan for {failed}"]
            rows.append([f"{name} ({len(instances)})", method, *cells, f"{seconds:.1f} s"])
    titles = ["set (instances)", "", "fewest vehicles", "their distance", "least distance", "in"]
    return table(titles, rows)


def _measured(pattern: str) -> Iterator[Entries]:
    """Yield the entries of each instance of a set that all methods were measured on."""
    stored = load("routing")
    names = dict.fromkeys(key.partition(", ")[0] for key in stored)
    for name in names:
        if re.fullmatch(pattern, name):
            entries = {method: of(stored.get(f"{name}, {method}")) for method in METHODS}
            if all(entries.values()):
                yield {method: each[0] for method, each in entries.items()}


def _ends(entry: dict[str, Any]) -> tuple[float, float, float]:
    """Return the fewest vehicles, their distance, and the least distance; inf without a plan."""
    points = entry["points"]
    if not points:
        return np.inf, np.inf, np.inf
    distance, vehicles = min(points, key=lambda point: (point[1], point[0]))
    return vehicles, distance, min(point[0] for point in points)
