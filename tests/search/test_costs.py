"""Costs of many cities in three and four planes: the same as of few, without a table."""

import numpy as np
import pytest
from numpy.typing import NDArray

from service.instance import Instance, step_lengths, tour_lengths
from service.search.candidates import CANDIDATES_PER_CITY, fill_in_blocks, make_candidate_pool
from service.search.closing import closed_tours
from service.search.costs import Costs, lengths, make_costs, sum_lengths, weighted_costs
from service.search.sizes import DENSE_BELOW
from tests.helpers.instances import opened, random_routes, uniform

several = pytest.mark.parametrize("objectives", [3, 4])
ends = pytest.mark.parametrize("ends", ["closed", "none", "start", "both"])
SIZES = pytest.mark.parametrize("n", [40, DENSE_BELOW])


def made(n: int, objectives: int, ends: str) -> tuple[Instance, Costs]:
    instance = uniform(n, objectives=objectives)
    instance = instance if ends == "closed" else opened(instance, ends)
    return instance, make_costs(instance)


def some_weights(objectives: int) -> NDArray[np.float64]:
    return np.random.default_rng(objectives).random(objectives)


@SIZES
@several
@ends
def test_sums_of_a_tour_are_its_lengths(n: int, objectives: int, ends: str) -> None:
    instance, costs = made(n, objectives, ends)
    weights = some_weights(objectives)
    assert len(costs.matrix) == (0 if n == DENSE_BELOW else len(costs.cities))
    routes = random_routes(instance, 3)
    expected = np.ldexp(tour_lengths(instance, routes), instance.shifts)
    for tour, scaled in zip(closed_tours(instance, routes), expected, strict=True):
        found = np.empty(objectives)
        sum_lengths(costs, tour, found)
        np.testing.assert_allclose(found, scaled, rtol=1e-12)
        weighted = lengths(weighted_costs(costs, weights), tour)
        if ends == "closed":
            assert sum(weighted) == pytest.approx(weights @ scaled, rel=1e-12)


@SIZES
@several
def test_candidates_are_the_cities_at_the_least_weighted_cost(n: int, objectives: int) -> None:
    instance, costs = made(n, objectives, "closed")
    weights = some_weights(objectives)
    pool = make_candidate_pool(n)
    for _ in fill_in_blocks(pool, weighted_costs(costs, weights), np.ones((1, 2))):
        pass
    steps = np.ldexp(step_lengths(instance, *np.indices((n, n))), instance.shifts) @ weights
    np.fill_diagonal(steps, np.inf)
    expected = np.sort(steps, axis=1)[:, :CANDIDATES_PER_CITY]
    found = np.sort(pool.costs[:, :CANDIDATES_PER_CITY].sum(axis=2), axis=1)
    np.testing.assert_allclose(found, expected, rtol=1e-9)
