"""Candidate edges of PA-One: the cheapest edges from each open end of a path.

A row is one tour under construction, with costs of its own: those of its preference.
"""

from typing import NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

from models.data.instances import distance_matrices
from models.networks.fragments import NEVER, Fragments, all_alone

CANDIDATES = 8  # of an end


class Candidates(NamedTuple):
    """The candidates of each end by ascending cost: positions of other ends, and costs of edges.

    An impossible edge costs NEVER.
    """

    costs: Float[Tensor, "r e c"]
    positions: Int[Tensor, "r e c"]

    @property
    def real(self) -> Bool[Tensor, "r e c"]:
        """Which of the edges are possible."""
        return self.costs < NEVER / 2


def padded_distances(cities: Float[Tensor, "n 4"]) -> Float[Tensor, "2 n m"]:
    """Return the distances in each plane; no city has itself for a neighbour.

    There are as many columns more as an end has candidates, of cities that are never reached.
    """
    distances = distance_matrices(cities[None])[0]
    index = torch.arange(distances.shape[-1], device=cities.device)
    own = torch.where(index == index[:, None], NEVER, 0.0)
    return nn.functional.pad(distances + own, (0, CANDIDATES), value=NEVER)


def weighted_costs(
    distances: Float[Tensor, "2 n m"], weights: Float[Tensor, "r 2"]
) -> Float[Tensor, "r n m"]:
    """Return the cost of each step under the weights of each row."""
    return (weights @ distances.flatten(1)).unflatten(1, distances.shape[1:])


def single_cities(costs: Float[Tensor, "r n m"]) -> Fragments:
    """Return the fragments that a tour of each row begins from: every city alone."""
    return all_alone(costs[:, :, 0])


def first_candidates(costs: Float[Tensor, "r n m"]) -> Candidates:
    """Return the candidates while all cities are alone, for less than `cheapest_candidates`."""
    cheapest, cities = costs.topk(CANDIDATES, largest=False)
    return Candidates(cheapest, torch.where(cheapest < NEVER / 2, cities, 0))


def cheapest_candidates(costs: Float[Tensor, "r n m"], fragments: Fragments) -> Candidates:
    """Return the candidates of each end: the open ends to which an edge costs least."""
    ends, partners, open_ = fragments[:3]
    n = costs.shape[1]
    zeros = torch.zeros_like(costs[:, 0])
    place = torch.where(open_, ends, n)
    closed = (zeros + NEVER).scatter(1, place, torch.where(open_, 0.0, NEVER).to(costs))
    rows = torch.arange(costs.shape[0], device=costs.device)[:, None]
    from_ends = costs.flatten(0, 1).index_select(0, (n * rows + ends).flatten())
    open_costs = from_ends.unflatten(0, ends.shape) + closed[:, None]
    cheapest, cities = open_costs.topk(CANDIDATES, largest=False)
    index = torch.arange(ends.shape[1], device=costs.device).expand_as(ends)
    position = zeros.long().scatter(1, place, index)
    positions = position.gather(1, cities.flatten(1)).view_as(cities)
    impossible = (positions == partners[..., None]) | ~open_[..., None] | (cheapest >= NEVER / 2)
    return Candidates(torch.where(impossible, NEVER, cheapest), positions)


def partner_costs(costs: Float[Tensor, "r n m"], fragments: Fragments) -> Float[Tensor, "r e"]:
    """Return the cost of the edge from each end to its partner, which would close the path."""
    rows = torch.arange(costs.shape[0], device=costs.device)[:, None]
    return costs[rows, fragments.ends, fragments.ends.gather(1, fragments.partners)]
