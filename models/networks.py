"""The actors: distributions over tours, given cities and preferences."""

from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn

from models.config import NetworkConfig
from models.decoder import AttentionDecoder, AttentionMemory, OneDecoder, OneMemory
from models.encoders import AttentionEncoder, DistanceAwareEncoder, plane_distances

# Named tuples of tensors, of a kind that only the actor's own decoder reads.
Memory = Any
Conditioning = Any


class AttentionActor(nn.Module):
    """PA-AT: the attention network with a preference encoder, as the paper describes it."""

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.encoder = AttentionEncoder(
            config.width, config.heads, config.layers, config.feedforward
        )
        self.decoder = AttentionDecoder(config.width, config.heads, config.clip)

    def remember(self, cities: Float[Tensor, "b n 4"]) -> AttentionMemory:
        """What decoding needs of the instances, computed once."""
        return self.decoder.remember(self.encoder(cities))


class OneActor(nn.Module):
    """PA-One: distances in the encoder's attention and in the decoder's logits."""

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.encoder = DistanceAwareEncoder(
            config.width, config.heads, config.layers, config.feedforward
        )
        self.decoder = OneDecoder(config.width, config.heads, config.clip)

    def remember(self, cities: Float[Tensor, "b n 4"]) -> OneMemory:
        """What decoding needs of the instances, computed once."""
        distances = plane_distances(cities)
        log_distances = distances.log1p()
        features = self.encoder(cities, log_distances)
        return self.decoder.remember(features, distances, log_distances)


Actor = AttentionActor | OneActor
ACTORS: dict[str, type[Actor]] = {"pa-at": AttentionActor, "pa-one": OneActor}


def build(config: NetworkConfig, seed: int) -> Actor:
    """The actor that the configuration names, with fresh weights drawn from the seed."""
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        return ACTORS[config.name](config)
