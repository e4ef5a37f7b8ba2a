"""No front exceeds the bound."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from service.instance import Instance, tour_lengths
from service.pareto import hypervolume
from service.search.bound.hypervolume import (
    WEIGHTS,
    area_above,
    hypervolume_bound,
)
from service.search.bound.weighted import lowest_sums
from service.search.costs import make_costs
from service.search.enumeration import exact_tours
from service.search.improve import improve
from service.watch import Watch
from tests.helpers.instances import ENDS, all_tours, every_tour, opened
from tests.helpers.sampled import third

pytestmark = pytest.mark.usefixtures("compiled")


def drawn(
    seed: int, n: int, symmetric: bool, planar: bool = False, ends: str = "closed"
) -> Instance:
    instance = drawn_closed(seed, n, symmetric, planar)
    return instance if ends == "closed" else opened(instance, ends, seed)


def drawn_closed(seed: int, n: int, symmetric: bool, planar: bool) -> Instance:
    rng = np.random.default_rng(seed)
    if planar:
        return Instance(coordinates=rng.integers(0, 6, (n, 4)).astype(float))
    matrices = rng.integers(0, 1 + seed % 40, (2, n, n)) * np.array([1.0, 1e3])[:, None, None]
    return Instance(matrices=matrices + (matrices.transpose(0, 2, 1) if symmetric else 0))


@settings(max_examples=third(150))
@given(
    seed=st.integers(0, 10**6),
    n=st.integers(1, 8),
    symmetric=st.booleans(),
    planar=st.booleans(),
    ends=st.sampled_from(("closed", *ENDS)),
    corner=st.tuples(st.floats(0.05, 2), st.floats(0.05, 2)),
)
def test_the_exact_front_of_a_few_cities_is_within_the_bound(
    seed: int, n: int, symmetric: bool, planar: bool, ends: str, corner: tuple[float, float]
) -> None:
    instance = drawn(seed, n, symmetric, planar, "closed" if n == 1 else ends)
    reference_point = n * instance.scale * corner
    exact = hypervolume(tour_lengths(instance, every_tour(instance)), reference_point)
    assert exact <= hypervolume_bound(instance, reference_point) * (1 + 1e-12) <= 1 + 1e-12


@pytest.mark.parametrize("ends", ["closed", *ENDS])
@pytest.mark.parametrize("symmetric", [True, False])
def test_the_exact_front_of_ten_cities_is_within_the_bound(symmetric: bool, ends: str) -> None:
    instance = drawn(4, 10, symmetric, planar=False, ends=ends)
    points = tour_lengths(instance, exact_tours(instance)[0])
    reference_point = points.max(axis=0)
    bound = hypervolume_bound(instance, reference_point)
    assert hypervolume(points, reference_point) <= bound < 1


@settings(max_examples=third(60))
@given(
    seed=st.integers(0, 10**6),
    n=st.integers(4, 8),
    symmetric=st.booleans(),
    ends=st.sampled_from(("closed", *ENDS)),
)
def test_no_tour_is_shorter_than_the_bound_under_a_weight(
    seed: int, n: int, symmetric: bool, ends: str
) -> None:
    instance = drawn(seed, n, symmetric, planar=False, ends=ends)
    share = np.linspace(0, 1, WEIGHTS)
    weights = np.stack([share, 1 - share], axis=1) / instance.scale
    shortest = (tour_lengths(instance, every_tour(instance)) @ weights.T).min(axis=0)
    sums = [(make_costs(instance), *each) for each in (weights / 2.0**instance.shifts).tolist()]
    lowest = lowest_sums(sums, range(WEIGHTS), share[:, np.newaxis], Watch())
    assert (lowest <= shortest + 1e-9).all()


def test_the_assignment_bound_is_the_least_assignment() -> None:
    n = 7
    instance = Instance(matrices=np.random.default_rng(5).random((2, n, n)))
    costs = make_costs(instance)
    weighted: NDArray[np.float64] = costs.matrix @ (0.5, 0.5)
    orders = np.array([order for order in _permutations(n) if (order != np.arange(n)).all()])
    least = weighted[np.arange(n), orders].sum(axis=1).min()
    [lowest] = lowest_sums([(costs, 0.5, 0.5)], [0], np.zeros((1, 1)), Watch())
    assert lowest == pytest.approx(least)


def _permutations(n: int) -> NDArray[np.int32]:
    return all_tours(n + 1)[:, 1:] - 1


@pytest.mark.parametrize("ends", ["closed", *ENDS])
@pytest.mark.parametrize(("symmetric", "gap"), [(True, 0.005), (False, 0.03)])
def test_the_bound_is_close_above_what_a_search_finds(
    symmetric: bool, gap: float, ends: str
) -> None:
    rng = np.random.default_rng(1)
    instance = (
        Instance(coordinates=rng.random((40, 4)))
        if symmetric
        else Instance(matrices=rng.random((2, 40, 40)))
    )
    if ends != "closed":
        instance = opened(instance, ends)
    corner = 40 * instance.scale
    found = improve(instance, np.empty((0, 40), np.int32), iterations=30_000)
    share, bound = hypervolume(found.points, corner), hypervolume_bound(instance, corner)
    assert share <= bound <= share + gap


@pytest.mark.parametrize("symmetric", [True, False])
def test_a_bound_out_of_time_is_loose_yet_valid(symmetric: bool) -> None:
    instance = drawn(7, 60, symmetric, planar=False)
    corner = 60 * instance.scale
    checks: list[None] = []
    hasty = hypervolume_bound(
        instance,
        corner,
        Watch(0.0, lambda: bool(checks.append(None))),  # type: ignore[func-returns-value]
    )
    assert len(checks) == 1
    assert hypervolume_bound(instance, corner) <= hasty <= 1


def test_the_area_above_known_lines_is_known() -> None:
    weights = np.array([[0.0, 1.0], [0.5, 0.5], [1.0, 0.0]])
    assert area_above(weights, np.zeros(3)) == 1
    assert area_above(weights, np.array([0.25, 0.0, 0.5])) == pytest.approx(0.75 * 0.5)
    assert area_above(weights, np.array([0.0, 0.5, 0.0])) == pytest.approx(0.5)
    assert area_above(weights, np.array([0.0, 0.0, 3.0])) == 0


def test_a_bound_that_is_told_to_stop_is_loose_yet_valid() -> None:
    instance = drawn(7, 60, True, planar=True)
    corner = 60 * instance.scale
    answers = iter([False, True])
    hasty = hypervolume_bound(instance, corner, Watch(stop=lambda: next(answers)))
    with pytest.raises(StopIteration):
        next(answers)
    assert hypervolume_bound(instance, corner) <= hasty <= 1
