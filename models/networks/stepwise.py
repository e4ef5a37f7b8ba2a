"""Decode tours city by city: the state of tours under construction, and the base of decoders.

A *row* is one tour under construction. When finished tours are scored, it is one moment of a tour:
the same method of a decoder does both.
"""

from abc import ABC, abstractmethod
from typing import Any, NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

# Named tuples of tensors, of a kind that only one decoder reads: its tables of the instances, and
# what each preference does to the rows.
Memory = Any
Conditioning = Any


class Moment(NamedTuple):
    """The state of each row: its last three cities, latest first; its first; those visited.

    Index n stands for a city that is not chosen yet.
    """

    recent: Int[Tensor, "b r 3"]
    first: Int[Tensor, "b r"]
    visited: Bool[Tensor, "b r n"]

    @property
    def current(self) -> Int[Tensor, "b r"]:
        """The city that each row is at."""
        return self.recent[..., 0]


class Decoder(nn.Module, ABC):
    """The part of an actor that chooses the next city of each row.

    It shares its tables of an instance among all preferences, so that a step for k preferences
    is a few products of a (k, d) with a (d, n) matrix.
    """

    chooses_first: bool  # or whether tours start at cities that are given

    @abstractmethod
    def condition(self, preferences: Float[Tensor, "k 2"]) -> Conditioning:
        """Return what each preference does to the rows."""

    @abstractmethod
    def logits(self, memory: Memory, rows: Conditioning, moment: Moment) -> Float[Tensor, "b r n"]:
        """Return unnormalised log-probabilities of the next city; minus infinity where visited."""


# exp(-80) is still a normal float32, and no share of a sum of float32 that begins with 1.
_NEGLIGIBLE = 80.0


def keys_values_pointers(
    projected: Float[Tensor, "b n three_d"], heads: int
) -> tuple[Float[Tensor, "b h e n"], Float[Tensor, "b h n e"], Float[Tensor, "b d n"]]:
    """Split a projection of the cities; scaled and laid out so that a step only multiplies."""
    keys, values, pointers = projected.chunk(3, dim=-1)
    width = keys.shape[-1]
    return (
        keys.unflatten(-1, (heads, -1)).permute(0, 2, 3, 1) * (heads / width) ** 0.5,
        values.unflatten(-1, (heads, -1)).transpose(1, 2),
        pointers.mT / width**0.5,
    )


def look_up(table: Float[Tensor, "b m d"], index: Int[Tensor, "b r"]) -> Float[Tensor, "b r d"]:
    """Return, for each instance, the rows of its table that the index names."""
    b, m, d = table.shape
    flat = index + m * torch.arange(b, device=index.device)[:, None]
    return table.reshape(-1, d).index_select(0, flat.flatten()).view(b, -1, d)


def glimpse_of(
    query: Float[Tensor, "b r d"],
    keys: Float[Tensor, "b h e n"],
    values: Float[Tensor, "b h n e"],
    mask: Float[Tensor, "b r n"],
) -> Float[Tensor, "b r d"]:
    """Return the multi-head attention of rows to cities; the mask is added to the scores."""
    heads = query.unflatten(-1, (keys.shape[1], -1)).transpose(1, 2)
    scores = heads @ keys + mask[:, None]
    if torch.compiler.is_exporting():
        # ONNX Runtime's exponential of minus infinity is a subnormal number, with which a
        # processor is some fourteen times slower; this far below the largest is as good as zero.
        scores = torch.maximum(scores, scores.amax(dim=-1, keepdim=True) - _NEGLIGIBLE)
    seen = scores.softmax(dim=-1) @ values
    return seen.transpose(1, 2).flatten(2)
