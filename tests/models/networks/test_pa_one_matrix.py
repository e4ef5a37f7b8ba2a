"""PA-One for matrices: costs and leans against those of the paths themselves, prices, tours."""

from collections.abc import Callable
from itertools import pairwise

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Generator, Tensor

from models.data.instances import distance_matrices, tour_lengths, uniform_cities
from models.data.preferences import fan_of_preferences, turned_outwards, weights
from models.networks.joining.candidates import (
    Candidates,
    cheapest_candidates,
    joined_at_cost,
    single_cities,
    toured,
)
from models.networks.joining.costs import Costs, Matrices, Prices, padded_matrices, weighted_costs
from models.networks.joining.fragments import NEVER, Fragments, mutual_best
from models.networks.joining.prices import prices_at_knots, prices_between
from models.networks.joining.repairs import cut, repair_problem
from models.networks.pa_one_matrix import OneMatrixActor
from tests.helpers.small_actors import CPU, small_actor

Length = Callable[[list[int]], float]


def matrices(n: int, seed: int) -> Tensor:
    drawn = torch.rand(2, n, n, generator=Generator().manual_seed(seed), dtype=torch.float64)
    return drawn * (1 - torch.eye(n, dtype=torch.float64))


def length_in(table: Tensor) -> Length:
    return lambda path: sum(float(table[a, b]) for a, b in pairwise(path))


def path_at(paths: list[list[int]], city: int) -> list[int]:
    """The path that ends at this city, which is an end of one."""
    path = next(path for path in paths if city in (path[0], path[-1]))
    return path if path[-1] == city else path[::-1]


def check_candidates(
    length: Length, paths: list[list[int]], fragments: Fragments, candidates: Candidates
) -> None:
    """Each edge costs what the cheaper way through both paths costs above those through each."""
    assert candidates.leans is not None
    for end, count in candidates.real[0].nonzero().tolist():
        city = int(fragments.ends[0, end])
        other = int(fragments.ends[0, candidates.positions[0, end, count]])
        one, two = path_at(paths, city), path_at(paths, other)[::-1]
        there, back = length(one + two), length((one + two)[::-1])
        alone = sum(min(length(path), length(path[::-1])) for path in (one, two))
        assert float(candidates.costs[0, end, count]) == pytest.approx(min(there, back) - alone)
        assert float(candidates.leans[0, end, count]) == pytest.approx((there - back) / 2)


def after_joining(paths: list[list[int]], fragments: Fragments, mates: Tensor) -> list[list[int]]:
    for end, mate in enumerate(mates[0].tolist()):
        if mate > end:
            one = path_at(paths, int(fragments.ends[0, end]))
            two = path_at(paths, int(fragments.ends[0, mate]))[::-1]
            gone = [set(one), set(two)]
            paths = [path for path in paths if set(path) not in gone] + [one + two]
    return paths


@given(n=st.integers(3, 10), seed=st.integers(0, 1000), trims=st.booleans())
@settings(max_examples=15)
def test_edges_cost_what_the_cheaper_way_through_both_paths_does(
    n: int, seed: int, trims: bool
) -> None:
    drawn, row = matrices(n, seed), torch.tensor([[0.25, 0.75]], dtype=torch.float64)
    costs = weighted_costs(padded_matrices(drawn).tables, row)
    length = length_in(0.25 * drawn[0] + 0.75 * drawn[1])
    fragments, paths = single_cities(costs), [[city] for city in range(n)]
    while int(fragments.left) > 1:
        candidates = cheapest_candidates(costs, fragments)
        check_candidates(length, paths, fragments, candidates)
        logits = torch.where(candidates.real, -candidates.costs, -NEVER)
        mates = mutual_best(fragments, candidates.positions, logits)
        paths = after_joining(paths, fragments, mates)
        fragments = joined_at_cost(costs, fragments, mates)
        fragments = fragments.trimmed() if trims else fragments
    tour = toured(costs, fragments)[0].tolist()
    assert sorted(tour) == list(range(n))
    assert length([*tour, tour[0]]) <= length([tour[0], *tour[::-1]]) + 1e-9


def priced(costs: Matrices, rows: Tensor) -> Prices:
    return prices_between(rows, prices_at_knots(costs))


def whole(costs: Costs) -> Tensor:
    assert costs.leans is not None
    n = costs.means.shape[1]
    return (costs.means + costs.leans)[:, :, :n]


