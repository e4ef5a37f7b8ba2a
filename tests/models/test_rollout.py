"""Actors as distributions over tours."""

from itertools import permutations

import pytest
import torch
from torch import Generator, Tensor

from models.config import NetworkConfig
from models.data.instances import distance_matrices
from models.data.sampling import fan_of_preferences, uniform_cities
from models.lagrangian import weights
from models.networks.aiming import aimed
from models.networks.build import Actor, build
from models.networks.stepwise import AttentionDecoder, Moment
from models.rollout import greedily, log_likelihoods, repeated, roll_out, sampling
from models.validation import greedy_tours

CPU = torch.device("cpu")
NAMES = ("pa-at", "pa-ean", "pa-ad", "pa-one-matrix")


def small(name: str, preference_layers: int = 1) -> Actor:
    config = NetworkConfig(
        name=name,
        width=16,
        heads=4,
        layers=2,
        feedforward=32,
        preference_layers=preference_layers,
    )
    actor = build(config, seed=3).eval()
    for parameter in actor.parameters():  # away from the gentle beginning that training needs
        torch.nn.init.normal_(parameter, std=0.2, generator=Generator().manual_seed(5))
    return actor


def cities(count: int, n: int, seed: int = 0) -> Tensor:
    return uniform_cities(count, n, Generator().manual_seed(seed), CPU)


def given(actor: Actor, count: int, n: int) -> Tensor:
    """Instances as the actor reads them; matrices are asymmetric."""
    if actor.reads == "coordinates":
        return cities(count, n)
    return torch.rand(count, 2, n, n, generator=Generator().manual_seed(0))


@pytest.mark.parametrize("name", NAMES)
def test_sampled_tours_visit_every_city_once(name: str) -> None:
    actor = small(name)
    instances = given(actor, 3, 9)
    preferences = fan_of_preferences(5, CPU)
    memory, rows = actor.remember(instances, preferences), actor.decoder.condition(preferences)
    starts = torch.arange(15).reshape(3, 5) % 9
    tours = roll_out(actor, memory, rows, starts, sampling(Generator().manual_seed(1)))
    assert (tours.sort(dim=-1).values == torch.arange(9)).all()


@pytest.mark.parametrize("name", NAMES)
def test_the_likelihoods_of_all_tours_add_to_one(name: str) -> None:
    actor = small(name)
    instances = given(actor, 2, 5)
    free = actor.decoder.chooses_first
    orders = [order for order in permutations(range(5)) if free or order[0] == 0]
    tours = torch.tensor(orders).expand(2, -1, -1)
    preferences = fan_of_preferences(5, CPU)
    rows = repeated(actor.decoder.condition(preferences), len(orders))
    memory = actor.remember(instances, preferences)
    likelihoods = log_likelihoods(actor, memory, rows, tours.repeat(1, 5, 1)).exp()
    sums = likelihoods.unflatten(1, (5, -1)).sum(dim=-1)
    assert torch.allclose(sums, torch.ones(2, 5), atol=1e-5)


@pytest.mark.parametrize("name", NAMES)
def test_sampling_draws_tours_as_often_as_their_likelihood_says(name: str) -> None:
    actor = small(name)
    instances = given(actor, 1, 4)
    many = 4000
    preferences = fan_of_preferences(5, CPU)
    memory, rows = actor.remember(instances, preferences), actor.decoder.condition(preferences)
    starts = torch.zeros(1, 5 * many, dtype=torch.long)
    choose = sampling(Generator().manual_seed(2))
    tours = roll_out(actor, memory, repeated(rows, many), starts, choose)[0, :many]
    for tour in tours.unique(dim=0):
        share = (tours == tour).all(dim=1).double().mean()
        likelihood = log_likelihoods(actor, memory, rows, tour.expand(1, 5, -1))[0, 0].exp().item()
        deviation = (likelihood * (1 - likelihood) / many) ** 0.5
        assert abs(share - likelihood) < 5 * deviation + 1e-6


