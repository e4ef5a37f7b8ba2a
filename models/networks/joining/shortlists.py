"""Shortlists: for each city the few others to which a step may cost least, found once.

They are found for intervals of weights, not for each row. Under the weights of a knot a step and
the step back cost S + A and S - A. Between two knots S, prices included, goes in a straight line,
and so does A; hence the cheaper of both ways, S - |A|, is never below the lower one of its values
at both knots, and cities are listed by that. The costs of a row are then exact, those of its own
weights. Ends of paths choose their candidates among the open ends on the lists of their cities.
"""

from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from models.networks.joining.candidates import Candidates
from models.networks.joining.costs import CANDIDATES, Costs, Prices, weighted_costs
from models.networks.joining.fragments import NEVER, Fragments
from models.networks.joining.prices import knots, places_among_knots

_LENGTH = 24  # of a list
LEAST = 16  # open ends of a row; among fewer, candidates are looked for among all pairs


class Shortlists(NamedTuple):
    """The cities listed for each city in each interval, and the costs of the steps to them.

    Costs are those at the knot where an interval begins, and what is added on the way to the next.
    A place on a list that no city takes costs NEVER.
    """

    cities: Int[Tensor, "g n l"]
    means: Float[Tensor, "g n l"]
    leans: Float[Tensor, "g n l"]
    rise_of_means: Float[Tensor, "g n l"]
    rise_of_leans: Float[Tensor, "g n l"]


class RowLists(NamedTuple):
    """The cities listed for each city in each row, and the costs of the steps to them."""

    cities: Int[Tensor, "r n l"]
    means: Float[Tensor, "r n l"]
    leans: Float[Tensor, "r n l"]


def shortlists(costs: Costs, known: Prices) -> Shortlists:
    """Return the lists of all intervals, from costs in each objective and prices at the knots."""
    means, leans = weighted_costs(costs, knots(costs.means), known)
    assert leans is not None
    more = _LENGTH - CANDIDATES  # columns of cities that are never reached
    means, leans = (
        nn.functional.pad(means, (0, more), value=NEVER),
        nn.functional.pad(leans, (0, more)),
    )
    cheaper = means - leans.abs()
    least = torch.minimum(cheaper[:-1], cheaper[1:])
    cheapest, cities = least.topk(_LENGTH, largest=False)
    first_means, first_leans = means[:-1].gather(2, cities), leans[:-1].gather(2, cities)
    return Shortlists(
        torch.where(cheapest < NEVER / 2, cities, 0),
        first_means,
        first_leans,
        means[1:].gather(2, cities) - first_means,
        leans[1:].gather(2, cities) - first_leans,
    )


def lists_of_rows(lists: Shortlists, weights: Float[Tensor, "r 2"]) -> RowLists:
    """Return the lists of each row: those of its interval, at the costs of its weights."""
    places = places_among_knots(weights)
    intervals = places.long().clamp(max=lists.cities.shape[0] - 1)
    share = (places - intervals)[:, None, None]

    def between(begin: Tensor, rise: Tensor) -> Float[Tensor, "r n l"]:
        return begin.index_select(0, intervals) + share * rise.index_select(0, intervals)

    return RowLists(
        lists.cities.index_select(0, intervals),
        between(lists.means, lists.rise_of_means),
        between(lists.leans, lists.rise_of_leans),
    )


def first_of(lists: RowLists) -> Candidates:
    """Return the candidates while all cities are alone."""
    return _cheapest(lists.means - lists.leans.abs(), lists.cities, lists.leans)


def listed_candidates(lists: RowLists, fragments: Fragments) -> Candidates:
    """Return the candidates of each end: the open ends on its list to which an edge costs least."""
    ends, partners, open_ = fragments[:3]
    r, n = lists.cities.shape[0], lists.cities.shape[1]
    rows = torch.arange(r, device=ends.device)[:, None]
    lines = (n * rows + ends).flatten()
    cities, means, leans = (
        part.flatten(0, 1).index_select(0, lines).view(r, ends.shape[1], -1) for part in lists
    )
    index = torch.arange(ends.shape[1], device=ends.device).expand_as(ends)
    nowhere = torch.zeros_like(lists.cities[:, :, 0]) - 1
    nowhere = torch.cat((nowhere, nowhere[:, :1]), dim=1)
    by_city = nowhere.scatter(1, torch.where(open_, ends, n), torch.where(open_, index, -1))
    found = by_city.gather(1, cities.flatten(1)).view_as(cities)
    positions = found.clamp(min=0)
    own = fragments.leans
    assert own is not None
    theirs = own.gather(1, positions.flatten(1)).view_as(means)
    through = leans + theirs - own[..., None]
    costs = means + own.abs()[..., None] + theirs.abs() - through.abs()
    impossible = (found < 0) | (found == partners[..., None]) | ~open_[..., None]
    return _cheapest(torch.where(impossible, NEVER, costs), positions, through)


def _cheapest(
    costs: Float[Tensor, "r e l"], positions: Int[Tensor, "r e l"], leans: Float[Tensor, "r e l"]
) -> Candidates:
    cheapest, which = costs.topk(CANDIDATES, largest=False)
    return Candidates(cheapest, positions.gather(2, which), leans.gather(2, which))
