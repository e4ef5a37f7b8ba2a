"""Candidate edges."""

import torch
from torch import Generator

from models.data.instances import uniform_cities
from models.data.preferences import fan_of_preferences, weights
from models.networks.joining.candidates import cheapest_candidates, first_candidates, single_cities
from models.networks.joining.costs import padded_distances, weighted_costs
from tests.helpers.small_actors import CPU


def test_the_first_candidates_are_the_cheapest() -> None:
    for n in (3, 9, 30):
        cities = uniform_cities(1, n, Generator().manual_seed(n), CPU)[0]
        costs = weighted_costs(padded_distances(cities), weights(fan_of_preferences(4, CPU)))
        first = first_candidates(costs)
        usual = cheapest_candidates(costs, single_cities(costs))
        assert torch.equal(first.real, usual.real)
        assert torch.equal(first.costs[first.real], usual.costs[first.real])
        assert torch.equal(first.positions[first.real], usual.positions[first.real])
