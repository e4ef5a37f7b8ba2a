"""Features of cities from matrices of costs, for encoders that read matrices.

All begin with the paper's table of initial features of each city: the sum (here the mean, which
does not grow with the number of cities), the least and the largest of its costs. PA-One for
matrices also reads the costs to a few landmarks, from which a city's place shows.
"""

import torch
from jaxtyping import Float
from torch import Tensor

LANDMARKS = 6  # for each objective
_FAR = 1e9  # above every cost of a matrix whose largest entry is one


def unit_matrices(matrices: Float[Tensor, "b 2 n n"]) -> Float[Tensor, "b 2 n n"]:
    """Return the matrices with an empty diagonal, each divided by its largest entry."""
    emptied = torch.where(_diagonal(matrices), 0.0, matrices)
    largest = emptied.amax(dim=(-2, -1), keepdim=True)
    return emptied / torch.where(largest > 0, largest, 1.0)


def spacing(matrices: Float[Tensor, "b 2 n n"]) -> Float[Tensor, "b 1 1 1"]:
    """Return twice the cost of the cheapest step from a city, its mean over cities and objectives.

    For cities uniform in a unit square that is near 1 / sqrt(n).
    """
    cheapest = torch.where(_diagonal(matrices), _FAR, matrices).amin(dim=-1)  # (b, 2, n)
    mean = matrices.mean(dim=(1, 2, 3))
    # Where most cities coincide the cheapest steps say nothing.
    return (2 * torch.maximum(cheapest.mean(dim=(1, 2)), mean / 100) + 1e-9)[:, None, None, None]


def initial_features(matrices: Float[Tensor, "b 2 n n"]) -> Float[Tensor, "b n 2 6"]:
    """Return the mean, least and largest cost of the steps from each city, then of those to it."""
    hidden = torch.where(_diagonal(matrices), _FAR, matrices)
    summaries = [
        summary
        for along in (-1, -2)
        for summary in (matrices.mean(along), hidden.amin(along), matrices.amax(along))
    ]
    return torch.stack(summaries, dim=-1).transpose(1, 2)


def landmark_costs(matrices: Float[Tensor, "b 2 n n"]) -> Float[Tensor, "b n two_l"]:
    """Return the costs to and from a few cities far apart, found for each objective on its own.

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


def _diagonal(matrices: Tensor) -> Tensor:
    index = torch.arange(matrices.shape[-1], device=matrices.device)
    return index[:, None] == index
