"""Features of cities from matrices of costs, for networks that read matrices.

These are the paper's table of initial features of each city: the sum (here the mean, which does
not grow with the number of cities), the least and the largest of its costs.
"""

import torch
from jaxtyping import Float
from torch import Tensor

_FAR = 1e9  # above every cost of a matrix whose largest entry is one


def unit_matrices(matrices: Float[Tensor, "b m n n"]) -> Float[Tensor, "b m n n"]:
    """Return the matrices with an empty diagonal, each divided by its largest entry."""
    emptied = torch.where(_diagonal(matrices), 0.0, matrices)
    largest = emptied.amax(dim=(-2, -1), keepdim=True)
    return emptied / torch.where(largest > 0, largest, 1.0)


def initial_features(matrices: Float[Tensor, "b m n n"]) -> Float[Tensor, "b n m 6"]:
    """Return the mean, least and largest cost of the steps from each city, then of those to it."""
    hidden = torch.where(_diagonal(matrices), _FAR, matrices)
    summaries = [
        summary
        for along in (-1, -2)
        for summary in (matrices.mean(along), hidden.amin(along), matrices.amax(along))
    ]
    return torch.stack(summaries, dim=-1).transpose(1, 2)


def _diagonal(matrices: Tensor) -> Tensor:
    index = torch.arange(matrices.shape[-1], device=matrices.device)
    return index[:, None] == index
