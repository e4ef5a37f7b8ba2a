"""Work out when the visit of a stop begins."""

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.problem import Problem
from service.jit import inlined

_is_over = inlined(is_over)


@inlined
def begin_at(problem: Problem, stop: int, arrival: float) -> float:
    """Return when a visit begins, in the first window that is not over; infinite after all."""
    for number in range(problem.windows.shape[1]):
        if not _is_over(arrival, problem.windows[stop, number, 1]):
            return max(arrival, problem.windows[stop, number, 0])
    return np.inf
