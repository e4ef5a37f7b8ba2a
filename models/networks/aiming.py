"""Where to aim, so that tours point where they were asked to."""

import math

import torch
from jaxtyping import Float
from torch import Tensor

# Of 1, 0.9, 0.8 and 0.7 the nearest to what is asked at 200 cities; 0.7 is at 40, 0.9 at 500.
_EXPONENT = 0.8


def aimed(preferences: Float[Tensor, "k 2"]) -> Float[Tensor, "k 2"]:
    """The preferences turned away from the diagonal, most of them by a few degrees.

    An actor trained by weighted sums builds tours that point closer to the diagonal than the
    preference that the weights go with: by up to three degrees on 200 uniform cities. A share s
    of the way from the diagonal to an axis becomes s ** 0.8.
    """
    across = (preferences[:, 1] - preferences[:, 0]) / preferences.sum(-1)
    share = torch.atan(across) * (4 / math.pi)  # -1 at the first axis, 1 at the second
    turned = (1 + share.sign() * share.abs() ** _EXPONENT) * (math.pi / 4)
    return torch.stack((turned.cos(), turned.sin()), dim=-1)
