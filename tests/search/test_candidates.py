"""Candidates are the cheapest cities, whether all are compared or trees are searched."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from service.instance import Instance
from service.search.candidates import CandidatePool, fill_in_blocks, make_candidate_pool
from service.search.costs import Costs, make_costs
from tests.helpers.sampled import third

WEIGHTS = np.array([[0.001, 0.999], [0.3, 0.7], [0.5, 0.5], [0.999, 0.001]])


def pool_of(costs: Costs) -> CandidatePool:
    pool = make_candidate_pool(len(costs.cities))
    for _ in fill_in_blocks(pool, costs, WEIGHTS):
        pass
    return pool


def untabulated(costs: Costs) -> Costs:
    return costs._replace(matrix=np.empty((0, 0, 2)))


def least_costs(pool: CandidatePool, weight: NDArray) -> list[NDArray]:
    """The eight least weighted costs in each row of a pool."""
    rows = zip(pool.costs, pool.sizes, strict=True)
    return [np.sort(costs[:size] @ weight)[:8] for costs, size in rows]


@pytest.mark.parametrize("closed", [True, False])
@settings(max_examples=third(30))
@given(n=st.integers(10, 150), clusters=st.integers(1, 100), seed=st.integers(0, 10**6))
def test_trees_find_the_same_candidates_as_a_look_at_all_pairs(
    n: int, clusters: int, seed: int, closed: bool
) -> None:
    rng = np.random.default_rng(seed)
    cities = rng.random((clusters, 4))[rng.integers(0, clusters, n)] + 0.05 * rng.random((n, 4))
    costs = make_costs(Instance(coordinates=cities, closed=closed))
    for expected, found in zip(pool_of(costs), pool_of(untabulated(costs)), strict=True):
        assert np.array_equal(found, expected)


@settings(max_examples=third(30))
@given(n=st.integers(10, 150), side=st.integers(1, 5), seed=st.integers(0, 10**6))
def test_among_cities_that_coincide_trees_find_as_near_ones(n: int, side: int, seed: int) -> None:
    cities = np.random.default_rng(seed).integers(0, side, (n, 4)).astype(float)
    costs = make_costs(Instance(coordinates=cities))
    expected, found = pool_of(costs), pool_of(untabulated(costs))
    assert (found.cities[np.arange(n), 0] != np.arange(n)).all()
    for weight in WEIGHTS:
        np.testing.assert_allclose(least_costs(found, weight), least_costs(expected, weight))
