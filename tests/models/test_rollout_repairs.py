"""Repaired tours of PA-One: that they are tours, and each row's is the best for it."""

import itertools
from functools import cache
from pathlib import Path

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Generator, Tensor

from models.checkpoint import load_weights
from models.data.instances import tour_lengths, uniform_cities
from models.data.preferences import fan_of_preferences, turned_outwards, weights
from models.networks.joining.costs import Planes
from models.networks.pa_one import OneActor
from models.rollout_repairs import (
    LATE_FROM,
    cities_to_cut,
    edge_lengths,
    least_costs,
    sizes_of_cut,
)
from service.pareto import nondominated
from tests.helpers.small_actors import CPU

ROOT = Path(__file__).parents[2]


@cache
def released() -> OneActor:
    actor = load_weights(ROOT / "models/checkpoints/pa-one.pt").actor
    assert isinstance(actor, OneActor)
    return actor


def norms_of(instances: Tensor, tours: Tensor, preferences: Tensor) -> Tensor:
    """The norms of the lengths of all tours for each preference, shape (k, t)."""
    rows = weights(turned_outwards(preferences))[:, None].double()
    return (tour_lengths(instances.double(), tours)[0] * rows).norm(p=8, dim=-1)


@settings(max_examples=6)
@given(
    cities=st.lists(
        st.tuples(*4 * [st.sampled_from([0.0, 0.25, 0.3, 1.0])]), min_size=2, max_size=25
    ),
    repairs=st.integers(0, 5),
)
def test_repairs_leave_permutations_and_make_no_tour_worse(
    cities: list[tuple[float, ...]], repairs: int
) -> None:
    instances, preferences = torch.tensor([cities]), fan_of_preferences(5, CPU)
    both = released().repaired_tours(instances, preferences, repairs)
    for tours in both:
        assert torch.equal(tours.sort(dim=-1).values, torch.arange(len(cities)).expand(1, 5, -1))
    before = norms_of(instances, released().tours(instances, preferences), preferences)
    after = norms_of(instances, both[0], preferences)
    assert (after.diagonal() <= 1.00001 * before.diagonal()).all()


def test_after_one_repair_each_row_has_the_best_tour_of_all_for_its_preference() -> None:
    instances, preferences = uniform_cities(1, 40, Generator().manual_seed(5), CPU), fan(30)
    built = released().tours(instances, preferences)
    tours, _ = released().repaired_tours(instances, preferences, 1)
    best = norms_of(instances, built, preferences).amin(dim=1)
    assert (best < norms_of(instances, built, preferences).diagonal()).any()
    assert (norms_of(instances, tours, preferences).diagonal() <= 1.00001 * best).all()


def test_equal_tours_of_two_rows_are_cut_in_different_places_of_their_neighbourhood() -> None:
    cities = uniform_cities(1, 40, Generator().manual_seed(6), CPU)[0]
    problem = released().problem(cities, torch.tensor([[0.5, 0.5]]).expand(2, 2))
    tours, freshness = torch.arange(40).expand(2, 40), torch.ones(2, 40)
    least = least_costs(released().first_candidates(problem))
    for number in (0, LATE_FROM - 1, LATE_FROM):
        sizes = sizes_of_cut(40, number)
        cut = cities_to_cut(problem, least, (tours, freshness), torch.tensor(number), sizes)
        assert cut[0, 0] == cut[1, 0]  # the place
        assert set(cut[0].tolist()) != set(cut[1].tolist())


def test_more_repairs_make_some_tours_better_and_none_worse() -> None:
    instances, preferences = uniform_cities(1, 50, Generator().manual_seed(1), CPU), fan(10)
    norms = [
        norms_of(
            instances, released().repaired_tours(instances, preferences, r)[0], preferences
        ).diagonal()
        for r in (0, 1, 8)
    ]
    for before, after in itertools.pairwise(norms):
        assert (after <= 1.00001 * before).all()
        assert (after < before).any()
    assert norms[-1].mean() < 0.99 * norms[0].mean()


def fan(k: int) -> Tensor:
    return fan_of_preferences(k, CPU)


@pytest.mark.parametrize("n", [2, 30])
def test_no_repairs_are_the_tours_as_built(n: int) -> None:
    instances = uniform_cities(2, n, Generator().manual_seed(2), CPU)
    tours, visited = released().repaired_tours(instances, fan(7), 0)
    assert torch.equal(tours, released().tours(instances, fan(7)))
    assert torch.equal(visited, tours)


def test_visited_tours_add_points_to_the_front() -> None:
    instances = uniform_cities(1, 30, Generator().manual_seed(3), CPU)
    points = [
        tour_lengths(instances, tours)[0]
        for tours in released().repaired_tours(instances, fan(30), 9)
    ]
    alone, together = points[0].double().numpy(), torch.cat(points).double().numpy()
    assert len(nondominated(together)) > len(nondominated(alone))


def test_the_lengths_of_a_tour_are_those_of_its_edges() -> None:
    cities = uniform_cities(1, 12, Generator().manual_seed(4), CPU)
    tours = torch.arange(12)[None].expand(2, -1)
    lengths = edge_lengths(Planes(cities[0]), tours).sum(dim=2).T
    assert torch.allclose(lengths, tour_lengths(cities, tours[None])[0])
