"""The costs between the places of a map over the day."""

import numpy as np
from numpy.typing import NDArray

from service.coverage.coverage import RobotHours
from service.day.costs import CostsOfDay
from service.instance import Instance, RouteEnds
from service.over_the_day.day import Day

Array = NDArray[np.float64]


def day_on_map(hours: RobotHours | None, instance: Instance) -> Day | None:
    """Return the day of one robot on a map whose costs are these; None if it has no hours."""
    if hours is None:
        return None
    assert instance.matrices is not None
    return Day(
        costs=costs_of_day(hours, instance.matrices),
        clock=0,
        service=np.zeros(instance.n),
        earliest=hours.earliest,
        latest=hours.latest,
        ends=RouteEnds(instance.closed, instance.start, instance.end),
    )


def costs_of_day(hours: RobotHours, matrices: Array) -> list[CostsOfDay]:
    """Return the costs over the day from metres and other costs, shape (m, n, n).

    The first ones are the seconds that the robot takes. There are as many as have factors.
    """
    seconds = matrices[0] / hours.speed
    return [
        _with_factors(factors, costs)
        for factors, costs in zip(hours.factors, (seconds, *matrices[1:]), strict=False)
    ]


def _with_factors(factors: tuple[tuple[float, float], ...], matrix: Array) -> CostsOfDay:
    if not factors:
        return CostsOfDay.constant(matrix)
    begins, values = np.array(factors, np.float64).T
    layers = np.zeros(len(begins), np.int64)
    return CostsOfDay(begins, values, layers, matrix[np.newaxis])
