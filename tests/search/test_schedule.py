"""A search keeps costs exact, and tells which tours its archive dropped."""

from itertools import islice

import numpy as np
import pytest
from numpy.typing import NDArray

from service.instance import Instance, tour_lengths
from service.pareto import hypervolume
from service.search.improve import improve
from service.search.pareto_local_search import MANY, rounds
from service.search.schedule import Search
from service.search.sizes import LARGE, MENDING, VAST
from service.search.weights import LEAST_SHARE, MENDED_WEIGHTS, WEIGHTS
from service.watch import Watch
from tests.helpers.instances import ENDS, opened, random_tours, small_integers, uniform


@pytest.mark.parametrize("ends", ["closed", *ENDS])
@pytest.mark.parametrize("kind", ["symmetric", "asymmetric"])
def test_whole_numbered_matrices_stay_exact(kind: str, ends: str) -> None:
    instance = small_integers(kind, 60, seed=1)
    if ends != "closed":
        instance = opened(instance, ends)
    search = Search(instance, 0, 60 * instance.scale)
    for _, _ in zip(range(200), search.run(), strict=False):
        pass
    assert np.array_equal(search.points(), tour_lengths(instance, search.tours()))


def test_a_given_tour_that_the_archive_had_to_let_go_is_still_returned() -> None:
    search = Search(uniform(20), 0, np.full(2, 20.0))
    tours = random_tours(20, 3)
    search.add(tours[:1])
    lost = search.not_covered(tours)
    assert all(tour.tolist() != tours[0].tolist() for tour in lost)
    search.add(lost)
    assert not len(search.not_covered(tours))


def test_no_cost_beyond_the_coordinates_is_stored_for_many_cities() -> None:
    search = Search(uniform(700), 0, np.full(2, 700.0))
    assert search.state.costs.matrix.size == 0


def test_weights_reach_as_far_for_many_cities_as_for_few_and_crowd_at_the_ends() -> None:
    few, many = (Search(uniform(n), 0, np.full(2, float(n))) for n in (40, LARGE))
    assert np.abs(many.weights - few.weights)[[0, -1]].max() < LEAST_SHARE
    logits = np.diff(np.log(many.weights[:, 0] / many.weights[:, 1]))
    np.testing.assert_allclose(logits, logits[0])
    assert (np.diff(many.weights[:, 0]) > 0).all()


def test_of_many_cities_the_tours_on_the_way_of_a_descent_are_kept() -> None:
    cities = np.arange(LARGE)
    search = Search(uniform(LARGE), 0, np.full(2, float(LARGE)), touched=cities)
    search.add(random_tours(LARGE, 1))
    for iterations in search.run():
        if iterations:  # the first weight has a local optimum
            break
    points = search.points()
    assert len(points) > 2
    np.testing.assert_allclose(points, tour_lengths(search.instance, search.tours()))


def test_gaps_between_earlier_tours_are_filled_after_each_round() -> None:
    n, touched = 60, np.arange(3, dtype=np.int32)
    search = Search(uniform(n), 0, np.full(2, float(n)), touched=touched)
    search.add(random_tours(n, 9))
    done = (iterations for iterations in search.run() if iterations > 1)
    for divisor, fills in rounds(n, touched):
        assert list(islice(done, len(search.weights))) == [n // divisor] * len(search.weights)
        assert list(islice(done, fills)) == [search.block] * fills


def test_many_earlier_cities_get_a_round_only_where_most_of_them_are_touched() -> None:
    few, most = (np.arange(size, dtype=np.int32) for size in (MANY // 2, MANY // 2 + 1))
    assert rounds(MANY, few) == ()
    assert len(rounds(MANY, most)) == len(rounds(MANY - 1, few)) == len(rounds(MANY, None)) == 2
    assert len(rounds(LARGE - 1, few)) == 5


def test_earlier_tours_are_mended_under_more_weights_where_three_opt_does() -> None:
    touched = np.arange(3, dtype=np.int32)

    def weights(n: int, touched: NDArray[np.int32] | None) -> int:
        return len(Search(uniform(n), 0, np.full(2, float(n)), touched=touched).weights)

    assert weights(MENDING - 1, touched) == weights(LARGE, touched) == WEIGHTS
    assert weights(MENDING, touched) == weights(LARGE - 1, touched) == MENDED_WEIGHTS
    assert weights(MENDING, None) == WEIGHTS


def test_of_a_large_instance_every_weight_has_candidates_before_iterations_begin() -> None:
    search = Search(uniform(LARGE), 0, np.full(2, float(LARGE)))
    count = len(search.weights)
    found = islice((iterations for iterations in search.run() if iterations), 2 * count)
    assert list(found) == [1] * count + [LARGE // 4] * count
    assert (search.state.weighted_candidates.candidate_costs[:, :, 0] > 0).all()


def test_little_hypervolume_is_missing_between_the_best_of_many_cities() -> None:
    corner = np.full(2, float(LARGE))
    points = improve(uniform(LARGE), np.empty((0, LARGE), int), iterations=40_000).points
    sharpest = points[_is_on_hull(points)]
    # Between two points of the lower hull, the area above the line between them, not the corner's.
    triangles = np.prod(np.abs(np.diff(sharpest, axis=0)), axis=1).sum() / 2 / np.prod(corner)
    between = hypervolume(points, corner) - hypervolume(sharpest, corner)
    assert between > 0.6 * triangles


def _is_on_hull(points: np.ndarray) -> list[int]:
    """The points of the lower convex hull, of points by ascending first length."""
    hull: list[int] = []
    for k, point in enumerate(points):
        while len(hull) > 1 and _turns_right(points[hull[-2]], points[hull[-1]], point):
            hull.pop()
        hull.append(k)
    return hull


def _turns_right(first: np.ndarray, second: np.ndarray, third: np.ndarray) -> bool:
    one, other = second - first, third - first
    return bool(one[0] * other[1] <= one[1] * other[0])


def test_without_time_the_first_tour_of_very_many_cities_is_good_under_both_objectives() -> None:
    instance = Instance(coordinates=np.random.default_rng(0).random((VAST, 4)))
    front = improve(instance, np.empty((0, VAST), np.int64), watch=Watch(0.0))
    assert (front.points < 0.1 * instance.reference_point).all()
