"""Preferences in groups of neighbours, for actors that encode the cities once for each group."""

from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor


class Grouped(NamedTuple):
    """Preferences by ascending angle, cut into groups of one size.

    The last preference fills up the last group. Row i holds preference members[i], and
    preference j is in row places[j].
    """

    rows: Float[Tensor, "r 2"]
    members: Int[Tensor, " r"]
    places: Int[Tensor, " k"]


def grouped(preferences: Float[Tensor, "k 2"], groups: int) -> Grouped:
    """The preferences in that many groups. Written so that k stays free when it is exported."""
    k = preferences.shape[0]
    order = preferences[:, 0].argsort(descending=True)
    size = (k + groups - 1) // groups
    filled = torch.arange(groups * size, device=preferences.device).clamp(max=k - 1)
    return Grouped(preferences[order[filled]], order[filled], order.argsort())
