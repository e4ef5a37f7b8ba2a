"""First plans of a fleet: sequences of stops, cut into routes under all limits or weights.

For a sum against a maximum, each plan has the least sum under a limit just below the longest route
of the plan before (the epsilon-constraint method). For two sums, the plans are the best under the
weights of the edges of their hull (Aneja and Nair, 1979).
"""

from collections import deque
from collections.abc import Iterator
from math import inf

import numpy as np

from service.fleet.evaluation import plan_lengths
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan
from service.fleet.splitting.cutter import Cutter
from service.instance import OBJECTIVES

_FEWEST = 20  # the least number of limits or weights, even if cuts are slow
_STEEPEST = 1e3  # weight of one scaled objective if the other has weight 1
_LEAST_SCALE = 1e-290  # least scale relative to the other's: its weight must be finite
_ROUNDING = 1e-9  # relative, for a gain


def first_plans(fleet: Fleet, cutter: Cutter) -> Iterator[Plan]:
    """Yield the best cuts of a fleet's sequences; nothing if no cut keeps every rule."""
    maximum = fleet.rules.maximum
    if maximum is None:
        return _under_weights(fleet, cutter)
    return _under_limits(cutter, maximum)


def _under_limits(cutter: Cutter, maximum: int) -> Iterator[Plan]:
    """Yield the plan of the least sum under each limit, from no limit to the least possible one.

    If cuts are slow, limits are farther apart, so that there is time for all of them.
    """
    costs = cutter.costs(np.eye(OBJECTIVES)[1 - maximum], maximum)
    least = float(np.nextafter(cutter.least_limit(maximum), inf))
    limit, apart = inf, 0.0
    while cut := cutter.best(costs, limit):
        yield cut.plan
        if not cut.plan.routes:  # all stops are left out: no lower limit changes this plan
            return
        if limit == inf:
            apart = (cut.longest - least) / max(_FEWEST, cutter.affordable)
        limit = min(cut.longest, max(limit - apart, least))


def _under_weights(fleet: Fleet, cutter: Cutter) -> Iterator[Plan]:
    """Yield the plans at both ends, and then those on the hull between them."""
    scale = fleet.largest_legs
    scale = np.maximum(scale / (scale.max() or 1.0), _LEAST_SCALE)
    steepest = np.array([[_STEEPEST, 1.0], [1.0, _STEEPEST]]) / scale
    ends = [cut.plan for weights in steepest if (cut := cutter.best(cutter.costs(weights)))]
    yield from ends
    edges = deque([tuple(ends)] if len(ends) == OBJECTIVES else [])
    left = max(_FEWEST, cutter.affordable)
    while edges and left:
        left -= 1
        a, b = edges.popleft()
        lengths = np.array([plan_lengths(fleet, a), plan_lengths(fleet, b)])
        weights = np.array([lengths[0, 1] - lengths[1, 1], lengths[1, 0] - lengths[0, 0]])
        cut = cutter.best(cutter.costs(weights)) if (weights > 0).all() else None
        if cut is None:
            continue
        if weights @ plan_lengths(fleet, cut.plan) < (1 - _ROUNDING) * (weights @ lengths[0]):
            yield cut.plan
            edges += [(a, cut.plan), (cut.plan, b)]