@given(n=st.integers(2, 12), seed=st.integers(0, 1000))
@settings(max_examples=20)
def test_prices_change_the_cost_of_all_tours_of_a_row_by_the_same(n: int, seed: int) -> None:
    costs, rows = padded_matrices(matrices(n, seed)), weights(fan_of_preferences(4, CPU)).double()
    tours = torch.stack([torch.randperm(n) for _ in range(5)])
    plain, less = (
        whole(weighted_costs(costs.tables, rows)),
        whole(weighted_costs(costs.tables, rows, priced(costs, rows))),
    )
    differences = torch.stack(
        [(plain - less)[:, tour, tour.roll(-1)].sum(dim=1) for tour in tours], dim=1
    )
    assert torch.allclose(differences, differences[:, :1].expand_as(differences))


def test_the_logits_of_edges_that_cost_less_than_nothing_are_finite() -> None:
    """Prices may be too high, also for the edge that would close a path to a tour."""
    actor = small_actor("pa-one-matrix")
    assert isinstance(actor, OneMatrixActor)
    tables = padded_matrices(matrices(12, 3).float() - 10.0).tables
    costs = weighted_costs(tables, torch.tensor([[0.5, 0.5]]))
    fragments = single_cities(costs)
    while int(fragments.left) > 2:
        candidates = cheapest_candidates(costs, fragments, actor.candidates)
        logits = actor.edge_logits(costs, fragments, candidates)
        assert logits.isfinite().all()
        mates = mutual_best(fragments, candidates.positions, logits)
        fragments = joined_at_cost(costs, fragments, mates).trimmed()


def test_prices_of_symmetric_matrices_do_not_lean() -> None:
    cities = uniform_cities(1, 30, Generator().manual_seed(1), CPU).double()
    costs = padded_matrices(distance_matrices(cities)[0])
    assert priced(costs, weights(fan_of_preferences(3, CPU)).double()).tilts.abs().max() < 1e-9


def test_ends_that_a_cut_leaves_lean_as_their_paths_do() -> None:
    actor = small_actor("pa-one-matrix").double()
    assert isinstance(actor, OneMatrixActor)
    problem = actor.problem(matrices(12, 3), weights(fan_of_preferences(2, CPU)).double())
    tours = torch.stack([torch.randperm(12, generator=Generator().manual_seed(s)) for s in (1, 2)])
    cuts = cut(tours, torch.tensor([[0, 4, 9], [3, 4, 11]]))
    _, fragments = repair_problem(problem, cuts)
    assert fragments.leans is not None
    tables = whole(problem.tables)
    for row, table in enumerate(tables):
        length = length_in(table)
        for k in range(3):
            place, gap = int(cuts.places[row, k]), int(cuts.gaps[row, k])
            if gap > 1:
                path = cuts.tours[row, place + 1 : place + gap + 1].tolist()
                lean = (length(path) - length(path[::-1])) / 2
                assert float(fragments.leans[row, 3 + k]) == pytest.approx(lean)
                assert float(fragments.leans[row, 6 + k]) == pytest.approx(-lean)


@pytest.mark.parametrize("n", [2, 3, 5, 9, 40])
def test_every_tour_visits_every_city_once_and_repairs_make_none_worse(n: int) -> None:
    actor, preferences = small_actor("pa-one-matrix").double(), fan_of_preferences(5, CPU).double()
    assert isinstance(actor, OneMatrixActor)
    drawn = matrices(n, n)
    instance = (drawn / drawn.amax(dim=(1, 2), keepdim=True))[None]
    before = actor.tours(instance, preferences)
    every = torch.arange(n).expand(1, 5, -1)
    assert torch.equal(before.sort(dim=-1).values, every)
    if n > 2:
        after, _ = actor.repaired_tours(instance, preferences, 3)
        assert torch.equal(after.sort(dim=-1).values, every)
        rows = weights(turned_outwards(preferences))
        better, worse = (
            (tour_lengths(instance, tours)[0] * rows).norm(p=8, dim=1) for tours in (after, before)
        )
        assert (better <= 1.00001 * worse).all()


def test_numbering_the_cities_otherwise_changes_the_length_of_no_tour() -> None:
    actor, preferences = small_actor("pa-one-matrix").double(), fan_of_preferences(5, CPU).double()
    instance = matrices(20, 7)[None]
    order = torch.randperm(20, generator=Generator().manual_seed(2))
    renumbered = instance[:, :, order][..., order]
    lengths = tour_lengths(instance, actor.tours(instance, preferences))
    assert torch.allclose(tour_lengths(renumbered, actor.tours(renumbered, preferences)), lengths)
