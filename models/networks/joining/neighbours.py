"""Look up the features of an end's candidates and partner in tables."""

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from models.networks.joining.candidates import Candidates

EDGE = 4  # hidden features of an edge


class Neighbours:
    """Lookups of features of other ends of the same row; zeros for impossible candidates.

    Axis x is rows and ends, ends inner.
    """

    def __init__(self, candidates: Candidates, partners: Int[Tensor, "r e"]) -> None:
        r, e, c = candidates.positions.shape
        first = e * torch.arange(r, device=partners.device)
        of_candidates = candidates.positions + first[:, None, None]
        self._candidates = torch.where(candidates.real, of_candidates, r * e).flatten()
        self._partners = (partners + first[:, None]).flatten()
        self._count = c

    def side_by_side(self, features: Float[Tensor, "x d"]) -> Float[Tensor, "x c_d"]:
        """Return the features of each end's candidates, one candidate after the other."""
        return self._of_candidates(features).view(-1, self._count * features.shape[1])

    def summed(
        self, features: Float[Tensor, "x d"], own: Float[Tensor, "x d"]
    ) -> Float[Tensor, "x c d"]:
        """Return the features of each end's candidates, plus the features of the end itself.

        ONNX Runtime adds tables of one shape ten times as fast as it repeats rows so short, and
        repeats them fastest by a product.
        """
        theirs = self._of_candidates(features).view(-1, self._count, features.shape[1])
        once = torch.eye(own.shape[1], dtype=own.dtype, device=own.device)
        return theirs + (own @ once.repeat(1, self._count)).view_as(theirs)

    def _of_candidates(self, features: Float[Tensor, "x d"]) -> Float[Tensor, "x_c d"]:
        table = nn.functional.pad(features, (0, 0, 0, 1))
        return table.index_select(0, self._candidates)

    def partners_of(self, features: Float[Tensor, "x d"]) -> Float[Tensor, "x d"]:
        """Return the features of each end's partner."""
        return features.index_select(0, self._partners)


def of_both_ends(
    of_ends: Float[Tensor, "x d"], near: Neighbours, directions: Float[Tensor, "r e c"] | None
) -> Float[Tensor, "x c f"]:
    """Return the same values for an edge from both its ends: the sum of the values of both.

    Where edges have directions, ends say another thing as well, that they start it or end it.
    """
    if directions is None:
        return near.summed(of_ends, of_ends)
    signs = torch.tensor([1.0, -1.0], device=of_ends.device).repeat_interleave(EDGE)
    both, apart = near.summed(of_ends, signs * of_ends).split(EDGE, dim=-1)
    towards = torch.cat([directions.flatten(0, 1)[..., None]] * EDGE, dim=-1)
    return both + towards * apart
