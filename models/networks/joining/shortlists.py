"""Shortlists: for each city the few others to which a step may cost least, found once.

Under two objectives they are found for intervals of weights between knots, not for each row. With
the weights of a knot, a step costs S + A and the step back S - A, where A is 0 in planes. Between
two knots, S (with prices) and A are linear in the weights. So the cheaper direction, S - |A|, is
never below the lower one of its values at both knots, and cities are listed by that value. The
costs of a row are exact: they use its own weights. Under more objectives there would be as many
simplices of weights as there are rows, so each row has lists of its own. Ends of paths choose their
candidates among the open ends on the lists of their cities.
"""

from typing import NamedTuple, cast

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

from models.networks.joining.candidates import Candidates
from models.networks.joining.costs import (
    CANDIDATES,
    Costs,
    Matrices,
    Planes,
    Prices,
    Problem,
    weighted_costs,
    without_prices,
)
from models.networks.joining.fragments import NEVER, Fragments
from models.networks.joining.prices import knots, places_among_knots
from models.networks.rows import changed, stacked

_AT_A_TIME = 1000  # cities
_ROOM = 3_000_000  # costs in a part of the lists of rows


class Sizes(NamedTuple):
    """The number of knots, the length of each list, and when lists are used.

    Lists are used while some row has more than `ends` open ends, and more than one for every
    `share` cities. With fewer cities only the first round uses lists, which may then be short.
    """

    knots: int
    length: int
    short: int
    ends: int
    share: int

    def length_of(self, n: int) -> int:
        """Return how long each list of n cities is."""
        return self.length if n > self.ends else self.short


class Shortlists(NamedTuple):
    """The cities listed for each city in each interval, and the costs of the steps to them.

    Costs are those at the knot where an interval begins, and their change up to the next knot.
    An unused place on a list costs NEVER. Leans are None if steps back cost the same.
    """

    cities: Int[Tensor, "g n l"]
    means: Float[Tensor, "g n l"]
    rise_of_means: Float[Tensor, "g n l"]
    leans: Float[Tensor, "g n l"] | None = None
    rise_of_leans: Float[Tensor, "g n l"] | None = None


class RowLists(NamedTuple):
    """The cities listed for each city in each row, and the costs of the steps to them."""

    cities: Int[Tensor, "r n l"]
    means: Float[Tensor, "r n l"]
    leans: Float[Tensor, "r n l"] | None = None


def shortlists(
    costs: Planes | Matrices, count: int, length: int, known: Prices | None = None
) -> Shortlists:
    """Return the lists of all cities, as `shortlists_of` does, made for some cities at a time."""
    cities = torch.arange(costs.n, device=costs[0].device)
    parts = [shortlists_of(some, costs, count, length, known) for some in cities.split(_AT_A_TIME)]
    return stacked(parts, dim=1)


def shortlists_of(
    some: Int[Tensor, " b"],
    costs: Planes | Matrices,
    count: int,
    length: int | Tensor,
    known: Prices | None = None,
) -> Shortlists:
    """Return lists of some cities, for the intervals between the knots.

    `known` are the prices at the knots, if there are any. The length is a tensor while the graph is
    traced for its export.
    """
    in_each = _beginning_at(some, costs, length)
    begin, end = (
        _at_knots(some, in_each, count, which, known) for which in (slice(None, -1), slice(1, None))
    )
    cheapest, cities = torch.minimum(begin.cheaper_way, end.cheaper_way).topk(
        cast(int, length), largest=False
    )
    is_city = cheapest < NEVER / 2
    cities = torch.where(is_city, cities, 0)

    def of_listed(at_begin: Tensor, at_end: Tensor, otherwise: float) -> tuple[Tensor, Tensor]:
        first = at_begin.gather(2, cities)
        rise = at_end.gather(2, cities) - first
        return torch.where(is_city, first, otherwise), torch.where(is_city, rise, 0.0)

    lists = Shortlists(cities, *of_listed(begin.means, end.means, NEVER))
    if begin.leans is None or end.leans is None:
        return lists
    leans, rise_of_leans = of_listed(begin.leans, end.leans, 0.0)
    return lists._replace(leans=leans, rise_of_leans=rise_of_leans)


def _beginning_at(some: Int[Tensor, " b"], costs: Planes | Matrices, fill: int | Tensor) -> Costs:
    """Return the costs in each objective from some cities to all, and to as many more that fill up.

    No city has itself or one of these for a neighbour. Their number is a tensor while the graph is
    traced for its export.
    """
    means, leans = costs.beginning_at(some)
    own = some[None, :, None].expand(means.shape[0], -1, -1)
    means = means.scatter(2, own, torch.full_like(means[:, :, :1], NEVER))
    more = (0, cast(int, fill))
    means = nn.functional.pad(means, more, value=NEVER)
    return Costs(means, None if leans is None else nn.functional.pad(leans, more))


def _at_knots(
    some: Int[Tensor, " b"], in_each: Costs, count: int, which: slice, known: Prices | None
) -> Costs:
    """Return the costs of the steps from some cities at a part of the knots, less the prices."""
    found = weighted_costs(in_each, knots(in_each.means, count)[which])
    if known is None:
        return found
    return _without_prices_from(some, found, changed(known, lambda part: part[which]))