@pytest.mark.parametrize("name", NAMES)
def test_numbering_the_cities_otherwise_changes_no_tour(name: str) -> None:
    # Sums in another order round otherwise, which is more than the cities of a PA-AD without
    # training differ by. PA-EAN's compiled pointer knows single precision alone.
    precision = torch.float32 if name == "pa-ean" else torch.float64
    actor = small(name).to(precision)
    instances = given(actor, 1, 12).to(precision)
    # Five rows for four preferences begin at the first five cities, which stay what they are.
    order = torch.cat((torch.arange(5), 5 + torch.randperm(7, generator=Generator())))
    preferences = fan_of_preferences(4, CPU).to(precision)
    tours = greedy_tours(actor, instances, preferences)
    if actor.reads == "coordinates":
        other = instances[:, order]
    else:
        other = instances[:, :, order][..., order]
    renumbered = greedy_tours(actor, other, preferences)
    assert torch.equal(order[renumbered], tours)


def test_tours_of_neighbouring_preferences_begin_at_different_cities() -> None:
    actor = small("pa-one-matrix")
    tours = greedy_tours(actor, given(actor, 1, 7), fan_of_preferences(20, CPU))[0]
    assert tours[:, 0].tolist() == [row % 7 for row in range(20)]


@pytest.mark.parametrize("name", ["pa-at", "pa-ean"])
def test_without_a_preference_layer_all_preferences_are_alike(name: str) -> None:
    actor, instances = small(name, preference_layers=0), cities(2, 12)
    tours = greedy_tours(actor, instances, fan_of_preferences(9, CPU))
    assert (tours == tours[:, :1]).all()


def test_a_new_pa_one_for_matrices_goes_to_the_nearest_neighbour_under_the_weights() -> None:
    actor = build(NetworkConfig(name="pa-one-matrix"), seed=1).eval()
    # Without what the pointers and the preferences add at random, costs alone are left.
    actor.decoder.project_city.weight.data[-128:] = 0
    actor.decoder.encode_preference[-1].weight.data.zero_()
    matrices = distance_matrices(cities(1, 30))
    matrices = matrices / matrices.amax(dim=(-2, -1), keepdim=True)
    preference = torch.tensor([[0.6, 0.8]])
    tour = greedy_tours(actor, matrices, preference)[0, 0]
    cost = (matrices[0] * weights(aimed(preference))[0, :, None, None]).sum(dim=0)
    for t in range(29):
        left = tour[t + 1 :]
        assert tour[t + 1] == left[cost[tour[t], left].argmin()]


def test_pa_at_adds_the_preference_to_the_features_of_every_city() -> None:
    """Against the same decoder, fed with features to which the encoding was added by hand."""
    torch.manual_seed(0)
    decoder = AttentionDecoder(width=16, heads=4, clip=10.0)
    features = torch.randn(1, 7, 16)
    preferences = fan_of_preferences(3, CPU)
    recent = torch.tensor([[[2, 0, 7], [4, 3, 0], [6, 1, 7]]])
    moment = Moment(recent, torch.tensor([[0, 0, 1]]), torch.rand(1, 3, 7) < 0.4)
    moment.visited[..., 5] = False
    found = decoder.logits(decoder.remember(features), decoder.condition(preferences), moment)
    nothing = decoder.condition(torch.zeros(1, 2))._replace(
        context=torch.zeros(1, 16),
        ends=torch.zeros(1, 16),
        values=torch.zeros(1, 16),
        pointers=torch.zeros(1, 16),
    )
    for i, encoding in enumerate(decoder.encode_preference(preferences)):
        one = Moment(*(part[:, i : i + 1] for part in moment))
        expected = decoder.logits(decoder.remember(features + encoding), nothing, one)
        assert torch.allclose(found[:, i : i + 1], expected, atol=1e-5)


def test_greedy_takes_the_first_of_equals() -> None:
    assert greedily(torch.tensor([[[0.0, 1.0, 1.0]]])).item() == 1


def test_what_a_step_to_oneself_costs_changes_no_tour_from_matrices() -> None:
    for name in ("pa-ad", "pa-one-matrix"):
        actor = small(name)
        matrices = given(actor, 2, 10)
        other = matrices + 5 * torch.eye(10)
        preferences = fan_of_preferences(5, CPU)
        tours = greedy_tours(actor, matrices, preferences)
        assert torch.equal(greedy_tours(actor, other, preferences), tours)


def test_the_unit_of_the_costs_changes_no_tour_from_matrices() -> None:
    for name in ("pa-ad", "pa-one-matrix"):
        actor = small(name)
        matrices = given(actor, 2, 10)
        other = matrices * torch.tensor([1024.0, 0.25])[:, None, None]
        preferences = fan_of_preferences(5, CPU)
        tours = greedy_tours(actor, matrices, preferences)
        assert torch.equal(greedy_tours(actor, other, preferences), tours)
