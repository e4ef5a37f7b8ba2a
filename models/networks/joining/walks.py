"""Walks: find the position of each city on its tour, for all cities at once.

A departure leaves a city for its first or its second neighbour. Departures are numbered like links:
first those of all cities to their first neighbours, then those to their second. After each comes a
departure from the next city, and so on round the tour, in both directions. With pointer jumping
(Wyllie, 1979), each departure sees twice as far ahead in every pass: a thousand cities take ten
passes, not a thousand steps.
"""

from typing import NamedTuple

import torch
from jaxtyping import Bool, Int
from torch import Tensor

from models.networks.joining.fragments import Fragments, first_open


class Walks(NamedTuple):
    """The departure to which each departure looks, and the number of steps until there.

    A walk begins at one departure of each row and ends at the last one, which looks at itself.
    """

    onwards: Int[Tensor, "r d"]
    steps: Int[Tensor, "r d"]
    begin: Int[Tensor, "r 1"]
    last: Int[Tensor, "r 1"]


def begun(
    neighbours: Int[Tensor, "r d"], begin: Int[Tensor, "r 1"], across: Int[Tensor, "r e"]
) -> Walks:
    """Return the walks that begin at these departures, seen to the next one.

    Across is the number of steps to the first neighbour; to the second it is always one.
    """
    first, second = neighbours.chunk(2, dim=1)
    e = across.shape[1]
    departures = torch.arange(neighbours.shape[1], device=neighbours.device).expand_as(neighbours)
    cities = departures[:, :e]
    # Of two cities each is the other's first neighbour and its second, and is come to as either.
    by_second = torch.where(first == second, -1, cities)
    came_by_first = first.gather(1, neighbours) == torch.cat((cities, by_second), dim=1)
    onwards = torch.where(came_by_first, neighbours + e, neighbours)
    is_last = onwards == begin
    steps = torch.cat((across, torch.ones_like(across)), dim=1)
    return Walks(
        torch.where(is_last, departures, onwards),
        torch.where(is_last, 0, steps),
        begin,
        is_last.long().argmax(dim=1, keepdim=True),
    )


def doubled(walks: Walks) -> Walks:
    """Return the walks, each departure seeing as far again as the one to which it looked."""
    onwards, steps = walks[:2]
    steps = steps + steps.gather(1, onwards)
    return walks._replace(onwards=onwards.gather(1, onwards), steps=steps)


def end_out_of_sight(walks: Walks) -> Bool[Tensor, ""]:
    """Return whether some walk's end is not yet seen from where it begins."""
    return (walks.onwards.gather(1, walks.begin) != walks.last).any()


def places_on_tours(walks: Walks, n: int | Tensor) -> Int[Tensor, "r e"]:
    """Return the place of each end in the walk of n cities, whose end must be in sight.

    One that is on no tour has the last place, too.
    """
    ahead = torch.where(walks.onwards == walks.last, walks.steps, 0)
    return n - 1 - torch.maximum(*ahead.chunk(2, dim=1))


def closed_neighbours(fragments: Fragments) -> Int[Tensor, "r d"]:
    """Return the links of each city where one fragment is left, once its ends are joined.

    A city that belongs to no tour is its own neighbour.
    """
    links = fragments.links[:, :-1]
    n = (fragments.links.shape[1] - 1) // 2
    one = first_open(fragments)
    both = fragments.ends.gather(1, torch.cat((one, fragments.partners.gather(1, one)), dim=1))
    links = links.scatter(1, both + n, both.flip(1))
    cities = torch.arange(n, device=links.device)
    return torch.where(links < 0, torch.cat((cities, cities)), links)


def begun_at(fragments: Fragments, ends: Int[Tensor, "r 1"]) -> Walks:
    """Return the walks of rows that have one fragment left, from these of its ends to the other.

    The ends are given by position.
    """
    neighbours = closed_neighbours(fragments)
    across = torch.ones_like(neighbours.chunk(2, dim=1)[0])
    return begun(neighbours, fragments.ends.gather(1, ends), across)


def walked(walks: Walks) -> Int[Tensor, "r n"]:
    """Return the tours of walks whose end is seen."""
    zeros = torch.zeros_like(walks.onwards.chunk(2, dim=1)[0])
    cities = torch.arange(zeros.shape[1], device=zeros.device).expand_as(zeros)
    return zeros.scatter(1, places_on_tours(walks, zeros.shape[1]), cities)


def tours_from(fragments: Fragments, ends: Int[Tensor, "r 1"]) -> Int[Tensor, "r n"]:
    """Return the tours of rows that have one fragment left, from these of its ends to the other.

    The ends are given by position.
    """
    walks = begun_at(fragments, ends)
    while bool(end_out_of_sight(walks)):
        walks = doubled(walks)
    return walked(walks)
