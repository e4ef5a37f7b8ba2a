"""Contraction: make a smaller problem when few ends are open, and join its solution.

The smaller problem has no cities inside paths. Its ends get new numbers, and every pair of ends has
a cost. So the time of a round depends only on the number of open ends.
"""

import torch
from jaxtyping import Int
from torch import Tensor

from models.networks.joining.costs import Costs, Problem, costs_between
from models.networks.joining.fragments import Fragments


def contracted(problem: Problem, fragments: Fragments) -> tuple[Costs, Fragments]:
    """Return the costs between the ends, and the fragments with ends for cities.

    A path becomes an edge between its ends.
    """
    cities, partners = fragments.ends, fragments.partners
    index = torch.arange(cities.shape[1], device=cities.device).expand_as(cities)
    none = torch.full_like(index, -1)
    across = torch.where(fragments.on_paths, partners, none)
    links = torch.cat((across, none, none[:, :1]), dim=1)
    between = costs_between(problem, cities)
    return between, fragments._replace(ends=index, links=links)


def expanded(fragments: Fragments, solved: Fragments) -> Fragments:
    """Return the fragments, joined as they are in the solution of the contracted problem."""
    cities = fragments.ends
    e, n = cities.shape[1], (fragments.links.shape[1] - 1) // 2
    first, second = solved.links[:, :e], solved.links[:, e : 2 * e]
    alone = fragments.open & ~fragments.on_paths
    links = _linked(
        fragments.links, torch.where(alone & (first >= 0), cities, 2 * n), cities, first
    )
    places = torch.where(fragments.open & (second >= 0), cities + n, 2 * n)
    links = _linked(links, places, cities, second)
    return solved._replace(ends=cities.gather(1, solved.ends), links=links)


def _linked(
    links: Int[Tensor, "r l"],
    places: Int[Tensor, "r e"],
    cities: Int[Tensor, "r e"],
    mates: Int[Tensor, "r e"],
) -> Int[Tensor, "r l"]:
    return links.scatter(1, places, cities.gather(1, mates.clamp(min=0)))
