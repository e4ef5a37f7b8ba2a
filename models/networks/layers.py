"""Layers of the encoders: attention of several kinds, feed-forward, preference encoders.

PA-AT's encoder is that of Kool, van Hoof and Welling (2019), arXiv:1803.08475.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable

from jaxtyping import Float
from torch import Tensor, nn

# Attention: from queries, keys and values to the sums of each head, all (b, h, n, d / h).
See = Callable[[Tensor, Tensor, Tensor], Tensor]


def see(
    query: Float[Tensor, "b h n e"],
    key: Float[Tensor, "b h n e"],
    value: Float[Tensor, "b h n e"],
    bias: Float[Tensor, "b h n n"] | None = None,
) -> Float[Tensor, "b h n e"]:
    """Return scaled dot-product attention; the bias is added to the scores."""
    scores = query @ key.mT / query.shape[-1] ** 0.5
    return (scores if bias is None else scores + bias).softmax(dim=-1) @ value


class SelfAttention(nn.Module):
    """Multi-head attention among the cities of an instance."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.project = nn.Linear(width, 3 * width, bias=False)
        self.merge = nn.Linear(width, width, bias=False)

    def forward(self, features: Float[Tensor, "b n d"], see: See = see) -> Float[Tensor, "b n d"]:
        """Return the view that each city has of all cities."""
        parts = (
            part.unflatten(-1, (self.heads, -1)).transpose(1, 2)
            for part in self.project(features).chunk(3, dim=-1)
        )
        merged: Tensor = self.merge(see(*parts).transpose(1, 2).flatten(2))
        return merged


def feedforward(width: int, out: int, hidden: int) -> nn.Sequential:
    """Return two linear layers with a rectifier between them."""
    return nn.Sequential(nn.Linear(width, hidden), nn.ReLU(), nn.Linear(hidden, out))


def preference_encoder(width: int, layers: int) -> nn.Module:
    """Return the paper's encoder, one linear layer from (k, 2) to (k, d), or one without layers."""
    return nn.Linear(2, width) if layers else _ZeroEncoder(width)


class _ZeroEncoder(nn.Module):
    """An encoder to which all preferences are alike."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.width = width

    def forward(self, preferences: Float[Tensor, "k 2"]) -> Float[Tensor, "k d"]:
        return preferences.new_zeros(len(preferences), self.width)


class AttentionEncoder(nn.Module):
    """The encoder of Kool et al.: an embedding and layers of attention and feed-forward."""

    def __init__(self, inputs: int, width: int, heads: int, layers: int, hidden: int) -> None:
        super().__init__()
        self.embed = nn.Linear(inputs, width)
        self.layers = nn.ModuleList(
            PostNormLayer(SelfAttention(width, heads), width, hidden) for _ in range(layers)
        )

    def forward(self, cities: Float[Tensor, "b n g"]) -> Float[Tensor, "b n d"]:
        """Return the features of the cities, from g numbers given of each."""
        features: Tensor = self.embed(cities)
        for layer in self.layers:
            features = layer(features)
        return features


class SilenceableLayer(nn.Module, ABC):
    """A layer with a skip that can begin as the identity, so that a trained stack can grow."""

    @abstractmethod
    def silence(self) -> None:
        """Make the layer give back the features as they came, until it is trained."""


class PostNormLayer(nn.Module):
    """Attention and a feed-forward, each with a skip and then batch normalisation."""

    def __init__(self, attend: nn.Module, width: int, hidden: int) -> None:
        super().__init__()
        self.attend = attend
        self.think = feedforward(width, width, hidden)
        self.norms = nn.ModuleList(nn.BatchNorm1d(width) for _ in range(2))

    def forward(self, features: Float[Tensor, "b n d"]) -> Float[Tensor, "b n d"]:
        """Return the features of the cities, each in view of all."""
        features = self._normalised(0, features + self.attend(features))
        return self._normalised(1, features + self.think(features))

    def _normalised(self, index: int, features: Tensor) -> Tensor:
        normalised: Tensor = self.norms[index](features.transpose(1, 2)).transpose(1, 2)
        return normalised
