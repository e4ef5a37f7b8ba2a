"""Preferences as tensors: fans and random spreads of them, their weights, and groups of neighbours.

A preference is a unit vector in the objective space, (cos a, sin a) of angle a under two
objectives, along which the lengths of a tour should lie. Everything is drawn from an explicit
generator.
"""

import math
from itertools import count, product
from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Generator, Tensor, nn

# Of 1, 0.9, 0.8 and 0.7 the exponent whose tours point nearest to their preference at 200 cities;
# 0.7 is the best of them at 40 cities, 0.9 at 500.
_EXPONENT = 0.8
_LEAST_WEIGHT = 1e-3  # of an objective: else tours that are as short under the others are alike
FLAT = 2  # objectives, under which a preference is an angle


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


def fan_or_lattice(k: int, objectives: int, device: torch.device) -> Float[Tensor, "l m"]:
    """Return at least k preferences that are spread evenly, for any number of objectives.

    Under two objectives they are the fan of k. Under more, they are the directions of all weights
    that are multiples of 1 / s, for the least s that gives as many: of 100, under three
    objectives, the 105 of the literature.
    """
    if objectives == FLAT:
        return fan_of_preferences(k, device)
    steps = next(s for s in count(1) if math.comb(s + objectives - 1, objectives - 1) >= k)
    multiples = [x for x in product(range(steps + 1), repeat=objectives) if sum(x) == steps]
    return directions_of(torch.tensor(multiples, dtype=torch.float32, device=device) / steps)


def random_preferences(
    k: int, objectives: int, generator: Generator, device: torch.device
) -> Float[Tensor, "k m"]:
    """Draw preferences: a spread under two objectives; under more, their weights are uniform."""
    if objectives == FLAT:
        return spread_preferences(k, generator, device)
    drawn = torch.empty(k, objectives).exponential_(generator=generator)
    return directions_of((drawn / drawn.sum(-1, keepdim=True)).to(device))


def directions_of(rows: Float[Tensor, "k m"]) -> Float[Tensor, "k m"]:
    """Return the unit vectors that go with weights; a weight of zero becomes a small one."""
    return nn.functional.normalize(weights(rows.clamp(min=_LEAST_WEIGHT)), dim=-1)


def weights(preferences: Float[Tensor, "*k m"]) -> Float[Tensor, "*k m"]:
    """Return the weights that go with a direction, adding to 1: see `service.preferences`.

    They are as one over its components, so that a point along it has equal parts in the weighted
    sum: each is the product of the other components, over the sum of these products.
    """
    m = preferences.shape[-1]
    index = torch.arange(m, device=preferences.device)
    others = torch.where(index[:, None] == index, 1.0, preferences[..., None, :]).prod(-1)
    return others / others.sum(-1, keepdim=True)


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
