"""PA-AD: PA-AT behind a graph encoder that reads matrices of costs.

The graph encoder follows Sykora, Ren and Urtasun (2020), arXiv:2007.05096: attention whose
scores are mixed with the matrix.
"""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from models.networks.actor import Architecture, StepwiseActor
from models.networks.layers import PostNormLayer, SelfAttention, feedforward
from models.networks.matrix_features import initial_features, unit_matrices
from models.networks.pa_at import AttentionDecoder, AttentionMemory


class GraphEncoder(nn.Module):
    """Encoder of both matrices, each on its own by the same weights, then joined."""

    def __init__(self, width: int, heads: int, layers: int, hidden: int) -> None:
        super().__init__()
        self.embed = nn.Linear(3, width)
        self.layers = nn.ModuleList(_MixingLayer(width, heads, hidden) for _ in range(layers))
        self.join = nn.Linear(2 * width, width)

    def forward(self, matrices: Float[Tensor, "b 2 n n"]) -> Float[Tensor, "b n d"]:
        """Return the features of the cities."""
        initial = initial_features(matrices)[..., :3].transpose(1, 2)  # (b, 2, n, 3)
        features = self.embed(initial.flatten(0, 1))
        for layer in self.layers:
            features = layer(features, matrices.flatten(0, 1))
        stacked = features.unflatten(0, (-1, 2)).transpose(1, 2).flatten(2)  # (b, n, 2 d)
        joined: Tensor = self.join(stacked)
        return joined


class _MixingLayer(nn.Module):
    """Attention along a matrix, and feed-forward, each with a skip and then normalisation."""

    def __init__(self, width: int, heads: int, hidden: int) -> None:
        super().__init__()
        self.heads = heads
        self.project = nn.Linear(width, 3 * width, bias=False)
        self.mix = feedforward(heads + 1, heads, hidden=2 * heads)
        self.merge = nn.Linear(width, width, bias=False)
        self.think = feedforward(width, width, hidden)
        self.norms = nn.ModuleList(nn.LayerNorm(width) for _ in range(2))

    def forward(self, features: Tensor, matrices: Tensor) -> Tensor:
        query, key, value = (
            part.unflatten(-1, (self.heads, -1)).transpose(1, 2)  # (b, h, n, d / h)
            for part in self.project(features).chunk(3, dim=-1)
        )
        scores = query @ key.mT / query.shape[-1] ** 0.5
        mixed = torch.cat((scores, matrices[:, None]), dim=1).movedim(1, -1)  # (b, n, n, h + 1)
        seen = self.mix(mixed).movedim(-1, 1).softmax(dim=-1) @ value
        features = self.norms[0](features + self.merge(seen.transpose(1, 2).flatten(2)))
        thought: Tensor = self.norms[1](features + self.think(features))
        return thought


class AdjacencyEncoder(nn.Module):
    """PA-AD's whole encoder: the graph encoder, then Kool et al.'s layers over both objectives."""

    def __init__(self, width: int, heads: int, graph_layers: int, layers: int, hidden: int) -> None:
        super().__init__()
        self.graph = GraphEncoder(width, heads, graph_layers, hidden)
        self.layers = nn.ModuleList(
            PostNormLayer(SelfAttention(width, heads), width, hidden) for _ in range(layers)
        )

    def forward(self, matrices: Float[Tensor, "b 2 n n"]) -> Float[Tensor, "b n d"]:
        """Return the features of the cities."""
        features: Tensor = self.graph(unit_matrices(matrices))
        for layer in self.layers:
            features = layer(features)
        return features


class AdjacencyActor(StepwiseActor):
    """PA-AD."""

    reads = "matrices"
    encoder: AdjacencyEncoder
    decoder: AttentionDecoder

    def __init__(self, config: Architecture) -> None:
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

    def remember(
        self,
        instances: Float[Tensor, "b 2 n n"],
        preferences: Float[Tensor, "r 2"],  # noqa: ARG002, the encoder does without
    ) -> AttentionMemory:
        """Compute what decoding needs of the instances, once for all preferences."""
        return self.decoder.remember(self.encoder(instances))
