"""Tours by the mean and by what nine days of ten do not exceed, against days that are drawn."""

from functools import partial
from itertools import permutations

import numpy as np
import pytest

from service.front import Front, PlanOptions
from service.instance import Instance, RouteEnds
from service.pareto import nondominated
from service.planner import plan
from service.reliability.plan import plan_reliably
from service.reliability.spread import Spread, lengths_at
from service.watch import Watch
from tests.helpers.actors import Shuffler

DAYS = 10_000
RNG = np.random.default_rng(61)
N = 6
MEANS = RNG.uniform(5, 30, (2, N, N))
DRAWN = RNG.uniform(0.5, 1.0, (20, 1, 1)) * RNG.uniform(5, 60, (20, N, N))
SPREADS = {
    "a share of the mean": Spread(factor=0.4, percent=90),
    "deviations": Spread(deviations=RNG.uniform(0, 20, (N, N)), percent=75),
    "days": Spread(days=DRAWN, percent=90),
}


def drawn(spread: Spread, means: np.ndarray, days: int) -> np.ndarray:
    """Return the costs of some days, shape (d, n, n), drawn or as they are given."""
    if spread.days is not None:
        return spread.days
    deviations = spread.factor * means if spread.deviations is None else spread.deviations
    return np.random.default_rng(1).normal(means, deviations, (days, *means.shape))


def simulated(costs: np.ndarray, tour: tuple[int, ...]) -> np.ndarray:
    """Return the length of a closed tour on each day."""
    lengths = np.zeros(len(costs))
    for i, city in enumerate(tour):
        lengths += costs[:, city, tour[(i + 1) % len(tour)]]
    return lengths


@pytest.mark.parametrize("kind", ["a share of the mean", "deviations"])
def test_nine_of_ten_drawn_days_are_within_the_percentile(kind: str) -> None:
    spread = SPREADS[kind]
    costs = drawn(spread, MEANS[0], DAYS)
    tours = np.array([[0, 1, 2, 3, 4, 5], [5, 3, 1, 0, 2, 4]])
    for percent in (60, 90, 97):
        within = lengths_at(spread, MEANS[0], (tours, np.roll(tours, -1, axis=1)), percent)
        for tour, most in zip(tours.tolist(), within, strict=True):
            share = (simulated(costs, tuple(tour)) <= most).mean()
            assert share == pytest.approx(percent / 100, abs=0.012)


@pytest.mark.parametrize("kind", SPREADS)
@pytest.mark.parametrize("closed", [True, False])
def test_the_front_of_a_few_stops_is_that_of_all_tours(kind: str, closed: bool) -> None:
    spread = SPREADS[kind]
    means = MEANS.copy()
    if spread.days is not None:
        means[0] = spread.days.mean(axis=0)
    ends = RouteEnds(closed=closed)
    instance = Instance(matrices=means, **ends._asdict())
    front = planned(instance, spread)
    points = []
    for tour in permutations(range(N)):
        order = np.array([tour])
        steps = (order, np.roll(order, -1, axis=1)) if closed else (order[:, :-1], order[:, 1:])
        first = lengths_at(spread, means[0], steps, spread.percent or 90)[0]
        points.append([first, means[1][steps].sum()])
    expected = np.array(points)[nondominated(np.array(points))]
    np.testing.assert_allclose(front.points, np.unique(expected.round(9), axis=0), rtol=1e-8)
    assert front.means is not None
    assert front.p90 is not None
    np.testing.assert_allclose(front.means[:, 1], front.p90[:, 1])
    assert (front.p90[:, 0] > front.means[:, 0]).all()


def planned(instance: Instance, spread: Spread) -> Front:
    options = PlanOptions(directions=np.empty((0, 2)), size=500, time_limit=5.0)
    return plan_reliably(partial(plan, Shuffler()), instance, [spread, None], options, Watch())


def test_given_days_are_counted_as_they_are() -> None:
    spread = SPREADS["days"]
    tours = np.array([[0, 1, 2, 3, 4, 5]])
    most = lengths_at(spread, MEANS[0], (tours, np.roll(tours, -1, axis=1)), 90)[0]
    lengths = simulated(DRAWN, (0, 1, 2, 3, 4, 5))
    assert (lengths <= most).sum() == 18
    assert most in lengths
