"""PA-One: fragments that are joined until a tour is left."""

from itertools import combinations

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import Generator, Tensor

from models.config import NetworkConfig
from models.data.instances import tour_lengths
from models.data.sampling import fan_of_preferences, uniform_cities
from models.lagrangian import weights
from models.networks.build import build
from models.networks.fragments import (
    NEVER,
    Fragments,
    all_alone,
    best_mates,
    joined,
    possible,
    walked,
)
from models.networks.pa_one import OneActor, begun, by_weight, first_look, look, padded_distances
from models.rollout_pa_one import sampled_tours

CPU = torch.device("cpu")


def small() -> OneActor:
    config = NetworkConfig(name="pa-one", width=16, heads=4, layers=2, feedforward=32)
    actor = build(config, seed=3).eval()
    assert isinstance(actor, OneActor)
    for parameter in actor.parameters():  # away from the gentle beginning that training needs
        torch.nn.init.normal_(parameter, std=0.2, generator=Generator().manual_seed(5))
    return actor


def steps_of(tours: Tensor) -> list[set[frozenset[int]]]:
    """The edges of each tour."""
    pairs = torch.stack((tours, tours.roll(1, dims=-1)), dim=-1).tolist()
    return [{frozenset(pair) for pair in tour} for tour in pairs]


@given(
    cities=st.lists(
        st.tuples(*4 * [st.sampled_from([0.0, 0.25, 0.3, 1.0])]), min_size=2, max_size=25
    )
)
def test_every_tour_visits_every_city_once_wherever_cities_are(
    cities: list[tuple[float, ...]],
) -> None:
    tours = small().tours(torch.tensor([cities]), fan_of_preferences(3, CPU))
    assert torch.equal(tours.sort(dim=-1).values, torch.arange(len(cities)).expand(1, 3, -1))


@pytest.mark.parametrize("n", [2, 3, 8, 9, 100])
def test_every_tour_visits_every_city_once_however_many(n: int) -> None:
    instances = uniform_cities(3, n, Generator().manual_seed(n), CPU)
    tours = small().tours(instances, fan_of_preferences(7, CPU))
    assert torch.equal(tours.sort(dim=-1).values, torch.arange(n).expand(3, 7, -1))


def test_numbering_the_cities_otherwise_changes_no_tour() -> None:
    actor, preferences = small().double(), fan_of_preferences(5, CPU).double()
    instances = uniform_cities(1, 40, Generator().manual_seed(1), CPU).double()
    order = torch.randperm(40, generator=Generator().manual_seed(2))
    renumbered = actor.tours(instances[:, order], preferences)[0]
    assert steps_of(order[renumbered]) == steps_of(actor.tours(instances, preferences)[0])


def test_the_symmetries_of_the_plane_and_its_unit_change_no_tour() -> None:
    actor, preferences = small().double(), fan_of_preferences(5, CPU).double()
    instances = uniform_cities(1, 40, Generator().manual_seed(1), CPU).double()
    expected = steps_of(actor.tours(instances, preferences)[0])
    turned = instances.unflatten(-1, (2, 2)).flip(-1).flatten(2)
    for seen in (turned, 1 - instances, 64 * instances, instances + 5):
        assert steps_of(actor.tours(seen, preferences)[0]) == expected


def test_planes_that_change_places_mirror_the_tours() -> None:
    actor, preferences = small().double(), fan_of_preferences(5, CPU).double()
    instances = uniform_cities(1, 40, Generator().manual_seed(1), CPU).double()
    mirrored = actor.tours(instances.roll(2, dims=-1), preferences.flip(-1))[0]
    assert steps_of(mirrored) == steps_of(actor.tours(instances, preferences)[0])


def greedy_edge(wanted: Tensor) -> set[frozenset[int]]:
    """Edges from the most wanted on, if no city gets three and no cycle closes before the end."""
    n = len(wanted)
    edges = sorted(combinations(range(n), 2), key=lambda edge: -float(wanted[edge]))
    degree, group = [0] * n, list(range(n))
    taken = set()
    for i, j in edges:
        if max(degree[i], degree[j]) < 2 and group[i] != group[j]:
            taken.add(frozenset((i, j)))
            degree[i], degree[j] = degree[i] + 1, degree[j] + 1
            group = [group[i] if g == group[j] else g for g in group]
    return taken


