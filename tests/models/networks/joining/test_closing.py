"""Closing: the last fragments become the cheapest tour that has all their edges."""

from itertools import pairwise, permutations

import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Generator, Tensor

from models.networks.joining.candidates import joined_at_cost, single_cities, toured
from models.networks.joining.closing import ENOUGH, joined_to_one
from models.networks.joining.costs import Costs, Matrices, Problem, padded_matrices
from models.networks.joining.fragments import Fragments


def directed(n: int, generator: Generator) -> Problem:
    """One row of costs that differ by direction."""
    costs: Matrices = padded_matrices(torch.rand(1, n, n, generator=generator))
    return Problem(costs, torch.ones(1, 1))


def with_one_joining(costs: Costs, fragments: Fragments, generator: Generator) -> Fragments:
    """The fragments, with an edge more between two open ends."""
    names, is_open = fragments.names[0], fragments.open[0]
    pairs = [
        (a, b)
        for a in range(len(names))
        for b in range(a)
        if is_open[a] and is_open[b] and names[a] != names[b]
    ]
    a, b = pairs[int(torch.randint(len(pairs), (), generator=generator))]
    mates = torch.full_like(fragments.ends, -1)
    mates[0, a], mates[0, b] = b, a
    return joined_at_cost(costs, fragments, mates)


def edges_of(fragments: Fragments, n: int) -> set[frozenset[int]]:
    links = fragments.links[0, :-1].view(2, n).tolist()
    return {frozenset((a, b)) for row in links for a, b in enumerate(row) if b >= 0}


def length(table: Tensor, tour: tuple[int, ...]) -> float:
    return sum(float(table[step]) for step in pairwise((*tour, tour[0])))


@given(seed=st.integers(0, 10_000), n=st.integers(3, 7), left=st.integers(1, ENOUGH))
@settings(max_examples=40)
def test_fragments_are_closed_to_the_cheapest_tour(seed: int, n: int, left: int) -> None:
    generator = Generator().manual_seed(seed)
    problem = directed(n, generator)
    costs = problem.tables
    assert costs.leans is not None
    table = (costs.means + costs.leans)[0, :n, :n]
    fragments = single_cities(costs)
    while fragments.left > left:
        fragments = with_one_joining(costs, fragments, generator)
    tour = tuple(toured(costs, joined_to_one(costs, fragments))[0].tolist())
    edges = edges_of(fragments, n)
    cheapest = min(
        length(table, (0, *others))
        for others in permutations(range(1, n))
        if edges <= {frozenset(step) for step in pairwise((0, *others, 0))}
    )
    assert sorted(tour) == list(range(n))
    assert abs(length(table, tour) - cheapest) < 1e-5
