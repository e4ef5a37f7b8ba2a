"""The actors: distributions over tours, given cities and preferences."""

from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn

from models.config import NetworkConfig
from models.lagrangian import weights
from models.networks.aiming import aimed
from models.networks.groups import Grouped, grouped
from models.networks.layers import AttentionEncoder
from models.networks.matrix_features import AdjacencyEncoder, MatrixEncoder, spacing, unit_matrices
from models.networks.pa_ean import EANDecoder, EANEncoder, EANMemory
from models.networks.pa_one import OneActor
from models.networks.stepwise import AttentionDecoder, AttentionMemory, OneDecoder, OneMemory

# Named tuples of tensors, of a kind that only the actor's own decoder reads.
Memory = Any
Conditioning = Any


class _AlikeForAll(nn.Module):
    """An actor that encodes an instance once, for all preferences alike."""

    groups = 1
    encoder: AttentionEncoder | EANEncoder | AdjacencyEncoder
    decoder: AttentionDecoder | EANDecoder

    def grouped(self, preferences: Float[Tensor, "k 2"]) -> Grouped:
        """The preferences laid out as rows, all in one group."""
        return grouped(preferences, self.groups)

    def remember(
        self,
        instances: Tensor,
        preferences: Float[Tensor, "k 2"],  # noqa: ARG002, the encoder does without
    ) -> AttentionMemory | EANMemory:
        """What decoding needs of the instances, computed once.

        They are cities (b, n, 4) or matrices (b, 2, n, n), whichever the actor reads.
        """
        return self.decoder.remember(self.encoder(instances))


class AttentionActor(_AlikeForAll):
    """PA-AT: the attention network with a preference encoder, as the paper describes it."""

    reads = "coordinates"

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.encoder = AttentionEncoder(
            4, config.width, config.heads, config.layers, config.feedforward
        )
        self.decoder = AttentionDecoder(
            config.width, config.heads, config.clip, config.preference_layers
        )


class EANActor(_AlikeForAll):
    """PA-EAN: Encode, Attend, Navigate with a preference encoder, as the paper describes it."""

    reads = "coordinates"

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.encoder = EANEncoder(config.width, config.heads, config.layers, config.feedforward)
        self.decoder = EANDecoder(config.width, config.clip, config.preference_layers)


class AdjacencyActor(_AlikeForAll):
    """PA-AD: PA-AT behind a graph encoder that reads matrices of costs."""

    reads = "matrices"

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.encoder = AdjacencyEncoder(
            config.width,
            config.heads,
            config.graph_layers,
            config.layers,
            config.feedforward,
        )
        self.decoder = AttentionDecoder(
            config.width, config.heads, config.clip, config.preference_layers
        )


class OneMatrixActor(nn.Module):
    """PA-One for matrices of costs, which need not be symmetric.

    It builds tours city by city, and encodes an instance once for each group of neighbouring
    preferences.
    """

    reads = "matrices"
    groups = 5

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.encoder = MatrixEncoder(config.width, config.heads, config.layers, config.feedforward)
        self.decoder = OneDecoder(config.width, config.heads, config.clip)

    def grouped(self, preferences: Float[Tensor, "k 2"]) -> Grouped:
        """The preferences laid out as rows, and turned so that the tours point where these do."""
        return grouped(aimed(preferences), self.groups)

    def _weights(self, rows: Float[Tensor, "k 2"]) -> Float[Tensor, "g 2"]:
        """The weights in the middle of each group of rows, as `grouped` lays them out."""
        return weights(rows.unflatten(0, (self.groups, -1)).mean(dim=1))

    def remember(
        self, matrices: Float[Tensor, "b 2 n n"], preferences: Float[Tensor, "k 2"]
    ) -> OneMemory:
        """What decoding needs of the instances, computed once for each group of preferences.

        The preferences come as `grouped` lays them out.
        """
        scaled = unit_matrices(matrices)
        unit = spacing(scaled)
        features = self.encoder(scaled, unit, self._weights(preferences))
        return self.decoder.remember(features, scaled / unit)


# Actors that build tours city by city, and one that does not.
StepwiseActor = AttentionActor | EANActor | AdjacencyActor | OneMatrixActor
Actor = StepwiseActor | OneActor
ACTORS: dict[str, type[Actor]] = {
    "pa-at": AttentionActor,
    "pa-ean": EANActor,
    "pa-ad": AdjacencyActor,
    "pa-one": OneActor,
    "pa-one-matrix": OneMatrixActor,
}


def build(config: NetworkConfig, seed: int) -> Actor:
    """The actor that the configuration names, with fresh weights drawn from the seed."""
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        return ACTORS[config.name](config)
