"""Costs of very different sizes, and legs that are forbidden, hide no tour from the search."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from service.actor import RELEASED, OnnxActor
from service.instance import Instance, tour_lengths
from service.pareto import hypervolume, nondominated
from service.preferences import fan, from_angles
from service.search import enumeration
from service.search.bound.hypervolume import hypervolume_bound
from service.search.improve import improve
from service.watch import Watch
from tests.helpers.instances import ENDS, every_tour, no_tours, opened
from tests.helpers.sampled import few, sixth

pytestmark = pytest.mark.usefixtures("compiled")

Array = NDArray[np.float64]
KINDS = ("coordinates", "symmetric", "asymmetric", "big legs")


def drawn(seed: int, n: int) -> Instance:
    """An instance of whole numbers, spread over up to twelve powers of ten, with forbidden legs."""
    rng = np.random.default_rng(seed)
    kind, spread = KINDS[seed % 4], rng.choice([1, 3, 6, 12])
    if kind == "coordinates":
        instance = Instance(coordinates=(rng.random((n, 4)) * 10 ** rng.uniform(0, spread)).round())
    else:
        costs = np.floor(10 ** rng.uniform(0, spread, (2, n, n)))
        if kind == "big legs":
            costs = rng.integers(1, 99, (2, n, n)).astype(float)
            costs[rng.random((2, n, n)) < 0.1] = 10.0**spread
        forbidden = rng.random((n, n)) < rng.choice([0.0, 0.1, 0.4])
        if kind == "symmetric":
            costs, forbidden = np.maximum(costs, costs.transpose(0, 2, 1)), forbidden | forbidden.T
        instance = Instance(matrices=np.where(forbidden, np.inf, costs))
    if n == 1 or rng.random() < 0.5:
        return instance
    return opened(instance, ENDS[seed // 4 % 4], seed)


def exact_front(instance: Instance) -> Array:
    """The nondominated lengths of all tours without a forbidden leg."""
    points = tour_lengths(instance, every_tour(instance))
    return points[nondominated(points)]


@pytest.mark.parametrize("block", few(4, range(10)))
def test_up_to_seven_cities_of_any_costs_give_the_front_of_all_tours(block: int) -> None:
    for seed in range(100 * block, 100 * (block + 1)):
        instance = drawn(seed, 1 + seed % 7)
        found = improve(instance, no_tours(instance.n))
        # Sums of whole numbers up to 1e13 are exact; distances in a plane are rounded.
        known = exact_front(instance)
        if instance.matrices is not None:
            np.testing.assert_array_equal(found.points, known, str(seed))
        else:
            is_level(found.points, known)


@pytest.mark.parametrize("seed", range(sixth(8)))
def test_eight_and_nine_cities_of_any_costs_give_the_front_of_all_tours(seed: int) -> None:
    instance = replace(drawn(4 * seed + 3, 8 + seed % 2), closed=True, start=None, end=None)
    found = improve(instance, no_tours(instance.n))
    np.testing.assert_array_equal(found.points, exact_front(instance))


def is_level(points: Array, known: Array) -> None:
    """Assert that each of two fronts has, but for rounding, a point as good as any of the other."""
    for one, other in ((points, known), (known, points)):
        near = (one[:, None] <= other * (1 + 1e-14)).all(axis=2)
        assert near.any(axis=0).all()


def shortest(costs: Array, instance: Instance) -> float:
    """The least length of a tour under one objective, by dynamic programming over sets."""
    n = len(costs)
    start = 0 if instance.closed else instance.start
    reached = np.full((1 << n, n), np.inf)  # by the set of cities visited, and the last of them
    for city in range(n) if start is None else [start]:
        reached[1 << city, city] = 0.0
    sets = np.arange(1 << n)
    for visited in sorted(sets.tolist(), key=int.bit_count):
        if np.isfinite(reached[visited]).any():
            following = (reached[visited][:, None] + costs).min(axis=0)
            for city in np.flatnonzero((visited >> np.arange(n)) & 1 == 0):
                grown = visited | 1 << int(city)
                reached[grown, city] = min(reached[grown, city], following[city])
    if instance.closed:
        return float((reached[-1] + costs[:, 0])[1:].min())
    return float(reached[-1].min() if instance.end is None else reached[-1, instance.end])


@pytest.mark.parametrize("seed", range(sixth(24)))
def test_ten_and_eleven_cities_of_any_costs_give_the_shortest_tours(seed: int) -> None:
    instance = drawn(seed + 5_000, 10 + seed % 2)
    found = improve(instance, no_tours(instance.n))
    if instance.matrices is not None:
        costs = instance.matrices.copy()
    else:
        costs = instance.scaled_matrices * instance.scale[:, None, None]
    costs[:, np.arange(instance.n), np.arange(instance.n)] = np.inf
    known = [shortest(cost, instance) for cost in costs]
    least = found.points.min(axis=0) if len(found.points) else np.full(2, np.inf)
    np.testing.assert_allclose(least, known, rtol=0 if instance.matrices is not None else 1e-13)


def with_big_leg(n: int, cost: float) -> Instance:
    """Small whole numbers in both matrices, but for one leg of the first."""
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    first = (37 * i * i + 59 * j + i * j) % 97 + 1.0
    first[1, 0] = cost
    return Instance(matrices=np.stack([first, (41 * i + 71 * j * j + i * j) % 89 + 1.0]))


@pytest.mark.parametrize("cost", [3e4, 1e5, 2147483647.0, 1e12, 1e300, np.inf])
def test_one_leg_that_is_coded_as_a_big_number_hides_no_shorter_tour(cost: float) -> None:
    found = improve(with_big_leg(10, cost), no_tours(10))
    assert found.points[0].tolist() == [104, 557]
    assert np.array_equal(found.points[found.points[:, 0] < 3e4], usual_front())


def usual_front() -> Array:
    """The front of tours that do not use the leg that is forbidden."""
    return improve(with_big_leg(10, np.inf), no_tours(10)).points


@pytest.mark.parametrize("seed", range(sixth(6)))
def test_forty_cities_with_big_or_forbidden_legs_are_planned_as_well_as_with_small_ones(
    seed: int,
) -> None:
    rng = np.random.default_rng(seed)
    costs = rng.integers(1, 98, (2, 40, 40)).astype(float)
    if seed % 2:
        costs = np.maximum(costs, costs.transpose(0, 2, 1))
    legs = rng.permutation(40)[:6].reshape(3, 2)
    shares = []
    for cost in (5e4, 1e12, np.inf):
        changed = costs.copy()
        changed[0, legs[:, 0], legs[:, 1]] = cost
        if seed % 2:
            changed[0, legs[:, 1], legs[:, 0]] = cost
        instance = Instance(matrices=changed)
        found = improve(instance, no_tours(40), iterations=400_000)
        shares.append(hypervolume(found.points, np.full(2, 40 * 97.0)))
    assert max(shares) - min(shares) < 5e-4


def test_a_city_far_from_all_others_makes_no_tour_among_these_longer() -> None:
    rng = np.random.default_rng(3)
    places = np.concatenate([rng.random((30, 2)) * 0.05 + [24.9, 60.1], [[0.0, 0.0]]])
    others = rng.random((31, 2))
    apart = Instance(coordinates=np.concatenate([places, others], axis=1))
    near = Instance(coordinates=np.concatenate([places[:30], others[:30]], axis=1))
    far, known = (improve(each, no_tours(each.n), iterations=200_000) for each in (apart, near))
    rest = far.tours[0][far.tours[0] < 30]
    among = tour_lengths(near, rest[None].astype(np.int64))[0, 0]
    assert among <= 1.02 * known.points[0, 0]  # it is left from and returned to beside another


def test_a_city_far_from_all_others_leaves_room_below_the_default_reference_point() -> None:
    cities = np.random.default_rng(4).random((40, 4))
    cities[0, :2] = 1e6
    costs = np.hypot(*(cities[:, None, :2] - cities[:, :2]).transpose(2, 0, 1))
    for instance in (Instance(coordinates=cities), Instance(matrices=np.stack([costs, costs]))):
        found = improve(instance, no_tours(40), iterations=20_000)
        assert (found.points < instance.reference_point).all()


def test_ordinary_costs_have_the_largest_for_their_scale_and_n_times_it_as_reference() -> None:
    costs = np.random.default_rng(5).random((2, 30, 30))
    instance = Instance(matrices=costs)
    apart = costs[:, ~np.eye(30, dtype=bool)]
    np.testing.assert_array_equal(instance.scale, apart.max(axis=1))
    np.testing.assert_array_equal(instance.reference_point, 30 * apart.max(axis=1))


@pytest.mark.parametrize("kind", ["coordinates", "matrices"])
def test_the_network_plans_the_others_as_if_the_far_city_was_nearer(kind: str) -> None:
    rng = np.random.default_rng(6)
    near, lengths = rng.random((40, 4)), []
    for far in (1.2, 1e9):
        cities = near.copy()
        cities[0] = far
        instance = Instance(coordinates=cities)
        if kind == "matrices":
            instance = Instance(matrices=instance.scaled_matrices * instance.scale[:, None, None])
        name = "pa-one" if kind == "coordinates" else "pa-one-matrix"
        actor = OnnxActor(RELEASED / f"{name}.onnx", threads=1)
        tours = actor.tours(instance, from_angles(fan(20)))
        others = tours[tours > 0].reshape(20, 39) - 1
        lengths.append(tour_lengths(Instance(coordinates=near[1:]), others).sum(axis=1).min())
    assert lengths[1] < 1.1 * lengths[0]


@pytest.mark.parametrize("seed", range(sixth(8)))
def test_a_bound_is_above_what_is_found_of_costs_of_any_size(seed: int) -> None:
    instance = drawn(seed + 9_000, 13)
    found = improve(instance, no_tours(13), watch=Watch(0.3))
    bound = hypervolume_bound(instance, instance.reference_point)
    assert hypervolume(found.points, instance.reference_point) <= bound <= 1


def test_a_front_is_empty_where_every_tour_has_a_forbidden_leg() -> None:
    costs = np.ones((2, 20, 20))
    costs[0, 3] = np.inf
    instance = Instance(matrices=costs)
    reports: list[int] = []
    found = improve(
        instance,
        np.arange(20)[None],
        watch=Watch(0.4, report=lambda progress, _: reports.append(progress.points)),
    )
    assert found.points.shape == (0, 2)
    assert found.tours.shape == (0, 20)
    assert not reports


def test_enumeration_stops_in_time_and_keeps_what_it_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # No tour dominates another, so that a block takes longer than the one before it.
    monkeypatch.setattr(enumeration, "LEAST_BLOCKS", 5)
    first = np.random.default_rng(7).random((9, 9))
    instance = Instance(matrices=np.stack([first, 1 - first]), closed=False)
    found = improve(instance, no_tours(9), watch=Watch(0.0))
    assert found.terminated == "time_limit"
    assert len(found.points) > 0
    calls = iter(range(10**6))
    found = improve(instance, no_tours(9), watch=Watch(stop=lambda: next(calls) > 3))
    assert found.terminated == "cancelled"
    assert len(found.points) > 0


def test_legs_that_cost_ten_thousand_times_as_much_hide_few_tours_without_them() -> None:
    """Under one objective: then tours with such a leg are on the front, far from all others."""
    missed = 0
    for seed in range(sixth(8)):
        rng = np.random.default_rng(seed)
        costs = rng.integers(10, 1000, (2, 13, 13)).astype(float)
        big = rng.random((13, 13)) < 0.15
        fronts = []
        for cost in (1e7, np.inf):
            costs[0][big] = cost
            found = improve(Instance(matrices=costs), no_tours(13))
            fronts.append(set(map(tuple, found.points.tolist())))
        missed += len(fronts[1] - fronts[0])
    assert missed <= 2
