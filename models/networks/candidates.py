"""Candidate edges of PA-One: the cheapest edges from each open end of a path.

A row is one tour under construction, with costs of its own: those of its preference. Where costs
differ by direction, a path is gone along in either, and which way is the cheaper one may change
with every edge that is added to it. An edge then costs what the cheaper way through both paths
and itself costs above the cheaper way through each.
"""

from typing import NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

from models.data.instances import distance_matrices
from models.networks.fragments import (
    NEVER,
    Fragments,
    all_alone,
    first_open,
    joined,
    possible,
    walked,
)

CANDIDATES = 8  # of an end
_ROUNDING = 1e-5  # of a cost, by which it may seem to have risen


class Costs(NamedTuple):
    """The mean cost of each step and of the step back, and how much of it the way there is above.

    There is no lean where both cost the same. There are as many columns more as an end has
    candidates, of cities that are never reached.
    """

    means: Float[Tensor, "r n m"]
    leans: Float[Tensor, "r n m"] | None = None


class Prices(NamedTuple):
    """What each city costs by itself, in each row: half a fee for the way there and the way on.

    The fee is taken off the cost of every step to a city and from it; the tilt is taken off that
    of the steps from the city, and put on those to it. The cost of no tour changes by more than
    that of another.
    """

    fees: Float[Tensor, "r n"]
    tilts: Float[Tensor, "r n"]


class Candidates(NamedTuple):
    """The candidates of each end by ascending cost: positions of other ends, and costs of edges.

    An impossible edge costs NEVER. The lean of an edge is positive where the way from the end
    along its edge is the dearer one, by twice as much; none where costs have no direction.
    """

    costs: Float[Tensor, "r e c"]
    positions: Int[Tensor, "r e c"]
    leans: Float[Tensor, "r e c"] | None = None

    @property
    def real(self) -> Bool[Tensor, "r e c"]:
        """Which of the edges are possible."""
        return self.costs < NEVER / 2


def padded_distances(cities: Float[Tensor, "n 4"]) -> Costs:
    """Return the distances in each plane, a row each; no city has itself for a neighbour."""
    return Costs(_padded(distance_matrices(cities[None])[0]))


def padded_matrices(matrices: Float[Tensor, "2 n n"]) -> Costs:
    """Return the costs in each objective, a row each; no city has itself for a neighbour."""
    back = matrices.mT
    leans = nn.functional.pad((matrices - back) / 2, (0, CANDIDATES))
    return Costs(_padded((matrices + back) / 2), leans)


def _padded(costs: Float[Tensor, "2 n n"]) -> Float[Tensor, "2 n m"]:
    index = torch.arange(costs.shape[-1], device=costs.device)
    own = torch.where(index == index[:, None], NEVER, 0.0)
    return nn.functional.pad(costs + own, (0, CANDIDATES), value=NEVER)


def weighted_costs(
    costs: Costs, weights: Float[Tensor, "r 2"], prices: Prices | None = None
) -> Costs:
    """Return the cost of each step under the weights of each row, from those in each objective.

    Where there are prices, what a tour costs in all falls by as much for every tour of a row.
    """
    means, leans = costs
    weighted = Costs(
        _weighted(means, weights), None if leans is None else _weighted(leans, weights)
    )
    return weighted if prices is None else without(weighted, prices)


def without(costs: Costs, prices: Prices) -> Costs:
    """Return the costs without the prices of both cities of each step."""
    fees, tilts = (nn.functional.pad(part, (0, CANDIDATES)) for part in prices)
    n = costs.means.shape[1]
    means = costs.means - fees[:, :n, None] - fees[:, None]
    if costs.leans is None:
        return Costs(means)
    return Costs(means, costs.leans - tilts[:, :n, None] + tilts[:, None])


def _weighted(costs: Float[Tensor, "2 n m"], weights: Float[Tensor, "r 2"]) -> Tensor:
    return (weights @ costs.flatten(1)).unflatten(1, costs.shape[1:])


def single_cities(costs: Costs) -> Fragments:
    """Return the fragments that a tour of each row begins from: every city alone."""
    return all_alone(costs.means[:, :, 0], leaning=costs.leans is not None)


def first_candidates(costs: Costs) -> Candidates:
    """Return the candidates while all cities are alone, for less than `cheapest_candidates`."""
    means, leans = costs
    least = means if leans is None else means - leans.abs()
    cheapest, cities = least.topk(CANDIDATES, largest=False)
    positions = torch.where(cheapest < NEVER / 2, cities, 0)
    return Candidates(cheapest, positions, None if leans is None else leans.gather(2, cities))


