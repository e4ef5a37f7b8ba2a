"""The critic, the paper's baseline: a network that predicts the actor's objective."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from models.data.instances import are_matrices
from models.networks.actor import Architecture
from models.networks.layers import AttentionEncoder, feedforward
from models.networks.matrix_features import initial_features


class Critic(nn.Module):
    """A predictor of the objective of the actor's tour, from an instance and a preference."""

    def __init__(self, config: Architecture, reads: str, objectives: int = 2) -> None:
        super().__init__()
        self.encoder = AttentionEncoder(
            (2 if reads == "coordinates" else 6) * objectives,
            config.width,
            config.heads,
            config.layers,
            config.feedforward,
        )
        self.encode_preference = nn.Linear(objectives, config.width)
        self.judge = feedforward(config.width, 1, hidden=config.width)

    def forward(self, instances: Tensor, preferences: Float[Tensor, "k m"]) -> Float[Tensor, "b k"]:
        """Return the prediction for each instance, cities or matrices, and preference."""
        features = instances
        if are_matrices(instances):
            features = initial_features(instances).flatten(2)
        graph = self.encoder(features).mean(dim=1)  # (b, d)
        judged: Tensor = self.judge(
            torch.relu(graph[:, None] + self.encode_preference(preferences))
        )
        return judged.squeeze(-1)
