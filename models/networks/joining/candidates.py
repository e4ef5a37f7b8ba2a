"""Candidate edges of PA-One: the cheapest edges from each open end of a path.

If costs differ by direction, a path can be used in both directions, and the cheaper one may change
with every edge that is added. The cost of an edge is then a difference: the cheaper way through
both joined paths, less the cheaper ways through each path alone.
"""

from typing import NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from models.networks.joining.costs import CANDIDATES, Costs, Problem
from models.networks.joining.fragments import (
    NEVER,
    Fragments,
    all_alone,
    first_open,
    grown,
    impossible,
    linked,
)
from models.networks.joining.walks import tours_from
from models.networks.rows import side_by_side

_ROUNDING = 1e-5  # of a cost, by which it may seem to have risen


class Candidates(NamedTuple):
    """The candidates of each end by ascending cost: positions of other ends, and costs of edges.

    An impossible edge costs NEVER or more. The lean of an edge is positive where the way from the
    end along its edge is the dearer one, by twice as much; none where costs have no direction.
    """

    costs: Float[Tensor, "r e c"]
    positions: Int[Tensor, "r e c"]
    leans: Float[Tensor, "r e c"] | None = None

    @property
    def real(self) -> Bool[Tensor, "r e c"]:
        """Which of the edges are possible."""
        return self.costs < NEVER / 2

    def theirs(self, of_ends: Float[Tensor, "r e"]) -> Float[Tensor, "r e c"]:
        """Return the entries of a table of ends for the candidates of each end."""
        return of_ends.gather(1, self.positions.flatten(1)).view_as(self.costs)


def single_cities(costs: Costs) -> Fragments:
    """Return the fragments that a tour of each row begins from: every city alone."""
    return all_alone(costs.means[:, :, 0], leaning=costs.leans is not None)


def cheapest_candidates(costs: Costs, fragments: Fragments, count: int = CANDIDATES) -> Candidates:
    """Return `count` candidates of each end: the open ends with the cheapest edges to it."""
    ends, partners, open_ = fragments[:3]
    r, n = costs.means.shape[0], costs.means.shape[1]
    zeros = torch.zeros_like(costs.means[:, 0])
    place = torch.where(open_, ends, n)
    closed = torch.where(open_, 0.0, NEVER).to(zeros)
    of_stops = (zeros + NEVER).scatter(1, place, closed)
    rows = torch.arange(r, device=zeros.device)[:, None]
    lines = (n * rows + ends).flatten()

    def from_ends(table: Tensor) -> Float[Tensor, "r e m"]:
        return table.flatten(0, 1).index_select(0, lines).unflatten(0, ends.shape)

    leans = None
    if costs.leans is None or fragments.leans is None:
        cheapest, cities = (from_ends(costs.means) + of_stops[:, None]).topk(count, largest=False)
    else:
        own = fragments.leans[..., None]
        theirs = zeros.scatter(1, place, fragments.leans)
        leans = from_ends(costs.leans) + theirs[:, None] - own
        through = from_ends(costs.means) + (of_stops + theirs.abs())[:, None] - leans.abs()
        cheapest, cities = through.topk(count, largest=False)
        closed = closed + fragments.leans.abs()
    index = torch.arange(ends.shape[1], device=zeros.device).expand_as(ends)
    position = zeros.long().scatter(1, place, index)
    positions = position.gather(1, cities.flatten(1)).view_as(cities)
    own = positions.to(cheapest) == side_by_side(partners.to(cheapest), count)
    cheapest = cheapest + side_by_side(closed, count) + NEVER * own.to(cheapest)
    return Candidates(cheapest, positions, None if leans is None else leans.gather(2, cities))


def no_more_possible(
    candidates: Candidates, before: Fragments, after: Fragments
) -> Bool[Tensor, "r e c"]:
    """Return which edges of open ends may not be added after some were, or not at the same cost.

    Candidates are of the fragments before. Where costs have directions, a path that has grown may
    want to be gone along the other way, in which another edge to it costs more.
    """
    forbidden = impossible(after, candidates.positions)
    if candidates.leans is None or before.leans is None or after.leans is None:
        return forbidden
    paths, through = _of_both(before.leans.abs(), candidates), candidates.leans.abs()
    most = (1 + _ROUNDING) * paths - (1 - _ROUNDING) * through
    paths = _of_both((1 - _ROUNDING) * after.leans.abs(), candidates)
    change = before.leans - after.leans
    through = (candidates.leans + change[..., None] - candidates.theirs(change)).abs()
    return forbidden | (paths - through > most)


def _of_both(of_ends: Float[Tensor, "r e"], candidates: Candidates) -> Float[Tensor, "r e c"]:
    """Return the sums of the entries of each end and of each of its candidates."""
    return of_ends[..., None] + candidates.theirs(of_ends)


def without_impossible(
    logits: Float[Tensor, "r e c"], forbidden: Bool[Tensor, "r e c"]
) -> Float[Tensor, "r e c"]:
    """Return the logits, those of forbidden edges -NEVER or nearly so, or even lower.

    Exported, a sum takes less time than a choice.
    """
    return logits - NEVER * forbidden.to(logits)


def partner_costs(costs: Costs | Problem, fragments: Fragments) -> Float[Tensor, "r e"]:
    """Return the cost of the edge from each end to its partner, which would close the path.

    It is the mean of both directions.
    """
    return costs.steps(fragments.ends, _across(fragments))[0]


def _across(fragments: Fragments) -> Int[Tensor, "r e"]:
    """Return the city at the other end of each end's path."""
    return fragments.ends.gather(1, fragments.partners)


def joined_at_cost(
    costs: Costs | Problem, fragments: Fragments, mates: Int[Tensor, "r e"]
) -> Fragments:
    """Return the fragments joined, each end to its mate, by edges that lean as costs do."""
    return linked([fragments, grown_at_cost(costs, fragments, mates)], [mates])


def grown_at_cost(
    costs: Costs | Problem, fragments: Fragments, mates: Int[Tensor, "r e"]
) -> Fragments:
    """Return the fragments joined like that, with the links and the number left of before."""
    if fragments.leans is None:
        return grown(fragments, mates)
    ends = fragments.ends
    return grown(fragments, mates, costs.steps(ends, ends.gather(1, mates.clamp(min=0)))[1])


def toured(costs: Costs | Problem, fragments: Fragments) -> Int[Tensor, "r n"]:
    """Return the tours of rows that have one fragment left, in the direction that costs less."""
    return tours_from(fragments, cheaper_starts(costs, fragments))


def cheaper_starts(costs: Costs | Problem, fragments: Fragments) -> Int[Tensor, "r 1"]:
    """Return the position of the end from which each row's last fragment is the cheaper tour."""
    first = first_open(fragments)
    if fragments.leans is None:
        return first
    last = fragments.partners.gather(1, first)
    starts, stops = (fragments.ends.gather(1, end) for end in (last, first))
    closing = costs.steps(starts, stops)[1]
    assert closing is not None
    # The way from the last end to the first, then along the path.
    return torch.where(closing > fragments.leans.gather(1, last), last, first)