def _without_prices_from(some: Int[Tensor, " b"], costs: Costs, prices: Prices) -> Costs:
    """Return the costs of the steps from some cities to all, and to more, less the prices."""
    fill = costs.means.shape[2] - prices.fees.shape[1]
    return without_prices(
        costs,
        changed(prices, lambda part: part.index_select(1, some)[..., None]),
        changed(prices, lambda part: nn.functional.pad(part, (0, fill))[:, None]),
    )


def lists_of_rows(lists: Shortlists, weights: Float[Tensor, "r 2"]) -> RowLists:
    """Return the lists of each row: those of its interval, at the costs of its weights."""
    intervals_in_all = lists.cities.shape[0]
    places = places_among_knots(weights, intervals_in_all + 1)
    intervals = places.long().clamp(max=intervals_in_all - 1)
    share = (places - intervals)[:, None, None]

    def between(begin: Tensor, rise: Tensor) -> Float[Tensor, "r n l"]:
        return begin.index_select(0, intervals) + share * rise.index_select(0, intervals)

    cities, means, rise_of_means, leans, rise_of_leans = lists
    of_rows = RowLists(cities.index_select(0, intervals), between(means, rise_of_means))
    if leans is None or rise_of_leans is None:
        return of_rows
    return of_rows._replace(leans=between(leans, rise_of_leans))


def own_lists(problem: Problem, length: int) -> RowLists:
    """Return lists for each row of its own, made for some cities at a time."""
    n = problem.costs.n
    cities = torch.arange(n, device=problem.weights.device)
    at_a_time = max(1, _ROOM // (n * len(problem.weights)))
    return stacked([own_lists_of(some, problem, length) for some in cities.split(at_a_time)], dim=1)


def own_lists_of(some: Int[Tensor, " b"], problem: Problem, length: int | Tensor) -> RowLists:
    """Return lists of some cities for each row, by its own costs.

    The length is a tensor while the graph is traced for its export.
    """
    found = weighted_costs(_beginning_at(some, problem.costs, length), problem.weights)
    if problem.prices is not None:
        found = _without_prices_from(some, found, problem.prices)
    cheapest, cities = found.cheaper_way.topk(cast(int, length), largest=False)
    is_city = cheapest < NEVER / 2

    def of_listed(table: Tensor, otherwise: float) -> Float[Tensor, "r b l"]:
        return torch.where(is_city, table.gather(2, cities), otherwise)

    leans = None if found.leans is None else of_listed(found.leans, 0.0)
    return RowLists(torch.where(is_city, cities, 0), of_listed(found.means, NEVER), leans)


def first_of(lists: RowLists, count: int = CANDIDATES) -> Candidates:
    """Return `count` candidates of each city, while all cities are alone."""
    cities, means, leans = lists
    return _cheapest(Costs(means, leans).cheaper_way, cities, leans, count)


def listed_candidates(
    lists: RowLists,
    fragments: Fragments,
    rows_in_use: Bool[Tensor, " r"],
    count: int = CANDIDATES,
) -> Candidates:
    """Return `count` candidates of each end: the open ends on its list with the cheapest edges.

    In a row that is not in use no edge is possible.
    """
    ends, partners, open_ = fragments[:3]
    r, n = lists.cities.shape[0], lists.cities.shape[1]
    rows = torch.arange(r, device=ends.device)[:, None]
    lines = (n * rows + ends).flatten()

    def of_ends(listed: Tensor) -> Tensor:
        return listed.flatten(0, 1).index_select(0, lines).view(r, ends.shape[1], -1)

    cities, costs, leans = of_ends(lists.cities), of_ends(lists.means), None
    index = torch.arange(ends.shape[1], device=ends.device).expand_as(ends)
    nowhere = torch.full_like(fragments.links[:, : n + 1], -1)  # a column for each city, and more
    by_city = nowhere.scatter(1, torch.where(open_, ends, n), torch.where(open_, index, -1))
    found = by_city.gather(1, cities.flatten(1)).view_as(cities)
    positions = found.clamp(min=0)
    if lists.leans is not None and fragments.leans is not None:
        own = fragments.leans
        theirs = own.gather(1, positions.flatten(1)).view_as(costs)
        leans = of_ends(lists.leans) + theirs - own[..., None]
        costs = costs + theirs.abs() - leans.abs()
    impossible = (found < 0) | (found == partners[..., None])
    candidates = _cheapest(torch.where(impossible, NEVER, costs), positions, leans, count)
    of_starts = torch.where(open_ & rows_in_use[:, None], 0.0, NEVER)
    if fragments.leans is not None:
        of_starts = of_starts + fragments.leans.abs()
    return candidates._replace(costs=candidates.costs + of_starts[..., None])


def _cheapest(
    costs: Float[Tensor, "r e l"],
    positions: Int[Tensor, "r e l"],
    leans: Float[Tensor, "r e l"] | None,
    count: int,
) -> Candidates:
    cheapest, which = costs.topk(count, largest=False)
    chosen = None if leans is None else leans.gather(2, which)
    return Candidates(cheapest, positions.gather(2, which), chosen)