def cheapest_candidates(costs: Costs, fragments: Fragments) -> Candidates:
    """Return the candidates of each end: the open ends to which an edge costs least."""
    ends, partners, open_ = fragments[:3]
    r, n = costs.means.shape[:2]
    zeros = torch.zeros_like(costs.means[:, 0])
    place = torch.where(open_, ends, n)
    closed = (zeros + NEVER).scatter(1, place, torch.where(open_, 0.0, NEVER).to(zeros))
    rows = torch.arange(r, device=zeros.device)[:, None]
    lines = (n * rows + ends).flatten()

    def from_ends(table: Tensor) -> Float[Tensor, "r e m"]:
        return table.flatten(0, 1).index_select(0, lines).unflatten(0, ends.shape)

    leans = None
    open_costs = from_ends(costs.means) + closed[:, None]
    if costs.leans is not None and fragments.leans is not None:
        own = fragments.leans
        theirs = zeros.scatter(1, place, own)
        leans = from_ends(costs.leans) + theirs[:, None] - own[..., None]
        open_costs = open_costs + own.abs()[..., None] + theirs.abs()[:, None] - leans.abs()
    cheapest, cities = open_costs.topk(CANDIDATES, largest=False)
    index = torch.arange(ends.shape[1], device=zeros.device).expand_as(ends)
    position = zeros.long().scatter(1, place, index)
    positions = position.gather(1, cities.flatten(1)).view_as(cities)
    impossible = (positions == partners[..., None]) | ~open_[..., None] | (cheapest >= NEVER / 2)
    cheapest = torch.where(impossible, NEVER, cheapest)
    return Candidates(cheapest, positions, None if leans is None else leans.gather(2, cities))


def still_possible(
    candidates: Candidates, before: Fragments, after: Fragments
) -> Bool[Tensor, "r e c"]:
    """Return which edges may still be added after some were, at no higher cost than before.

    Candidates are of the fragments before. Where costs have directions, a path that has grown may
    want to be gone along the other way, in which another edge to it costs more.
    """
    allowed = possible(after, candidates.positions)
    if candidates.leans is None or before.leans is None or after.leans is None:
        return allowed
    costs, magnitudes = zip(
        *(_cost_of_leaning(candidates, before, fragments) for fragments in (before, after)),
        strict=True,
    )
    return allowed & (costs[1] <= costs[0] + _ROUNDING * (magnitudes[0] + magnitudes[1]))


def _cost_of_leaning(
    candidates: Candidates, before: Fragments, now: Fragments
) -> tuple[Float[Tensor, "r e c"], Float[Tensor, "r e c"]]:
    """Return what directions add to the cost of each edge, and the numbers that it comes from."""
    positions = candidates.positions
    change = now.leans - before.leans
    theirs, change_there = (
        leans.gather(1, positions.flatten(1)).view_as(candidates.costs)
        for leans in (now.leans, change)
    )
    through = (candidates.leans + change_there - change[..., None]).abs()
    paths = now.leans.abs()[..., None] + theirs.abs()
    return paths - through, paths + through


def partner_costs(costs: Costs, fragments: Fragments) -> Float[Tensor, "r e"]:
    """Return the cost of the edge from each end to its partner, which would close the path.

    It is the mean of both directions.
    """
    return _to_partners(costs.means, fragments)


def _to_partners(table: Float[Tensor, "r n m"], fragments: Fragments) -> Float[Tensor, "r e"]:
    rows = torch.arange(table.shape[0], device=table.device)[:, None]
    return table[rows, fragments.ends, fragments.ends.gather(1, fragments.partners)]


def joined_at_cost(costs: Costs, fragments: Fragments, mates: Int[Tensor, "r e"]) -> Fragments:
    """Return the fragments joined, each end to its mate, by edges that lean as costs do."""
    if costs.leans is None:
        return joined(fragments, mates)
    rows = torch.arange(mates.shape[0], device=mates.device)[:, None]
    ends = fragments.ends
    return joined(fragments, mates, costs.leans[rows, ends, ends.gather(1, mates.clamp(min=0))])


def toured(costs: Costs, fragments: Fragments) -> Int[Tensor, "r n"]:
    """Return the tours of rows that have one fragment left, in the direction that costs less."""
    return walked(fragments, cheaper_starts(costs, fragments))


def cheaper_starts(costs: Costs, fragments: Fragments) -> Int[Tensor, "r 1"]:
    """Return the position of the end from which each row's last fragment is the cheaper tour."""
    first = first_open(fragments)
    if costs.leans is None or fragments.leans is None:
        return first
    last = fragments.partners.gather(1, first)
    closing = _to_partners(costs.leans, fragments)
    # The way from the last end to the first, then along the path.
    dearer = closing.gather(1, last) > fragments.leans.gather(1, last)
    return torch.where(dearer, last, first)
