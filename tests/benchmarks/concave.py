"""`python -m tests.benchmarks concave`: the concave front of the paper's appendix, by scipy.

The problem is that of Lin et al. (2019), Pareto multi-task learning: two exponentials of the
distance to (1, 1) / sqrt(2) and to its opposite. Twenty rays find points all along its concave
front, a hundred weighted sums only its two ends. A point is on its ray where the paper's
constraint, one minus a cosine, is at most nought; scipy is given the cross product instead, which
vanishes there too and, unlike the cosine, not with its gradient. The paper asks for x of at least
nought, where half of its rays meet no point at all: here x is free, as in the source.
Stores `results/concave.json` and draws `results/concave.png`.
"""

import argparse
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import NonlinearConstraint, minimize

from tests.benchmarks.provenance import RESULTS, picture, provenance, store

Array = NDArray[np.float64]

RAYS = 20
WEIGHTED_SUMS = 100
CENTRE = np.full(2, 1 / np.sqrt(2))
STARTS = 8
MET = 1e-6  # how far off its ray a point may be
APART = 0.01  # points closer than this count as one: right at its ends the front is convex


def main(arguments: list[str]) -> None:
    """The command line."""
    argparse.ArgumentParser("python -m tests.benchmarks concave", description=__doc__).parse_args(
        arguments
    )
    found, sums = along_rays(RAYS), by_weighted_sums(WEIGHTED_SUMS)
    results: dict[str, Any] = {
        **provenance(1),
        "rays": found.tolist(),
        "weighted_sums": sums.tolist(),
        "different": {"rays": different(found), "weighted_sums": different(sums)},
        "gap": {"rays": largest_gap(found), "weighted_sums": largest_gap(sums)},
    }
    store("concave", results)
    draw(found, sums)


def objectives(x: Array) -> Array:
    """The point of x: shape (2,) to (2,)."""
    return 1 - np.exp([-((x - CENTRE) ** 2).sum(), -((x + CENTRE) ** 2).sum()])


def along_rays(k: int) -> Array:
    """The shortest point on each of k rays, at the middles of k parts of (0, 90) degrees."""
    angles = (np.arange(k) + 0.5) / k * np.pi / 2
    return np.array([_on_ray(np.array([np.cos(a), np.sin(a)])) for a in angles])


def _on_ray(preference: Array) -> Array:
    def off(x: Array) -> float:
        first, second = objectives(x)
        return preference[0] * second - preference[1] * first

    def length(x: Array) -> float:
        return float(np.linalg.norm(objectives(x)))

    return _best(length, [NonlinearConstraint(off, 0, 0)], lambda x: abs(off(x)) <= MET)


def by_weighted_sums(k: int) -> Array:
    """The point of least weighted sum for each of k weights, both ends included."""
    points = []
    for first in np.linspace(0, 1, k):
        weights = np.array([first, 1 - first])
        points.append(_best(lambda x, w=weights: float(w @ objectives(x)), [], lambda _: True))
    return np.array(points)


def _best(
    objective: Callable[[Array], float],
    constraints: Sequence[NonlinearConstraint],
    allowed: Callable[[Array], bool],
) -> Array:
    """The best point of several local searches, each from a start of its own."""
    starts = np.random.default_rng(0).uniform(-1, 1, (STARTS, 2))
    ends = [
        minimize(objective, x, method="SLSQP", constraints=constraints, tol=1e-12).x for x in starts
    ]
    return objectives(min((x for x in ends if allowed(x)), key=objective))


def on_front(points: Array) -> Array:
    """How far each point lies above the front: that of x from one centre to the other."""
    along = np.linspace(-1, 1, 20001)
    front = 1 - np.exp([-((along - 1) ** 2), -((along + 1) ** 2)])
    return points[:, 1] - np.interp(points[:, 0], front[0][::-1], front[1][::-1])


def different(points: Array) -> int:
    """How many of the points are not one and the same."""
    kept: list[Array] = []
    for point in points:
        if all(np.linalg.norm(point - other) > APART for other in kept):
            kept.append(point)
    return len(kept)


def largest_gap(points: Array) -> float:
    """The largest distance between neighbours along the front."""
    ordered = points[points[:, 0].argsort()]
    return round(float(np.linalg.norm(np.diff(ordered, axis=0), axis=1).max()), 4)


def draw(found: Array, sums: Array) -> None:
    """The figure: what is possible, the points of the rays, those of the weighted sums."""
    x = np.random.default_rng(0).uniform(-1.5, 1.5, (6000, 2))
    possible = np.array([objectives(each) for each in x])
    figure = Figure(figsize=(5.5, 5), layout="constrained")
    panel = figure.subplots()
    panel.plot(*possible.T, ".", color="0.85", ms=2, label="possible points")
    panel.plot(*found.T, "o", color="#c1272d", ms=6, label=f"{len(found)} rays")
    panel.plot(*sums.T, "s", color="#009e73", ms=9, label=f"{len(sums)} weighted sums")
    panel.set(xlabel="$f_1$", ylabel="$f_2$", xlim=(-0.03, 1.03), ylim=(-0.03, 1.03))
    panel.legend(loc="lower left")
    figure.savefig(picture(RESULTS / "concave.png"), dpi=110)
