"""Add a plan to a front that changes little of the plan that is driven."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from service.fleet.evaluation import points_of
from service.fleet.fleet import Array
from service.fleet.plans import FleetFront, Plan, kept_share

KEPT = 0.9  # share of the stops of a driven plan that a plan keeps which keeps most of it
_LONGER = 0.05  # by how much each length of such a plan may exceed that of a plan of the front


def with_kept(
    front: FleetFront,
    driven: Plan,
    size: int,
    kept: tuple[Array, Sequence[Plan]],
    points: Array,
) -> FleetFront:
    """Return a front with a plan that keeps most of a driven plan, if such a plan is short.

    If the front is full, this plan takes the place of the plan nearest to it.

    Args:
        front: The front.
        driven: The plan that is driven.
        size: The most plans of the front.
        kept: The points of plans that keep most of it, shape (k, m), and these plans.
        points: The points of all plans that were found, in the same units, shape (l, m).
    """
    if any(kept_share(driven, each) >= KEPT for each in front.plans):
        return front
    kept_points, kept_plans = kept
    nearest = _least_longer(kept_points, points)
    if nearest is None:
        return front
    plan = kept_plans[nearest]
    point, plans, points = points_of(front.fleet, [plan]), list(front.plans), front.points
    if len(plans) == size:
        place = int((np.abs(points - point) / front.scale).sum(axis=1).argmin())
        del plans[place]
        points = np.delete(points, place, axis=0)
    place = int(np.searchsorted(points[:, 0], point[0, 0]))
    plans.insert(place, plan)
    return replace(front, plans=plans, points=np.insert(points, place, point, axis=0))


def _least_longer(kept: Array, points: Array) -> int | None:
    """Return which of the kept plans is the least longer than a front; None if all are much longer.

    Args:
        kept: Their lengths, shape (k, m).
        points: The lengths of the plans of the front, shape (l, m).
    """
    if not len(kept):
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        grown = kept[:, np.newaxis] / points - 1
    # Where a point of the front is 0 and the plan's length too, nothing has grown.
    excess = np.nan_to_num(grown, posinf=np.inf).max(axis=2).min(axis=1)
    best = int(excess.argmin())
    return best if excess[best] <= _LONGER else None
