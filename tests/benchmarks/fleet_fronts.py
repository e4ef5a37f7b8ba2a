"""Fronts of fleets: how long they take, whether their plans keep the rules, and their shares."""

import time
from collections.abc import Callable, Sequence

import numpy as np

from service.fleet.evaluation import points_of, violations
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan
from service.pareto import hypervolume, nondominated
from tests.benchmarks.rows import Points


def timed_front(find: Callable[[], Sequence[Plan]], fleet: Fleet) -> tuple[float, Points]:
    """Return how many seconds a method took, and the nondominated points of its plans."""
    began = time.perf_counter()
    plans = find()
    spent = time.perf_counter() - began
    check_plans(fleet, plans)
    points = points_of(fleet, plans)
    return round(spent, 3), np.unique(points[nondominated(points)], axis=0)


def check_plans(fleet: Fleet, plans: Sequence[Plan]) -> None:
    """Raise RuntimeError if a plan breaks a rule of its fleet."""
    if broken := [each for plan in plans for each in violations(fleet, plan)]:
        raise RuntimeError(f"a plan breaks a rule: {broken[0]}")


def share_of_box(points: Points, box: Points) -> float:
    """Return the hypervolume of points in the smallest box that holds those of `box`."""
    least, most = box.min(axis=0), box.max(axis=0)
    extent = np.where(most > least, most - least, 1.0)
    return hypervolume((points - least) / extent, np.full(box.shape[1], 1.0 + 1e-9))
