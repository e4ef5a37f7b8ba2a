"""From matrices of costs to features: the encoders of PA-AD and of PA-One for matrices.

Both begin with what the paper's table of initial features gives of each city: the sum (here the
mean, which does not grow with the number of cities), the least and the largest of its costs.
PA-AD's graph encoder follows Sykora, Ren and Urtasun (2020), arXiv:2007.05096: attention whose
scores are mixed with the matrix. PA-One's sees more: what lies where shows in the costs to a few
landmarks, and its heads attend less the more a step costs, in either direction.
"""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from models.networks.layers import (
    FadingLayer,
    PostNormLayer,
    Seeing,
    SelfAttention,
    feedforward,
    seeing_at_once,
)

LANDMARKS = 6  # for each objective
_FAR = 1e9  # above every cost of a matrix whose largest entry is one


def unit_matrices(matrices: Float[Tensor, "b 2 n n"]) -> Float[Tensor, "b 2 n n"]:
    """The matrices with an empty diagonal, each divided by its largest entry."""
    emptied = torch.where(_diagonal(matrices), 0.0, matrices)
    largest = emptied.amax(dim=(-2, -1), keepdim=True)
    return emptied / torch.where(largest > 0, largest, 1.0)


def spacing(matrices: Float[Tensor, "b 2 n n"]) -> Float[Tensor, "b 1 1 1"]:
    """Twice what the cheapest step from a city costs, in the mean over cities and objectives.

    For cities uniform in a unit square that is near 1 / sqrt(n).
    """
    cheapest = torch.where(_diagonal(matrices), _FAR, matrices).amin(dim=-1)  # (b, 2, n)
    mean = matrices.mean(dim=(1, 2, 3))
    # Where most cities coincide the cheapest steps say nothing.
    return (2 * torch.maximum(cheapest.mean(dim=(1, 2)), mean / 100) + 1e-9)[:, None, None, None]


def initial_features(matrices: Float[Tensor, "b 2 n n"]) -> Float[Tensor, "b n 2 6"]:
    """Mean, least and largest cost of the steps from each city, then of those to it."""
    hidden = torch.where(_diagonal(matrices), _FAR, matrices)
    each = [
        summary
        for along in (-1, -2)
        for summary in (matrices.mean(along), hidden.amin(along), matrices.amax(along))
    ]
    return torch.stack(each, dim=-1).transpose(1, 2)


def landmark_costs(matrices: Float[Tensor, "b 2 n n"]) -> Float[Tensor, "b n two_l"]:
    """Costs to and from a few cities far apart, found for each objective on its own.

    The first is the city farthest from all, each of the others the farthest from those before.
    """
    both_ways = matrices + matrices.mT  # (b, 2, n, n)
    distance = both_ways.mean(dim=-1)  # (b, 2, n), from the landmarks so far; at first from all
    costs = []
    for index in range(LANDMARKS):
        landmark = distance.argmax(dim=-1)[..., None, None]  # (b, 2, 1, 1)
        row = landmark.expand(-1, -1, 1, matrices.shape[-1])
        costs += [matrices.gather(2, row)[:, :, 0], matrices.gather(3, row.mT)[..., 0]]
        nearer = both_ways.gather(2, row)[:, :, 0]
        distance = torch.minimum(distance, nearer) if index else nearer
    return torch.cat(costs, dim=1).transpose(1, 2)


class GraphEncoder(nn.Module):
    """PA-AD's: each objective's matrix on its own, by the same weights; then both side by side."""

    def __init__(self, width: int, heads: int, layers: int, hidden: int) -> None:
        super().__init__()
        self.embed = nn.Linear(3, width)
        self.layers = nn.ModuleList(_MixingLayer(width, heads, hidden) for _ in range(layers))
        self.join = nn.Linear(2 * width, width)

    def forward(self, matrices: Float[Tensor, "b 2 n n"]) -> Float[Tensor, "b n d"]:
        """Features of the cities."""
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
        """Features of the cities."""
        features: Tensor = self.graph(unit_matrices(matrices))
        for layer in self.layers:
            features = layer(features)
        return features


class MatrixEncoder(nn.Module):
    """PA-One's for matrices: for a city its costs in sum and to the landmarks, and the weights.

    Axis bg is instances and groups of preferences, groups inner.
    """

    seeing: Seeing

    def __init__(self, width: int, heads: int, layers: int, hidden: int) -> None:
        super().__init__()
        given = 2 * 6 + 4 * LANDMARKS
        self.embed = nn.Linear(2 * given + 2, width)
        self.layers = nn.ModuleList(
            FadingLayer(width, heads, hidden, _KINDS) for _ in range(layers)
        )
        self.norm = nn.LayerNorm(width)
        self.seeing = seeing_at_once

    def forward(
        self,
        matrices: Float[Tensor, "b 2 n n"],
        unit: Float[Tensor, "b 1 1 1"],
        weights: Float[Tensor, "g 2"],
    ) -> Float[Tensor, "bg n d"]:
        """Features of the cities for each of the weights, costs near the unit being near."""
        sums = initial_features(matrices)
        landmarks = landmark_costs(matrices).unflatten(-1, (-1, 2)).mT  # (b, n, 2, 2 l)
        given = torch.cat((sums, landmarks), dim=-1).repeat_interleave(len(weights), dim=0)
        spread = weights.repeat(len(matrices), 1)[:, None].expand(-1, matrices.shape[-1], -1)
        weighted = given * spread[..., None]
        told = torch.cat((given.flatten(2), weighted.flatten(2), spread), dim=-1)
        features: Tensor = self.embed(told)
        costs = matrices / unit
        see = self.seeing(torch.stack((costs, costs.mT), dim=1), weights)
        for layer in self.layers:
            features = layer(features, see)
        normalised: Tensor = self.norm(features)
        return normalised


# How fast each kind of head fades at first: with the first cost, the second, their weighted sum,
# of the steps from the city, and of those to it.
_KINDS = (
    (2.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (0.0, 2.0, 0.0, 0.0, 0.0, 0.0),
    (0.0, 0.0, 3.0, 0.0, 0.0, 0.0),
    (0.0, 0.0, 0.0, 0.0, 0.0, 3.0),
)


def _diagonal(matrices: Tensor) -> Tensor:
    each = torch.arange(matrices.shape[-1], device=matrices.device)
    return each[:, None] == each
