"""Greedy tours of actors that build them city by city."""

import pytest
import torch
from torch import Generator

from models.data.preferences import fan_of_preferences
from tests.helpers.small_actors import CPU, random_instances, small_actor

NAMES = ("pa-at", "pa-ean", "pa-ad")


@pytest.mark.parametrize("name", NAMES)
def test_numbering_the_cities_otherwise_changes_no_tour(name: str) -> None:
    # Sums in another order round otherwise, which is more than the cities of a PA-AD without
    # training differ by. PA-EAN's compiled pointer knows single precision alone.
    precision = torch.float32 if name == "pa-ean" else torch.float64
    actor = small_actor(name).to(precision)
    instances = random_instances(actor, 1, 12).to(precision)
    # Five rows for four preferences begin at the first five cities, which stay what they are.
    order = torch.cat((torch.arange(5), 5 + torch.randperm(7, generator=Generator())))
    preferences = fan_of_preferences(4, CPU).to(precision)
    tours = actor.tours(instances, preferences)
    if actor.reads == "coordinates":
        other = instances[:, order]
    else:
        other = instances[:, :, order][..., order]
    renumbered = actor.tours(other, preferences)
    assert torch.equal(order[renumbered], tours)


@pytest.mark.parametrize("name", ["pa-at", "pa-ean"])
def test_without_a_preference_layer_all_preferences_are_alike(name: str) -> None:
    actor = small_actor(name, preference_layers=0)
    instances = random_instances(actor, 2, 12)
    tours = actor.tours(instances, fan_of_preferences(9, CPU))
    assert (tours == tours[:, :1]).all()


def test_what_a_step_to_oneself_costs_changes_no_tour_from_matrices() -> None:
    for name in ("pa-ad", "pa-one-matrix"):
        actor = small_actor(name)
        matrices = random_instances(actor, 2, 10)
        other = matrices + 5 * torch.eye(10)
        preferences = fan_of_preferences(5, CPU)
        tours = actor.tours(matrices, preferences)
        assert torch.equal(actor.tours(other, preferences), tours)


def test_the_unit_of_the_costs_changes_no_tour_from_matrices() -> None:
    for name in ("pa-ad", "pa-one-matrix"):
        actor = small_actor(name)
        matrices = random_instances(actor, 2, 10)
        other = matrices * torch.tensor([1024.0, 0.25])[:, None, None]
        preferences = fan_of_preferences(5, CPU)
        tours = actor.tours(matrices, preferences)
        assert torch.equal(actor.tours(other, preferences), tours)
