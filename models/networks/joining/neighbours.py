"""Neighbours: what ends tell each other, by lookups in tables of features."""

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from models.networks.joining.candidates import Candidates

EDGE = 4  # hidden features of an edge


class Neighbours:
    """Lookups of features of other ends of the same row; zeros where a candidate is impossible.

    Axis x is rows and ends, ends inner.
    """

    def __init__(self, candidates: Candidates, partners: Int[Tensor, "r e"]) -> None:
        r, e, c = candidates.positions.shape
        first = e * torch.arange(r, device=partners.device)
        of_candidates = candidates.positions + first[:, None, None]
        self._candidates = torch.where(candidates.real, of_candidates, r * e).flatten()
        self._partners = (partners + first[:, None]).flatten()
        self._count = c

    def candidates_of(self, features: Float[Tensor, "x d"]) -> Float[Tensor, "x c d"]:
        """Return the features of each end's candidates."""
        table = nn.functional.pad(features, (0, 0, 0, 1))
        return table.index_select(0, self._candidates).unflatten(0, (-1, self._count))

    def partners_of(self, features: Float[Tensor, "x d"]) -> Float[Tensor, "x d"]:
        """Return the features of each end's partner."""
        return features.index_select(0, self._partners)

    def for_each_candidate(self, features: Float[Tensor, "x d"]) -> Float[Tensor, "x c d"]:
        """Return the features of each end once for each of its candidates.

        ONNX Runtime adds tables of one shape ten times as fast as it repeats rows so short.
        """
        return features[:, None].repeat(1, self._count, 1)


def of_both_ends(
    of_ends: Float[Tensor, "x d"], near: Neighbours, directions: Float[Tensor, "r e c"] | None
) -> Float[Tensor, "x c f"]:
    """Return the same for an edge seen from either of its ends: the sum of what both say.

    Where edges have directions, ends say another thing as well, that they start it or end it.
    """
    if directions is None:
        return near.candidates_of(of_ends) + near.for_each_candidate(of_ends)
    own, start = (near.for_each_candidate(part) for part in of_ends.chunk(2, dim=-1))
    their_own, their_start = near.candidates_of(of_ends).chunk(2, dim=-1)
    towards = torch.cat([directions.flatten(0, 1)[..., None]] * EDGE, dim=-1)
    return their_own + own + towards * (their_start - start)