def to_the_end(wanted: Tensor) -> Fragments:
    """Joining by symmetric wishes (r, n, n), all cities candidates of each other."""
    r, n, _ = wanted.shape
    fragments = all_alone(wanted[:, 0])
    candidates = torch.arange(n).expand(r, n, n)
    for _ in range(n):
        wanted = torch.where(possible(fragments, candidates), wanted, -NEVER)
        fragments = joined(fragments, best_mates(fragments, candidates, wanted))
    assert (fragments.left == 1).all()
    return fragments


def symmetric(entries: Tensor) -> Tensor:
    upper = entries.triu(1)
    return upper + upper.mT


@given(n=st.integers(2, 12), seed=st.integers(0, 1000))
def test_joining_what_nothing_better_stands_against_is_greedy_edge(n: int, seed: int) -> None:
    wanted = symmetric(torch.randn(2, n, n, generator=Generator().manual_seed(seed)))
    tours = walked(to_the_end(wanted))
    for tour, wishes in zip(tours, wanted, strict=True):
        path = {frozenset(pair) for pair in zip(tour[:-1].tolist(), tour[1:].tolist(), strict=True)}
        assert path == greedy_edge(wishes)


@given(n=st.integers(2, 12), levels=st.integers(1, 3), seed=st.integers(0, 1000))
def test_equal_wishes_end_in_a_tour_as_well(n: int, levels: int, seed: int) -> None:
    drawn = torch.randint(levels, (3, n, n), generator=Generator().manual_seed(seed)).float()
    tours = walked(to_the_end(symmetric(drawn)))
    assert torch.equal(tours.sort(dim=-1).values, torch.arange(n).expand(3, -1))


def test_a_round_joins_a_fragment_to_one_other_at_most() -> None:
    # Cities 0-1 and 2-3 are paths; both ends of one want an end of the other most.
    wanted = torch.full((1, 4, 4), -NEVER)
    for i, j, wish in ((0, 2, 5.0), (1, 3, 4.0)):
        wanted[0, i, j] = wanted[0, j, i] = wish
    candidates = torch.arange(4).expand(1, 4, 4)
    pairs = joined(all_alone(torch.zeros(1, 4)), torch.tensor([[1, 0, 3, 2]]))
    assert best_mates(pairs, candidates, wanted).tolist() == [[2, -1, 0, -1]]


def test_likelier_tours_are_drawn_more_often() -> None:
    """The gradient of the likelihood leads to tours of which more are drawn."""
    actor = small()
    instances = uniform_cities(1, 6, Generator().manual_seed(4), CPU)
    preference = torch.tensor([[0.6, 0.8]])
    costs = weights(preference)[0]

    def mean_cost() -> float:
        tours, _ = sampled_tours(actor, instances, preference, 500, Generator().manual_seed(6))
        return float((tour_lengths(instances, tours) @ costs).mean())

    before = mean_cost()
    optimizer = torch.optim.Adam(actor.parameters(), lr=0.01)
    for seed in range(30):
        tours, likelihoods = sampled_tours(
            actor, instances, preference, 64, Generator().manual_seed(seed)
        )
        lengths = tour_lengths(instances, tours) @ costs
        optimizer.zero_grad()
        ((lengths - lengths.mean()) * likelihoods).mean().backward()
        optimizer.step()
    assert mean_cost() < 0.98 * before


def test_the_first_look_is_as_any_other() -> None:
    for n in (3, 9, 30):
        cities = uniform_cities(1, n, Generator().manual_seed(n), CPU)[0]
        costs = by_weight(padded_distances(cities), weights(fan_of_preferences(4, CPU)))
        first, usual = first_look(costs), look(costs, begun(costs))
        assert torch.equal(first.real, usual.real)
        assert torch.equal(first.costs[first.real], usual.costs[first.real])
        assert torch.equal(first.candidates[first.real], usual.candidates[first.real])
