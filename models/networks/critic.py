"""The paper's baseline: a network that predicts what the actor will reach."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from models.config import NetworkConfig
from models.data.instances import are_matrices
from models.networks.layers import AttentionEncoder, feedforward
from models.networks.matrix_features import initial_features


class Critic(nn.Module):
    """Predicts the objective of the actor's tour from the cities and the preference."""

    def __init__(self, config: NetworkConfig, reads: str) -> None:
        super().__init__()
        self.encoder = AttentionEncoder(
            4 if reads == "coordinates" else 12,
            config.width,
            config.heads,
            config.layers,
            config.feedforward,
        )
        self.encode_preference = nn.Linear(2, config.width)
        self.judge = feedforward(config.width, 1, hidden=config.width)

    def forward(self, instances: Tensor, preferences: Float[Tensor, "k 2"]) -> Float[Tensor, "b k"]:
        """The prediction for each instance, cities or matrices, and preference."""
        given = instances
        if are_matrices(instances):
            given = initial_features(instances).flatten(2)
        graph = self.encoder(given).mean(dim=1)  # (b, d)
        judged: Tensor = self.judge(
            torch.relu(graph[:, None] + self.encode_preference(preferences))
        )
        return judged.squeeze(-1)
