"""The values of a day: costs of legs, service at stops, and when tours may begin."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from service.day.costs import CostsOfDay
from service.instance import CLOSED, Instance, RouteEnds

Array = NDArray[np.float64]
MOST_ASYMMETRY = 0.2  # of mean costs: by which share of themselves they may differ by direction


@dataclass(frozen=True, eq=False)
class Day:
    """What tours need to know of a day.

    Args:
        costs: The costs under each of m objectives.
        clock: The index of the objective whose costs are seconds of travel.
        service: The seconds of a visit to each stop, shape (n,).
        earliest: When a tour may begin at the earliest, in seconds of the day.
        latest: When it may begin at the latest.
        ends: Whether tours are closed, and the fixed ends of open routes.
    """

    costs: Sequence[CostsOfDay]
    clock: int
    service: Array
    earliest: float
    latest: float
    ends: RouteEnds = CLOSED

    @cached_property
    def instance(self) -> Instance:
        """The stops under mean costs.

        Raises:
            InvalidInstance: The costs are too large, or too far apart, to be planned.
        """
        return Instance(matrices=self.mean_matrices, **self.ends._asdict())

    @cached_property
    def mean_matrices(self) -> Array:
        """The mean costs over the hours that tours take, shape (m, n, n).

        Where they differ little by direction, they are those of both directions together: under
        symmetric costs the search finds better tours, and their direction is chosen afterwards.
        """
        ends = self.latest + self._typical_duration()
        means = np.stack([each.mean(self.earliest, ends) for each in self.costs])
        around = means.transpose(0, 2, 1)
        finite = np.isfinite(means)
        if not np.array_equal(finite, finite.transpose(0, 2, 1)):
            return means
        apart = np.abs(np.subtract(means, around, where=finite, out=np.zeros_like(means))).sum()
        differ = apart > MOST_ASYMMETRY * means.sum(where=finite)
        return means if differ else (means + around) / 2

    def _typical_duration(self) -> float:
        """Return the seconds that a tour by nearest neighbours takes, under mean costs. O(n^2)."""
        travel = self.costs[self.clock]
        matrix = travel.mean(float(travel.begins[0]), float(travel.begins[-1]))
        left = np.ones(len(matrix), np.bool_)
        stop, seconds = 0, float(self.service.sum())
        for _ in range(len(matrix) - 1):
            left[stop] = False
            steps = np.where(left, matrix[stop], np.inf)
            following = int(steps.argmin())
            if np.isinf(steps[following]):  # all legs to the stops left are forbidden
                following = int(left.argmax())
            else:
                seconds += float(steps[following])
            stop = following
        return seconds
