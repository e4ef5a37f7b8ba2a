"""Preferences as tensors: fans and random spreads of them, their weights, and groups of neighbours.

A preference is a unit vector (cos a, sin a) of angle a in the objective space, along which the
two lengths of a tour should lie. Everything is drawn from an explicit generator.
"""

import math
from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Generator, Tensor

# Of 1, 0.9, 0.8 and 0.7 the exponent whose tours point nearest to their preference at 200 cities;
# 0.7 is the best of them at 40 cities, 0.9 at 500.
_EXPONENT = 0.8


class Groups(NamedTuple):
    """Preferences by ascending angle, cut into groups of one size.

    Copies of the last preference fill up the last group. Row i holds preference members[i], and
    preference j is in row places[j].
    """

    rows: Float[Tensor, "r 2"]
    members: Int[Tensor, " r"]
    places: Int[Tensor, " k"]


def fan_of_preferences(k: int, device: torch.device) -> Float[Tensor, "k 2"]:
    """Return unit vectors at the middles of k equal parts of the open interval (0, 90) degrees."""
    return _directions((torch.arange(k) + 0.5) / k, device)


def spread_preferences(k: int, generator: Generator, device: torch.device) -> Float[Tensor, "k 2"]:
    """Draw one unit vector from each of k equal parts of (0, 90) degrees, uniform in its part."""
    return _directions((torch.arange(k) + torch.rand(k, generator=generator)) / k, device)


def weights(preferences: Float[Tensor, "*k 2"]) -> Float[Tensor, "*k 2"]:
    """Return the weights that go with a direction, adding to 1: see `service.preferences`."""
    return preferences.flip(-1) / preferences.sum(-1, keepdim=True)


def turned_outwards(preferences: Float[Tensor, "k 2"]) -> Float[Tensor, "k 2"]:
    """Turn preferences away from the diagonal, most of them by a few degrees.

    An actor trained by weighted sums builds tours that point closer to the diagonal than the
    preference that the weights go with: by up to three degrees on 200 uniform cities. A share s
    of the way from the diagonal to an axis becomes s ** 0.8, which makes up for it.
    """
    across = (preferences[:, 1] - preferences[:, 0]) / preferences.sum(-1)
    share = torch.atan(across) * (4 / math.pi)  # -1 at the first axis, 1 at the second
    turned = (1 + share.sign() * share.abs() ** _EXPONENT) * (math.pi / 4)
    return torch.stack((turned.cos(), turned.sin()), dim=-1)


def grouped(preferences: Float[Tensor, "k 2"], groups: int) -> Groups:
    """Cut the preferences into that many groups of neighbours.

    Written so that k stays free when a network is exported.
    """
    k = preferences.shape[0]
    order = preferences[:, 0].argsort(descending=True)
    size = (k + groups - 1) // groups
    filled = torch.arange(groups * size, device=preferences.device).clamp(max=k - 1)
    return Groups(preferences[order[filled]], order[filled], order.argsort())


def _directions(shares: Tensor, device: torch.device) -> Float[Tensor, "k 2"]:
    radians = shares * (math.pi / 2)
    return torch.stack((radians.cos(), radians.sin()), dim=-1).to(device)
