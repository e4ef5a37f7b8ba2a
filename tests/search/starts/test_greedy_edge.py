"""Greedy edge beside the same heuristic in a few plain lines, and tours of all kinds of ends."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from service.instance import Instance
from service.search.candidates import Scalarization
from service.search.starts.constructed_tour import constructed_tour
from service.search.starts.greedy_edge import greedy_edge
from tests.helpers.instances import random_matrices, scalarization_of, steps_of, uniform
from tests.helpers.sampled import third


def greedy_steps(scalarization: Scalarization) -> set[frozenset[int]]:
    """The candidate edges that greedy edge takes, by a walk along the paths for each."""
    candidates, costs = scalarization.candidates, scalarization.candidate_costs
    cheapest = sorted(
        (costs[i, k], i, int(j)) for i, row in enumerate(candidates) for k, j in enumerate(row)
    )
    beside: dict[int, set[int]] = {i: set() for i in range(len(candidates))}
    for _, i, j in cheapest:
        if len(beside[i]) < 2 and len(beside[j]) < 2 and not _joined(beside, i, j):
            beside[i].add(j)
            beside[j].add(i)
    return {frozenset((i, j)) for i, mates in beside.items() for j in mates}


def _joined(beside: dict[int, set[int]], i: int, j: int) -> bool:
    reached, ahead = set(), [i]
    while ahead:
        city = ahead.pop()
        reached.add(city)
        ahead += beside[city] - reached
    return j in reached


@settings(max_examples=third(30))
@given(seed=st.integers(0, 10**6), n=st.integers(3, 60))
def test_it_takes_the_edges_that_greedy_edge_takes(seed: int, n: int) -> None:
    scalarization = scalarization_of(random_matrices(n, seed, symmetric=True))
    tour = np.zeros(n, np.int32)
    greedy_edge(scalarization, 1, tour)
    assert np.array_equal(np.sort(tour), np.arange(n))
    assert greedy_steps(scalarization) <= steps_of(tour)


@settings(max_examples=third(30))
@given(
    seed=st.integers(0, 10**6),
    start=st.none() | st.integers(0, 9),
    end=st.none() | st.integers(10, 19),
)
def test_a_route_begins_and_ends_where_it_must(
    seed: int, start: int | None, end: int | None
) -> None:
    instance = replace(uniform(20, seed), closed=False, start=start, end=end)
    tour = constructed_tour(instance, scalarization_of(instance), greedy=True).tolist()
    assert sorted(tour) == list(range(21))
    assert tour[0] == 0
    assert start is None or tour[1] == 1 + start
    assert end is None or tour[-1] == 1 + end


@pytest.mark.parametrize("n", [12, 500])
def test_cities_in_two_places_have_a_tour(n: int) -> None:
    places = np.array([[0.0, 0.0, 0.0, 0.0], [1.0, 1.0, 1.0, 1.0]])
    instance = Instance(coordinates=np.tile(places, (n // 2, 1)))
    tour = constructed_tour(instance, scalarization_of(instance), greedy=True)
    assert np.array_equal(np.sort(tour), np.arange(n))
