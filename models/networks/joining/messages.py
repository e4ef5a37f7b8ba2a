"""Messages that the ends of paths send each other."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from models.networks.joining.neighbours import Neighbours
from models.networks.layers import SilenceableLayer, feedforward

_MESSAGE = 4  # features that an end sends its neighbours


class MessagePassingLayer(SilenceableLayer):
    """A layer in which each end reads a message of its partner and of each of its candidates.

    Candidates come by ascending cost, so that one product over all of them side by side treats
    the nearest, the second and so on each in a way of its own.
    """

    def __init__(self, width: int, hidden: int, candidates: int) -> None:
        super().__init__()
        self.tell = nn.Linear(width, _MESSAGE)
        self.think = feedforward(width + (candidates + 1) * _MESSAGE, width, hidden)
        self.silence()

    def silence(self) -> None:
        """Make the layer give back the features as they came, until it is trained."""
        for last in self.think[-1].parameters():
            nn.init.zeros_(last)

    def forward(self, features: Float[Tensor, "x d"], near: Neighbours) -> Float[Tensor, "x d"]:
        """Return the features of the ends, each after the messages of its neighbours."""
        messages = self.tell(features).relu()
        received = near.side_by_side(messages)
        inputs = torch.cat((features, near.partners_of(messages), received), dim=-1)
        change: Tensor = self.think(inputs)
        return features + change
