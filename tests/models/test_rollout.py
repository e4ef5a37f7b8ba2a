"""Actors that build tours city by city, as distributions over tours."""

from itertools import permutations

import pytest
import torch
from torch import Generator

from models.data.preferences import fan_of_preferences
from models.networks.actor import StepwiseActor
from models.networks.rows import repeated
from models.rollout import greedily, log_likelihoods, roll_out, sampling
from tests.helpers.small_actors import CPU, random_instances, small_actor

NAMES = ("pa-at", "pa-ean", "pa-ad")


@pytest.mark.parametrize("name", NAMES)
def test_sampled_tours_visit_every_city_once(name: str) -> None:
    actor = small_actor(name)
    assert isinstance(actor, StepwiseActor)
    instances = random_instances(actor, 3, 9)
    preferences = fan_of_preferences(5, CPU)
    memory, rows = actor.remember(instances, preferences), actor.decoder.condition(preferences)
    starts = torch.arange(15).reshape(3, 5) % 9
    tours = roll_out(actor.decoder, memory, rows, starts, sampling(Generator().manual_seed(1)))
    assert (tours.sort(dim=-1).values == torch.arange(9)).all()


@pytest.mark.parametrize("name", NAMES)
def test_the_likelihoods_of_all_tours_add_to_one(name: str) -> None:
    actor = small_actor(name)
    assert isinstance(actor, StepwiseActor)
    instances = random_instances(actor, 2, 5)
    free = actor.decoder.chooses_first
    orders = [order for order in permutations(range(5)) if free or order[0] == 0]
    tours = torch.tensor(orders).expand(2, -1, -1)
    preferences = fan_of_preferences(5, CPU)
    rows = repeated(actor.decoder.condition(preferences), len(orders))
    memory = actor.remember(instances, preferences)
    likelihoods = log_likelihoods(actor.decoder, memory, rows, tours.repeat(1, 5, 1)).exp()
    sums = likelihoods.unflatten(1, (5, -1)).sum(dim=-1)
    assert torch.allclose(sums, torch.ones(2, 5), atol=1e-5)


@pytest.mark.parametrize("name", NAMES)
def test_sampling_draws_tours_as_often_as_their_likelihood_says(name: str) -> None:
    actor = small_actor(name)
    assert isinstance(actor, StepwiseActor)
    instances = random_instances(actor, 1, 4)
    many = 4000
    preferences = fan_of_preferences(5, CPU)
    memory, rows = actor.remember(instances, preferences), actor.decoder.condition(preferences)
    starts = torch.zeros(1, 5 * many, dtype=torch.long)
    choose = sampling(Generator().manual_seed(2))
    tours = roll_out(actor.decoder, memory, repeated(rows, many), starts, choose)[0, :many]
    for tour in tours.unique(dim=0):
        share = (tours == tour).all(dim=1).double().mean()
        likelihood = (
            log_likelihoods(actor.decoder, memory, rows, tour.expand(1, 5, -1))[0, 0].exp().item()
        )
        deviation = (likelihood * (1 - likelihood) / many) ** 0.5
        assert abs(share - likelihood) < 5 * deviation + 1e-6


def test_greedy_takes_the_first_of_equals() -> None:
    assert greedily(torch.tensor([[[0.0, 1.0, 1.0]]])).item() == 1
