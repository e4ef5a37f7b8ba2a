"""PA-EAN: Encode, Attend, Navigate with the paper's preference encoder.

Encoder and decoder are those of Deudon, Cournut, Lacoste, Adulyasak and Rousseau (2018), Learning
heuristics for the TSP by policy gradient: attention whose projections are rectified, and a
pointer with additive attention whose context is the last three cities. Dropout is left out.
"""

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor, nn

from models.networks.actor import Architecture, StepwiseActor
from models.networks.additive_attention import exponential, pointed
from models.networks.layers import PostNormLayer, preference_encoder
from models.networks.stepwise import Decoder, Moment, look_up


class EANEncoder(nn.Module):
    """The encoder of Deudon et al.: normalised embeddings, then layers as in Kool et al."""

    def __init__(self, width: int, heads: int, layers: int, hidden: int) -> None:
        super().__init__()
        self.embed = nn.Linear(4, width, bias=False)
        self.norm = nn.BatchNorm1d(width)
        self.layers = nn.ModuleList(
            PostNormLayer(RectifiedAttention(width, heads), width, hidden) for _ in range(layers)
        )

    def forward(self, cities: Float[Tensor, "b n 4"]) -> Float[Tensor, "b n d"]:
        """Return the features of the cities."""
        features: Tensor = self.norm(self.embed(cities).transpose(1, 2)).transpose(1, 2)
        for layer in self.layers:
            features = layer(features)
        return features


class RectifiedAttention(nn.Module):
    """Multi-head attention with rectified queries, keys and values, and no merging layer."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.project = nn.Linear(width, 3 * width)

    def forward(self, features: Float[Tensor, "b n d"]) -> Float[Tensor, "b n d"]:
        """Return the view that each city has of all cities."""
        query, key, value = (
            part.unflatten(-1, (self.heads, -1)).transpose(1, 2)  # (b, h, n, d / h)
            for part in self.project(features).relu().chunk(3, dim=-1)
        )
        seen = (query @ key.mT / query.shape[-1] ** 0.5).softmax(dim=-1) @ value
        return seen.transpose(1, 2).flatten(2)


class EANMemory(NamedTuple):
    """PA-EAN's tables of the instances; those of past cities end with a row for "none yet".

    Pointers are the exponentials of projections, see `models.networks.additive_attention`.
    """

    pointers: Float[Tensor, "b p n"]
    last: Float[Tensor, "b n+1 q"]
    second_last: Float[Tensor, "b n+1 q"]
    third_last: Float[Tensor, "b n+1 q"]


class EANConditioning(NamedTuple):
    """The part of a preference in the projections of every city, and so in PA-EAN's rows."""

    past: Float[Tensor, "r 3 q"]
    pointers: Float[Tensor, "r p"]


class EANDecoder(Decoder):
    """Deudon et al.'s pointer; the encoding of a preference is added to the features of all cities.

    A city's score is v . tanh(x + y), with x of the city and y of the row. The tables of the
    cities are shared by all preferences, for a preference's part of x is the same for every city
    and may as well be added to y.
    """

    chooses_first = True

    def __init__(self, width: int, clip: float, preference_layers: int = 1) -> None:
        super().__init__()
        query, pointer = 360 * width // 128, 2 * width  # theirs are 360 and 256, of width 128
        self.clip = clip
        self.encode_preference = preference_encoder(width, preference_layers)
        self.project_past = nn.Linear(width, 3 * query, bias=False)
        self.project_query = nn.Linear(query, pointer, bias=False)
        self.project_city = nn.Linear(width, pointer, bias=False)
        # Small, so that all cities are about as likely at first.
        self.judge = nn.Parameter(torch.empty(pointer).uniform_(-0.1, 0.1) * (3 / pointer) ** 0.5)

    def remember(self, features: Float[Tensor, "b n d"]) -> EANMemory:
        """Compute the tables of the instances."""
        past = nn.functional.pad(self.project_past(features), (0, 0, 0, 1))
        return EANMemory(exponential(self.project_city(features)).mT, *past.chunk(3, dim=-1))

    def condition(self, preferences: Float[Tensor, "k 2"]) -> EANConditioning:
        """Return the part of each preference in the rows."""
        encoding = self.encode_preference(preferences)
        past = self.project_past(encoding).unflatten(-1, (3, -1))
        return EANConditioning(past, self.project_city(encoding))

    def logits(
        self, memory: EANMemory, rows: EANConditioning, moment: Moment
    ) -> Float[Tensor, "b r n"]:
        """Return unnormalised log-probabilities of the next city; minus infinity where visited."""
        n = moment.visited.shape[-1]
        begun = (moment.recent < n).to(rows.past.dtype)
        query = torch.einsum("brt,rtq->brq", begun, rows.past)
        for table, city in zip(memory[1:], moment.recent.unbind(-1), strict=True):
            query = query + look_up(table, city)
        pointing = exponential(self.project_query(query.relu()) + rows.pointers)
        scores = pointed(memory.pointers.mT, pointing, self.judge, moment.visited)
        return (self.clip * torch.tanh(scores)).masked_fill(moment.visited, -torch.inf)


class EANActor(StepwiseActor):
    """PA-EAN."""

    reads = "coordinates"
    encoder: EANEncoder
    decoder: EANDecoder

    def __init__(self, config: Architecture) -> None:
        super().__init__()
        self.encoder = EANEncoder(config.width, config.heads, config.layers, config.feedforward)
        self.decoder = EANDecoder(config.width, config.clip, config.preference_layers)

    def remember(
        self,
        instances: Float[Tensor, "b n 4"],
        preferences: Float[Tensor, "r 2"],  # noqa: ARG002, the encoder does without
    ) -> EANMemory:
        """Compute what decoding needs of the instances, once for all preferences."""
        return self.decoder.remember(self.encoder(instances))
