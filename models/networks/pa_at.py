"""PA-AT: the attention network with a preference encoder, as the paper describes it.

Encoder and decoder are those of Kool, van Hoof and Welling (2019), arXiv:1803.08475.
"""

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor, nn

from models.networks.actor import Architecture, StepwiseActor
from models.networks.layers import AttentionEncoder, preference_encoder
from models.networks.stepwise import Decoder, Moment, glimpse_of, keys_values_pointers, look_up


class AttentionMemory(NamedTuple):
    """PA-AT's tables of the instances; the ends have one row more, for before the first choice.

    Keys, values and pointers are laid out as `keys_values_pointers` does; e is d / h.
    """

    keys: Float[Tensor, "b h e n"]
    values: Float[Tensor, "b h n e"]
    pointers: Float[Tensor, "b d n"]
    context: Float[Tensor, "b 1 d"]
    current: Float[Tensor, "b n+1 d"]
    first: Float[Tensor, "b n+1 d"]


class AttentionConditioning(NamedTuple):
    """The part of a preference in the projections of every city, and so in PA-AT's rows."""

    context: Float[Tensor, "r d"]
    ends: Float[Tensor, "r d"]
    values: Float[Tensor, "r d"]
    pointers: Float[Tensor, "r d"]


class AttentionDecoder(Decoder):
    """Kool et al.'s decoder with the paper's preference encoder: one layer, added to the graph.

    Adding the encoding e of a preference to the features of every city adds W e to every key,
    value and pointer. The same addition to all keys leaves attention as it was; values and
    pointers get theirs after the products, so that the tables stay shared. The actor chooses
    the first city too, from a learned placeholder.
    """

    chooses_first = True

    def __init__(self, width: int, heads: int, clip: float, preference_layers: int = 1) -> None:
        super().__init__()
        self.heads, self.clip = heads, clip
        self.encode_preference = preference_encoder(width, preference_layers)
        self.placeholder = nn.Parameter(torch.empty(2, 1, 1, width).uniform_(-1, 1))
        self.project_context = nn.Linear(width, width, bias=False)
        self.project_ends = nn.Linear(width, 2 * width, bias=False)
        self.project_city = nn.Linear(width, 3 * width, bias=False)
        self.merge = nn.Linear(width, width, bias=False)

    def remember(self, features: Float[Tensor, "b n d"]) -> AttentionMemory:
        """Compute the tables of the instances."""
        current, first = (
            torch.cat((table, opening.expand(len(table), -1, -1)), dim=1)
            for table, opening in zip(
                self.project_ends(features).chunk(2, dim=-1), self.placeholder, strict=True
            )
        )
        context = self.project_context(features.mean(dim=1, keepdim=True))
        tables = keys_values_pointers(self.project_city(features), self.heads)
        return AttentionMemory(*tables, context, current, first)

    def condition(self, preferences: Float[Tensor, "k 2"]) -> AttentionConditioning:
        """Return the part of each preference in the rows."""
        encoding = self.encode_preference(preferences)
        current, first = self.project_ends(encoding).chunk(2, dim=-1)
        _, values, pointers = self.project_city(encoding).chunk(3, dim=-1)
        pointers = pointers / pointers.shape[-1] ** 0.5
        context = self.project_context(encoding)
        return AttentionConditioning(context, current + first, values, pointers)

    def logits(
        self, memory: AttentionMemory, rows: AttentionConditioning, moment: Moment
    ) -> Float[Tensor, "b r n"]:
        """Return unnormalised log-probabilities of the next city; minus infinity where visited."""
        begun = (moment.current < moment.visited.shape[-1])[..., None]
        ends = look_up(memory.current, moment.current) + look_up(memory.first, moment.first)
        query = memory.context + rows.context + ends + begun * rows.ends
        mask = torch.zeros_like(moment.visited, dtype=query.dtype)
        mask = mask.masked_fill(moment.visited, -torch.inf)
        glimpse = glimpse_of(query, memory.keys, memory.values, mask)
        glimpse = self.merge(glimpse + rows.values)
        shift = (glimpse * rows.pointers).sum(-1, keepdim=True)
        return self.clip * torch.tanh(glimpse @ memory.pointers + shift) + mask


class AttentionActor(StepwiseActor):
    """PA-AT."""

    reads = "coordinates"
    encoder: AttentionEncoder
    decoder: AttentionDecoder

    def __init__(self, config: Architecture) -> None:
        super().__init__()
        self.encoder = AttentionEncoder(
            4, config.width, config.heads, config.layers, config.feedforward
        )
        self.decoder = AttentionDecoder(
            config.width, config.heads, config.clip, config.preference_layers
        )

    def remember(
        self,
        instances: Float[Tensor, "b n 4"],
        preferences: Float[Tensor, "r 2"],  # noqa: ARG002, the encoder does without
    ) -> AttentionMemory:
        """Compute what decoding needs of the instances, once for all preferences."""
        return self.decoder.remember(self.encoder(instances))
