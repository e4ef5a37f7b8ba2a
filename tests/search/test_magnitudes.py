"""Costs of any magnitude are planned: finite numbers, valid tours, and lengths that are right."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from service.construction.call_estimate import CallEstimate
from service.errors import InvalidInstance
from service.front import Front, PlanOptions
from service.instance import Instance
from service.planner import plan
from service.preferences import fan, from_angles
from service.search.best_subset import best_subset
from service.search.bound.hypervolume import hypervolume_bound
from service.search.front_points import FrontPoints
from service.search.improve import improve
from tests.helpers.instances import no_tours
from tests.helpers.sampled import third

pytestmark = pytest.mark.usefixtures("compiled")

Array = NDArray[np.float64]
POWERS = st.integers(-320, 300)


class OneOrder:
    """A constructor whose tours all visit the cities in their order."""

    estimate = CallEstimate("coordinates")

    def tours(self, instance: Instance, preferences: Array, _repairs: int) -> NDArray[np.int64]:
        return np.tile(np.arange(instance.n), (len(preferences), 1))

    def terminate(self) -> None:
        """Do nothing: no call takes long."""


def drawn(seed: int, n: int, powers: tuple[int, int], spread: float, kind: str) -> Instance:
    """An instance whose objectives have these powers of ten, and costs spread within them."""
    rng = np.random.default_rng(seed)
    units = np.array([float(f"1e{power}") for power in powers])
    if kind == "coordinates":
        cities = rng.random((n, 4)) * 10.0 ** -rng.uniform(0, spread, (n, 4))
        return Instance(coordinates=cities * units.repeat(2))
    matrices = rng.random((2, n, n)) * 10.0 ** -rng.uniform(0, spread, (2, n, n))
    if kind == "symmetric":
        matrices = np.maximum(matrices, matrices.transpose(0, 2, 1))
    return Instance(matrices=matrices * units[:, None, None])


def exact_lengths(instance: Instance, tour: Array) -> list[Fraction]:
    """The lengths of a tour, to some 20 digits, by fractions."""
    following = np.roll(tour, -1)
    if instance.matrices is not None:
        return [sum(map(Fraction, m[tour, following].tolist())) for m in instance.matrices]
    assert instance.coordinates is not None
    steps = instance.coordinates[following] - instance.coordinates[tour]
    unit = [Fraction(float(scale)) for scale in instance.scale]
    return [
        unit[m] * sum(_root((Fraction(x) ** 2 + Fraction(y) ** 2) / unit[m] ** 2) for x, y in plane)
        for m, plane in enumerate((steps[:, :2].tolist(), steps[:, 2:].tolist()))
    ]


def _root(square: Fraction) -> Fraction:
    return Fraction(float(square)) if square == 0 else Fraction(float(square) ** 0.5)


def is_right(instance: Instance, front: Front) -> None:
    """Assert that all numbers of a front are finite, and tours and lengths valid."""
    numbers = [front.points, front.angles, front.scale, front.reference_point]
    assert all(np.isfinite(each).all() for each in numbers)
    assert 0 <= front.hypervolume <= 1
    # Of few cities the bound is what is found, but for rounding.
    assert front.bound is None or front.hypervolume <= front.bound * (1 + 1e-12)
    assert front.bound is None or front.bound <= 1
    np.testing.assert_array_equal(
        np.sort(front.tours, axis=1), np.tile(np.arange(instance.n), (len(front.tours), 1))
    )
    for tour, point in zip(front.tours, front.points.tolist(), strict=True):
        for came, right in zip(point, exact_lengths(instance, tour), strict=True):
            assert abs(Fraction(came) - right) <= right * Fraction(1e-9) + Fraction(2.0**-1070)


@settings(max_examples=third(150), deadline=None)
@given(
    seed=st.integers(0, 10**6),
    n=st.sampled_from([2, 5, 9, 12]),
    powers=st.tuples(POWERS, POWERS),
    spread=st.sampled_from([0.0, 3.0, 100.0]),
    kind=st.sampled_from(["coordinates", "symmetric", "asymmetric"]),
    reference=st.none() | st.tuples(st.integers(-150, 150), st.integers(-150, 150)),
)
@example(37560, 12, (0, 0), 100.0, "symmetric", (-11, 0))  # nearly the whole box, in many slices
def test_costs_of_any_magnitude_are_planned(
    seed: int,
    n: int,
    powers: tuple[int, int],
    spread: float,
    kind: str,
    reference: tuple[int, int] | None,
) -> None:
    instance = drawn(seed, n, powers, spread, kind)
    options = PlanOptions(
        directions=from_angles(fan(3)),
        size=4,
        time_limit=0.02,
        bound=True,
        reference_point=None if reference is None else np.array([10.0**p for p in reference]),
    )
    is_right(instance, plan(OneOrder(), instance, options))


@pytest.mark.parametrize("unit", [1e-320, 1e-310, 1e-308, 1e-150, 1e300])
def test_whole_numbers_are_planned_alike_in_any_power_of_two(unit: float) -> None:
    numbers = np.random.default_rng(1).integers(0, 50, (2, 12, 12)).astype(float)
    power = 2.0 ** np.floor(np.log2(unit))
    plain = improve(Instance(matrices=numbers), no_tours(12), iterations=2000)
    other = improve(Instance(matrices=numbers * power), no_tours(12), iterations=2000)
    np.testing.assert_array_equal(plain.tours, other.tours)
    np.testing.assert_array_equal(plain.points * power, other.points)


def test_a_bound_of_tiny_costs_is_the_bound_of_common_ones() -> None:
    numbers = np.random.default_rng(2).integers(1, 50, (2, 12, 12)).astype(float)
    common, tiny = (
        hypervolume_bound(instance, 12 * instance.scale)
        for instance in (Instance(matrices=numbers), Instance(matrices=numbers * 2.0**-1070))
    )
    assert tiny == pytest.approx(common)
    assert 0 < tiny < 1


def test_costs_that_no_unit_can_hold_together_are_refused() -> None:
    matrices = np.ones((2, 9, 9))
    matrices[1, 2, 3], matrices[1, 3, 2] = 1e-300, 1e150
    with pytest.raises(InvalidInstance, match=r"within a factor of 1e301 .* 1e-300 and 1e\+150"):
        Instance(matrices=matrices)


def test_a_reference_point_in_too_small_a_unit_leaves_every_tour_out() -> None:
    points = np.array([[1e300, 2e300], [2e300, 1e300], [3e300, 5e299]])
    assert len(best_subset(FrontPoints(points, np.array([1e-300, 1e-300])), 2)) == 2
