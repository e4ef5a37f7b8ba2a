"""Small actors without training, and instances as they read them."""

import torch
from torch import Generator, Tensor

from models.config import NetworkConfig
from models.data.instances import uniform_cities
from models.networks.actor import Actor
from models.networks.build import build

CPU = torch.device("cpu")


def small_actor(name: str, preference_layers: int = 1) -> Actor:
    """An actor with random weights, away from the gentle beginning that training needs."""
    config = NetworkConfig(
        name=name,
        width=16,
        heads=4,
        layers=2,
        feedforward=32,
        preference_layers=preference_layers,
    )
    actor = build(config, seed=3).eval()
    for parameter in actor.parameters():
        torch.nn.init.normal_(parameter, std=0.2, generator=Generator().manual_seed(5))
    return actor


def random_instances(actor: Actor, count: int, n: int) -> Tensor:
    """Instances as the actor reads them; matrices are asymmetric."""
    if actor.reads == "coordinates":
        return uniform_cities(count, n, Generator().manual_seed(0), CPU)
    return torch.rand(count, 2, n, n, generator=Generator().manual_seed(0))
