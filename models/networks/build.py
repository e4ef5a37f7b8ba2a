"""The actors by name, and how they are built."""

from collections.abc import Callable

import torch

from models.networks.actor import Actor, Architecture
from models.networks.pa_ad import AdjacencyActor
from models.networks.pa_at import AttentionActor
from models.networks.pa_ean import EANActor
from models.networks.pa_one import OneActor
from models.networks.pa_one_matrix import OneMatrixActor

ACTORS: dict[str, Callable[[Architecture], Actor]] = {
    "pa-one": OneActor,
    "pa-one-matrix": OneMatrixActor,
    "pa-at": AttentionActor,
    "pa-ean": EANActor,
    "pa-ad": AdjacencyActor,
}


def build(config: Architecture, seed: int) -> Actor:
    """Build the actor that the configuration names, with fresh weights drawn from the seed."""
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        return ACTORS[config.name](config)
