"""Fronts over the day equal those of all tours, each driven step by step."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from service.day.costs import CostsOfDay
from service.front import Front, PlanOptions
from service.instance import CLOSED, RouteEnds
from service.over_the_day.day import Day
from service.over_the_day.plan import plan_over_the_day
from service.pareto import nondominated
from service.planner import plan
from service.replanning.earlier_tours import EarlierTours
from service.replanning.replan import replan
from tests.helpers.actors import Shuffler
from tests.helpers.days import arrival, lengths_of, random_costs, random_day, tours_of
from tests.helpers.sampled import sixth

ROUNDING = 1e-9


def planned(
    day: Day, earlier: EarlierTours | None = None, time_limit: float = 60.0, start: int = 0
) -> Front:
    options = PlanOptions(
        directions=np.empty((0, len(day.costs))), size=5_000, time_limit=time_limit, start=start
    )
    under_means = partial(plan, Shuffler(), day.instance)
    if earlier is not None:
        under_means = partial(replan, Shuffler(), day.instance, earlier)
    return plan_over_the_day(under_means, day, options, earlier)


def close(a: NDArray[np.float64], b: NDArray[np.float64]) -> None:
    np.testing.assert_allclose(a, b, rtol=ROUNDING, atol=ROUNDING)


def distinct(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the nondominated points, without those that differ by rounding alone."""
    front = points[nondominated(points)]
    kept: list[NDArray[np.float64]] = []
    for point in front:
        if not any((other <= point + ROUNDING).all() for other in kept):
            kept.append(point)
    return np.array(kept)


@pytest.mark.parametrize("seed", range(sixth(40)))
def test_the_front_of_a_few_stops_is_that_of_all_tours(seed: int) -> None:
    rng = np.random.default_rng(seed)
    day = random_day(rng, int(rng.integers(1, 7)), objectives=int(rng.integers(2, 4)))
    start = len(day.service) - 1
    front = planned(day, start=start)
    points = np.array([lengths_of(day, tour, day.earliest) for tour in tours_of(day, start)])
    close(distinct(front.points), distinct(points))
    assert front.terminated == "converged"


@pytest.mark.parametrize("seed", range(sixth(20)))
def test_of_a_range_each_tour_has_the_departure_after_which_it_takes_least(seed: int) -> None:
    rng = np.random.default_rng(seed)
    day = random_day(rng, int(rng.integers(2, 6)), width=50.0)
    front = planned(day)
    assert front.departures is not None
    for tour, point, departure in zip(front.tours, front.points, front.departures, strict=True):
        close(point, lengths_of(day, tuple(tour), departure))
        assert day.earliest <= departure <= day.latest
        others = np.linspace(day.earliest, day.latest, 400)
        seconds = [lengths_of(day, tuple(tour), each)[day.clock] for each in others]
        assert point[day.clock] <= min(seconds) + ROUNDING


@pytest.mark.parametrize("seed", range(sixth(10)))
def test_of_many_stops_all_is_as_if_driven_step_by_step(seed: int) -> None:
    rng = np.random.default_rng(seed)
    day = random_day(rng, 12, objectives=2 + seed % 3, width=30.0 * (seed % 2))
    front = planned(day, time_limit=0.3, start=5)
    assert front.departures is not None
    assert front.times is not None
    for tour, point, departure, times in zip(
        front.tours, front.points, front.departures, front.times, strict=True
    ):
        assert sorted(tour) == list(range(12))
        close(point, lengths_of(day, tuple(tour), departure))
        assert (np.diff([departure, *times]) >= 0).all()
        close(times[-1:], np.array([departure + point[day.clock]]))
        if day.ends.closed:
            assert tour[0] == 5
    assert len(distinct(front.points)) == len(front.points)


@pytest.mark.parametrize("seed", range(sixth(20)))
def test_who_leaves_later_never_arrives_earlier(seed: int) -> None:
    rng = np.random.default_rng(seed)
    day = random_day(rng, 6)
    tour = tuple(rng.permutation(6))
    departures = np.linspace(0, 120, 500)
    arrivals = [each + lengths_of(day, tour, each)[day.clock] for each in departures]
    assert (np.diff(arrivals) >= -ROUNDING).all()
    fixed = [planned(replace(day, earliest=each, latest=each)) for each in (0.0, 30.0, 60.0)]
    ends = [each.times[:, -1].min() for each in fixed if each.times is not None]
    assert ends == sorted(ends)


@pytest.mark.parametrize("n", [6, 9])
def test_a_day_without_slices_is_planned_as_without_a_day(n: int) -> None:
    rng = np.random.default_rng(n)
    costs = [CostsOfDay.constant(random_costs(rng, n, 1).matrices[0]) for _ in range(2)]
    day = Day(costs, 0, np.full(n, 3.0), 10.0, 10.0, CLOSED)
    alone = plan(
        Shuffler(),
        day.instance,
        PlanOptions(directions=np.empty((0, 2)), size=1_000, time_limit=5.0),
    )
    close(planned(day).points, alone.points + np.array([3.0 * n, 0.0]))


def test_a_front_is_replanned_from_the_tours_that_are_left() -> None:
    rng = np.random.default_rng(5)
    day = replace(random_day(rng, 12), ends=RouteEnds(False, 0, None))
    driven = np.array([[0, *rng.permutation(np.arange(1, 12))]])
    kept = planned(day, EarlierTours(driven, min_kept=0.8), time_limit=0.3)
    assert kept.kept is not None
    assert (kept.kept >= 0.8 - ROUNDING).all()
    free = planned(day, EarlierTours(driven), time_limit=0.3)
    assert free.kept is not None
    assert (free.tours[:, 0] == 0).all()
    first = lengths_of(day, tuple(driven[0]), day.earliest)
    assert (free.points <= first + ROUNDING).all(axis=1).any()


def test_the_rest_of_a_leg_is_driven_at_the_next_speed() -> None:
    costs = CostsOfDay(
        np.array([0.0, 100.0]),
        np.array([1.0, 2.0]),
        np.zeros(2, np.int64),
        np.array([[[0.0, 60.0], [60.0, 0.0]]]),
    )
    assert arrival(costs, 70.0, 0, 1) == 160.0  # 30 s are half of it; the rest takes 60 s
    day = Day([costs, costs], 0, np.zeros(2), 70.0, 70.0, RouteEnds(False, 0, None))
    assert planned(day).points.tolist() == [[90.0, 60.0]]
