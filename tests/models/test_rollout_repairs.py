"""Repaired tours of PA-One: that they are tours, and none is longer than before."""

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
from models.rollout_repairs import edge_lengths
from service.pareto import nondominated
from tests.helpers.small_actors import CPU

ROOT = Path(__file__).parents[2]


@cache
def released() -> OneActor:
    actor = load_weights(ROOT / "models/checkpoints/pa-one.pt").actor
    assert isinstance(actor, OneActor)
    return actor


def costs_of(instances: Tensor, tours: Tensor, preferences: Tensor) -> Tensor:
    """The lengths of tours, summed under their rows' weights."""
    rows = weights(turned_outwards(preferences))
    return (tour_lengths(instances.double(), tours) * rows).sum(dim=-1)


@settings(max_examples=6)
@given(
    cities=st.lists(
        st.tuples(*4 * [st.sampled_from([0.0, 0.25, 0.3, 1.0])]), min_size=2, max_size=25
    ),
    repairs=st.integers(0, 5),
)
def test_repairs_leave_permutations_and_make_no_tour_longer(
    cities: list[tuple[float, ...]], repairs: int
) -> None:
    instances, preferences = torch.tensor([cities]), fan_of_preferences(5, CPU)
    both = released().repaired_tours(instances, preferences, repairs)
    for tours in both:
        assert torch.equal(tours.sort(dim=-1).values, torch.arange(len(cities)).expand(1, 5, -1))
    before = costs_of(instances, released().tours(instances, preferences), preferences)
    assert (costs_of(instances, both[0], preferences) <= before).all()


def test_more_repairs_make_some_tours_shorter_and_none_longer() -> None:
    instances, preferences = uniform_cities(1, 50, Generator().manual_seed(1), CPU), fan(10)
    costs = [
        costs_of(instances, released().repaired_tours(instances, preferences, r)[0], preferences)
        for r in (0, 1, 8)
    ]
    for before, after in itertools.pairwise(costs):
        assert (after <= before).all()
        assert (after < before).any()
    assert costs[-1].mean() < 0.99 * costs[0].mean()


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
