"""The pointer network of DRL-MOA."""

from itertools import permutations

import torch
from torch import Generator, Tensor

from models.data.instances import uniform_cities
from models.networks.pointer_network import PointerActor, build_tours, log_likelihoods
from models.rollout import sampling


def cities(count: int, n: int) -> Tensor:
    return uniform_cities(count, n, Generator().manual_seed(0), torch.device("cpu"))


def actor() -> PointerActor:
    actor = PointerActor(width=16)
    for parameter in actor.parameters():
        torch.nn.init.normal_(parameter, std=0.3, generator=Generator().manual_seed(5))
    return actor


def test_sampled_tours_visit_every_city_once() -> None:
    tours = build_tours(actor(), cities(5, 9), sampling(Generator().manual_seed(1)))
    assert (tours.sort(dim=-1).values == torch.arange(9)).all()


def test_the_likelihoods_of_all_tours_add_to_one() -> None:
    tours = torch.tensor(list(permutations(range(5))))
    likelihoods = log_likelihoods(actor(), cities(1, 5).expand(120, -1, -1), tours).exp()
    assert torch.isclose(likelihoods.sum(), torch.tensor(1.0), atol=1e-5)


def test_sampling_draws_tours_as_often_as_their_likelihood_says() -> None:
    many = 4000
    instances = cities(1, 4).expand(many, -1, -1)
    tours = build_tours(actor(), instances, sampling(Generator().manual_seed(2)))
    for tour in tours.unique(dim=0):
        share = (tours == tour).all(dim=1).double().mean()
        likelihood = log_likelihoods(actor(), instances[:1], tour[None]).exp().item()
        deviation = (likelihood * (1 - likelihood) / many) ** 0.5
        assert abs(share - likelihood) < 5 * deviation + 1e-6


def test_the_pointer_is_the_one_of_its_paper() -> None:
    """Against v tanh(W [e; h]) and v tanh(W [e; c]), written out for one moment."""
    network, instances = actor(), cities(1, 6)
    state = torch.randn(1, 1, 16, generator=Generator().manual_seed(3))
    visited = torch.tensor([[[False, True, False, False, True, False]]])
    features = network.embed_city(instances)[0]
    attended, reference = network.project_city(features).chunk(2, dim=-1)
    attention = torch.tanh(attended + network.project_state(state[0])) @ network.judges[0]
    context = attention.softmax(dim=0) @ features
    expected = torch.tanh(reference + network.project_context(context)) @ network.judges[1]
    found = network.logits(network.remember(instances), state, visited)
    assert torch.allclose(found[~visited], expected[~visited[0, 0]], atol=1e-5)
    assert (found[visited] == -torch.inf).all()
