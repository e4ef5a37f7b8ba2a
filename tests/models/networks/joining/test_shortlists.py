"""Shortlists and contraction: the same candidates, costs and tours as among all pairs."""

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Generator, Tensor

from models.data.preferences import fan_of_preferences, fan_or_lattice, weights
from models.networks.joining.candidates import (
    Candidates,
    cheapest_candidates,
    joined_at_cost,
    no_more_possible,
    single_cities,
    toured,
)
from models.networks.joining.contraction import contracted, expanded
from models.networks.joining.costs import Matrices, Planes, Problem, padded_matrices
from models.networks.joining.fragments import NEVER, Fragments, mutual_best
from models.networks.joining.prices import KNOTS, own_prices, priced_problem, prices_at_knots
from models.networks.joining.shortlists import (
    RowLists,
    first_of,
    listed_candidates,
    lists_of_rows,
    own_lists,
    shortlists,
)
from tests.helpers.small_actors import CPU

# A list has room for all cities of so few.
CITIES = st.integers(3, 12)
KINDS = st.sampled_from(["planes", "matrices"])
LENGTH = 24


def problem_of(kind: str, n: int, seed: int) -> tuple[Problem, RowLists]:
    generator = Generator().manual_seed(seed)
    rows = weights(fan_of_preferences(4, CPU)).double()
    rows = rows / rows.sum(dim=1, keepdim=True)  # exactly one, as they are in double
    if kind == "planes":
        costs: Planes | Matrices = Planes(torch.rand(n, 4, generator=generator).double())
        known = None
    else:
        costs = padded_matrices(torch.rand(2, n, n, generator=generator, dtype=torch.float64))
        known = prices_at_knots(costs)
    lists = shortlists(costs, KNOTS, LENGTH, known)
    return priced_problem(costs, rows, known), lists_of_rows(lists, rows)


def joined_once(problem: Problem, fragments: Fragments) -> Fragments:
    candidates = cheapest_candidates(problem.tables, fragments)
    logits = torch.where(candidates.real, -candidates.costs, -NEVER)
    return joined_at_cost(
        problem, fragments, mutual_best(fragments, candidates.positions, logits)
    ).trimmed()


def some_joined(problem: Problem, times: int) -> Fragments:
    fragments = single_cities(problem.tables)
    for _ in range(times):
        fragments = joined_once(problem, fragments)
    return fragments


def steps_of(tour: Tensor) -> set[frozenset[int]]:
    return {frozenset(pair) for pair in zip(tour.tolist(), tour.roll(1).tolist(), strict=True)}


def by_cost(candidates: Candidates) -> Candidates:
    order = candidates.costs.sort(dim=-1).indices
    return Candidates(*(None if part is None else part.gather(2, order) for part in candidates))


@given(kind=KINDS, n=CITIES, seed=st.integers(0, 1000), times=st.integers(0, 3))
@settings(max_examples=15)
def test_candidates_from_lists_with_room_for_all_are_those_of_all_pairs(
    kind: str, n: int, seed: int, times: int
) -> None:
    problem, lists = problem_of(kind, n, seed)
    fragments = some_joined(problem, times)
    all_rows = torch.ones(len(problem.weights), dtype=torch.bool)
    both = [
        (some_joined(problem, times), listed_candidates(lists, fragments, all_rows)),
        (some_joined(problem, 0), first_of(lists)),
    ]
    for joined, listed in both:
        expected = by_cost(cheapest_candidates(problem.tables, joined))
        found = by_cost(listed)
        # Among all pairs an end's own partner takes a place, too.
        assert (expected.real <= found.real).all()
        assert torch.allclose(found.costs[expected.real], expected.costs[expected.real])
        assert torch.equal(found.positions[expected.real], expected.positions[expected.real])
        if found.leans is not None:
            assert expected.leans is not None
            assert torch.allclose(found.leans[expected.real], expected.leans[expected.real])


@pytest.mark.parametrize("kind", ["planes", "matrices"])
def test_a_list_has_nearly_all_of_the_cheapest_steps(kind: str) -> None:
    problem, lists = problem_of(kind, 100, 1)
    cheapest = cheapest_candidates(problem.tables, single_cities(problem.tables)).costs
    assert (first_of(lists).costs < cheapest + 1e-9).double().mean() > 0.99


@pytest.mark.parametrize("kind", ["planes", "matrices"])
@pytest.mark.parametrize("objectives", [3, 4])
def test_the_lists_of_a_row_of_its_own_have_its_cheapest_steps(kind: str, objectives: int) -> None:
    drawn = torch.rand(50, 2 * objectives, generator=Generator().manual_seed(3)).double()
    rows = weights(fan_or_lattice(4, objectives, CPU)).double()
    if kind == "planes":
        problem = Problem(Planes(drawn), rows)
    else:
        lengths = torch.rand(objectives, 50, 50, generator=Generator().manual_seed(4)).double()
        costs = padded_matrices(lengths)
        problem = Problem(costs, rows, own_prices(costs, rows))
    found = first_of(own_lists(problem, LENGTH))
    expected = cheapest_candidates(problem.tables, single_cities(problem.tables))
    torch.testing.assert_close(found.costs, expected.costs)
    assert torch.equal(found.positions, expected.positions)


def test_in_a_row_out_of_use_nothing_is_listed() -> None:
    problem, lists = problem_of("planes", 8, 1)
    rows = torch.tensor([True, False, True, False])
    candidates = listed_candidates(lists, single_cities(problem.tables), rows)
    assert candidates.real.any(dim=-1).all(dim=-1).tolist() == rows.tolist()


@given(kind=KINDS, n=CITIES, seed=st.integers(0, 1000), times=st.integers(0, 2))
@settings(max_examples=15)
def test_what_is_joined_in_a_contracted_problem_completes_the_tours(
    kind: str, n: int, seed: int, times: int
) -> None:
    problem, _ = problem_of(kind, n, seed)
    fragments = some_joined(problem, times)
    between, solved = contracted(problem, fragments)
    whole = fragments
    while bool((solved.left > 1).any()):
        candidates = cheapest_candidates(between, solved)
        logits = torch.where(candidates.real, -candidates.costs, -NEVER)
        mates = mutual_best(solved, candidates.positions, logits)
        solved = joined_at_cost(between, solved, mates).trimmed()
        whole = joined_once(problem, whole)
    tours = toured(problem, expanded(fragments, solved))
    for row, expected in zip(tours, toured(problem, whole), strict=True):
        assert sorted(row.tolist()) == list(range(n))
        assert steps_of(row) == steps_of(expected)


@given(kind=KINDS, n=CITIES, seed=st.integers(0, 1000), times=st.integers(0, 2))
@settings(max_examples=15)
def test_an_edge_stays_possible_where_it_costs_no_more_than_before(
    kind: str, n: int, seed: int, times: int
) -> None:
    problem, _ = problem_of(kind, n, seed)
    before = some_joined(problem, times)
    candidates = cheapest_candidates(problem.tables, before)
    logits = torch.where(candidates.real, -candidates.costs, -NEVER)
    mates = mutual_best(before, candidates.positions, logits)
    after = joined_at_cost(problem, before, mates)
    costs = cheapest_candidates(problem.tables, after)
    possible = ~no_more_possible(candidates, before, after)
    for row, end, place in candidates.real.nonzero().tolist():
        position = candidates.positions[row, end, place]
        now = costs.costs[row, end][(costs.positions == position)[row, end] & costs.real[row, end]]
        as_cheap = bool((now <= candidates.costs[row, end, place] + 1e-9).any())
        if len(now):
            assert bool(possible[row, end, place]) == as_cheap
