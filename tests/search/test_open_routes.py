"""Closed tours are opened to routes between the right ends, and where that is shortest."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from service.instance import Instance, tour_lengths
from service.pareto import hypervolume
from service.preferences import fan, from_angles
from service.search.open_routes import built_tours, opened, oriented, plain_tours
from tests.helpers import instances
from tests.helpers.instances import ENDS, KINDS, every_tour, random_tours, small_integers

CASES = {
    "kind": st.sampled_from(KINDS),
    "ends": st.sampled_from(ENDS),
    "n": st.integers(2, 9),
    "seed": st.integers(0, 1000),
}


def are_routes(instance: Instance, routes: NDArray[np.integer]) -> bool:
    """Whether all cities are visited, from the fixed start and to the fixed end."""
    return (
        (np.sort(routes, axis=1) == np.arange(instance.n)).all()
        and (instance.start is None or (routes[:, 0] == instance.start).all())
        and (instance.end is None or (routes[:, -1] == instance.end).all())
    )


def weighted(instance: Instance, routes: NDArray[np.integer], weights: NDArray) -> NDArray:
    return (tour_lengths(instance, routes) / instance.scale * weights).sum(axis=1)


@given(**CASES)
def test_opened_tours_are_routes_between_the_ends(kind: str, ends: str, n: int, seed: int) -> None:
    instance = instances.opened(small_integers(kind, n, seed), ends, seed)
    weights = from_angles(fan(4))
    tours = random_tours(n, 4, seed)
    routes = opened(instance, tours, weights)
    assert are_routes(instance, routes)
    assert are_routes(instance, built_tours(lambda i, _: plain_tours(i), instance, weights[:1]))
    plain = closest_plain(instance, tours, weights)
    assert (weighted(instance, routes, weights) <= plain + 1e-9).all()


def closest_plain(instance: Instance, tours: NDArray[np.int64], weights: NDArray) -> NDArray:
    """The least weighted lengths of the tours cut once, their second end taken out and put last."""
    n = instance.n
    lengths = []
    for tour, weight in zip(tours, weights, strict=True):
        cuts = np.stack([np.roll(tour, k) for k in range(n)])
        if instance.symmetric:
            cuts = np.concatenate((cuts, cuts[:, ::-1]))
        if instance.start is not None:
            cuts = cuts[cuts[:, 0] == instance.start]
        elif instance.end is not None:
            cuts = cuts[cuts[:, -1] == instance.end]
        if len(instance.fixed_ends) == 2:
            inner = cuts[cuts != instance.end].reshape(len(cuts), n - 1)
            cuts = np.pad(inner, ((0, 0), (0, 1)), constant_values=instance.end or 0)
        lengths.append(weighted(instance, cuts, weight).min())
    return np.array(lengths)


@pytest.mark.parametrize("kind", KINDS)
def test_a_tour_without_fixed_ends_loses_its_longest_step(kind: str) -> None:
    instance = instances.opened(small_integers(kind, 8, 3), "no")
    weights = from_angles(fan(5))
    tours = random_tours(8, 5)
    least = weighted(instance, opened(instance, tours, weights), weights)
    np.testing.assert_allclose(least, closest_plain(instance, tours, weights))


def test_closed_tours_stay_as_they_are() -> None:
    tours = random_tours(6, 3)
    closed = small_integers("coordinates", 6, 0)
    assert opened(closed, tours, from_angles(fan(3))) is tours
    assert oriented(closed, tours) is tours


@given(**CASES)
def test_two_fixed_ends_of_matrices_are_one_city_to_a_network(
    kind: str, ends: str, n: int, seed: int
) -> None:
    del ends
    instance = instances.opened(small_integers(kind, n, seed), "both", seed)
    seen: list[int] = []

    def build(given: Instance, preferences: NDArray) -> NDArray[np.int64]:
        seen.append(given.n)
        return random_tours(given.n, len(preferences), seed)

    routes = built_tours(build, instance, from_angles(fan(3)))
    assert are_routes(instance, routes)
    assert seen == [n - 1 if kind != "coordinates" and n > 3 else n]


def test_joined_ends_leave_every_length_as_it_is() -> None:
    instance = instances.opened(small_integers("asymmetric", 6, 1), "both")

    def every(given: Instance, preferences: NDArray) -> NDArray[np.int32]:
        del preferences
        closed = every_tour(given)
        lengths.append(tour_lengths(given, closed))
        return closed

    lengths: list[NDArray] = []
    routes = built_tours(every, instance, from_angles(fan(3)))
    np.testing.assert_allclose(tour_lengths(instance, routes), lengths[0])
    assert len(np.unique(routes, axis=0)) == len(every_tour(instance))


def test_routes_that_may_turn_round_are_reported_from_the_lower_end() -> None:
    cities = small_integers("coordinates", 5, 0)
    given = np.array([[4, 1, 2, 3, 0], [1, 0, 2, 4, 3]])
    free = replace(cities, closed=False)
    assert oriented(free, given)[:, [0, -1]].tolist() == [[0, 4], [1, 3]]
    assert oriented(replace(free, start=4), given[:1]).tolist() == given[:1].tolist()
    assert oriented(replace(free, end=4), given[:1])[0, -1] == 4
    one_way = replace(small_integers("asymmetric", 5, 0), closed=False)
    assert oriented(one_way, given) is given


def test_plain_tours_of_one_or_two_cities_are_all_there_are() -> None:
    for ends in ENDS:
        instance = instances.opened(small_integers("asymmetric", 2, 0), ends)
        expected = {tuple(tour) for tour in every_tour(instance).tolist()}
        assert {tuple(tour) for tour in plain_tours(instance).tolist()} == expected
    alone = Instance(matrices=np.zeros((2, 1, 1)), closed=False, start=0, end=0)
    assert not plain_tours(alone).any()


def test_a_cut_elsewhere_makes_a_route_shorter() -> None:
    rng = np.random.default_rng(0)
    instance = Instance(coordinates=rng.random((30, 4)), closed=False, start=0, end=1)
    weights = from_angles(fan(20))
    tours = random_tours(30, 20)
    least = weighted(instance, opened(instance, tours, weights), weights)
    assert (least < closest_plain(instance, tours, weights)).all()
    corner = np.full(2, 30.0)
    assert 0 < hypervolume(tour_lengths(instance, plain_tours(instance)), corner) < 1
