"""PA-One for matrices: its first cities, and the tours that it begins with."""

import torch
from torch import Generator

from models.config import NetworkConfig
from models.data.instances import distance_matrices, uniform_cities
from models.data.preferences import fan_of_preferences, turned_outwards, weights
from models.networks.pa_one_matrix import OneMatrixActor
from tests.helpers.small_actors import CPU, random_instances, small_actor


def test_tours_of_neighbouring_preferences_begin_at_different_cities() -> None:
    actor = small_actor("pa-one-matrix")
    tours = actor.tours(random_instances(actor, 1, 7), fan_of_preferences(20, CPU))[0]
    assert tours[:, 0].tolist() == [row % 7 for row in range(20)]


def test_a_new_pa_one_for_matrices_goes_to_the_nearest_neighbour_under_the_weights() -> None:
    actor = OneMatrixActor(NetworkConfig(name="pa-one-matrix")).eval()
    # Without what the pointers and the preferences add at random, costs alone are left.
    actor.decoder.project_city.weight.data[-128:] = 0
    actor.decoder.encode_preference[-1].weight.data.zero_()
    matrices = distance_matrices(uniform_cities(1, 30, Generator().manual_seed(0), CPU))
    matrices = matrices / matrices.amax(dim=(-2, -1), keepdim=True)
    preference = torch.tensor([[0.6, 0.8]])
    tour = actor.tours(matrices, preference)[0, 0]
    cost = (matrices[0] * weights(turned_outwards(preference))[0, :, None, None]).sum(dim=0)
    for t in range(29):
        left = tour[t + 1 :]
        assert tour[t + 1] == left[cost[tour[t], left].argmin()]
