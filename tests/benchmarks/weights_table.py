"""The table of the benchmark `weights`, made of what it stored; needs no OR-Tools."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.pareto import hypervolume, nondominated
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load

Array = NDArray[np.float64]

BUDGETS = (2, 5, 10)  # more seconds of driving than the quickest tour, in per cent
MARGIN = 0.1  # by which the reference point lies beyond the front, as a share of its extent


def weights_table() -> str:
    """Return what is stored as Markdown: a row for each method, and where it was measured."""
    stored = load("weights")
    if not stored:
        return "Not measured.\n"
    best = _together(stored)
    rows = [_row(key, entry, best) for key, entry in stored.items()]
    within = [f"people passed, at most {budget} % longer" for budget in BUDGETS]
    head = ["limit", "method", "seconds taken", "tours", "hypervolume", *within]
    under_weights = (
        f"The best front, of all tours that any method found, has {len(best)} tours. "
        f"{_supported(best)} of them are best under some weight.\n"
    )
    return f"{table(head, rows)}\n{under_weights}\n{_measured_on(stored)}"


def _row(key: str, entry: dict[str, Any], best: Array) -> list[str]:
    """The median of the rounds, figure by figure."""
    limit, _, name = key.partition(": ")
    figures = [_figures(result, best) for result in entry["instances"]]
    seconds, tours, share, *people = np.median(figures, axis=0)
    budgets = ["none" if np.isinf(most) else f"{most:.0f}" for most in people]
    return [limit, name, f"{seconds:.1f}", f"{tours:.0f}", f"{100 * share:.1f} %", *budgets]


def _measured_on(stored: dict[str, Any]) -> str:
    """A sentence on the rounds, processors, dates, commits and load of what is stored."""
    places = {f"{each['cpu']}, {each['date']}, `{each['commit']}`" for each in stored.values()}
    busy = max(each["busy"] for each in stored.values())
    rounds = min(len(each["instances"]) for each in stored.values())
    return (
        f"Each figure is the median of {rounds} rounds. Measured on {'; '.join(sorted(places))}, "
        f"one thread.\nAt most {busy:g} programs for each core were running.\n"
    )


def _figures(result: dict[str, Any], best: Array) -> list[float]:
    """Seconds, tours, the share of the best front's hypervolume, and people in each budget."""
    points = np.array(result["points"])
    share = _in_box(points, best) / _in_box(best, best)
    quickest = best[:, 0].min()
    people = [_least(points, quickest * (1 + budget / 100)) for budget in BUDGETS]
    return [result["seconds"], len(points), share, *people]


def _together(stored: dict[str, Any]) -> Array:
    """The front of everything that any method has found, shape (m, 2)."""
    results = [result for entry in stored.values() for result in entry["instances"]]
    points = np.concatenate([result["points"] for result in results])
    return points[nondominated(points)]


def _supported(front: Array) -> int:
    """How many points of a front, by ascending first length, are best under some weights.

    Those are the corners of its lower convex hull, by Andrew's monotone chain.
    """
    corners: list[Array] = []
    for point in front[front[:, 0].argsort()]:
        while len(corners) > 1 and _dented(*corners[-2:], point):
            corners.pop()
        corners.append(point)
    return len(corners)


def _dented(before: Array, point: Array, after: Array) -> bool:
    """Whether a point lies on or above the line from the one before it to the one after it."""
    (x, y), (across, down) = point - before, after - before
    return bool(x * down <= across * y)


def _in_box(points: Array, best: Array) -> float:
    """The hypervolume in the box of the best front, which is widened by the margin."""
    least, most = best.min(axis=0), best.max(axis=0)
    return hypervolume((points - least) / (most - least), np.full(2, 1 + MARGIN))


def _least(points: Array, most: float) -> float:
    """The least second length within a budget of the first; infinite where none is."""
    within = points[points[:, 0] <= most, 1]
    return float(within.min()) if len(within) else np.inf
