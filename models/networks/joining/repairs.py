"""Repair problems: cities cut out of finished tours, and tours from the fragments joined again.

A cut city loses both its edges. The tour becomes a few single cities and the paths between them: a
small problem of the kind that PA-One solves. It has only the ends at the cuts; one scatter then
lays out the whole tour. The code can be exported.
"""

from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor

from models.networks.joining.costs import Costs, Problem, along, costs_between, weighted_sums
from models.networks.joining.fragments import Fragments
from models.networks.joining.walks import begun, closed_neighbours, doubled, places_on_tours

_DOUBLINGS = 6  # of the edges that an end sees ahead: enough for 64 ends


class Cuts(NamedTuple):
    """Tours from which some cities have been cut out, each turned to begin at a cut city.

    Places are those of the cut cities, ascending; gaps count the cities from each to the next.
    """

    tours: Int[Tensor, "r n"]
    places: Int[Tensor, "r m"]
    gaps: Int[Tensor, "r m"]


def cut(tours: Int[Tensor, "r n"], cities: Int[Tensor, "r m"]) -> Cuts:
    """Return the tours without the edges of these cities."""
    n = tours.shape[1]
    index = torch.arange(n, device=tours.device).expand_as(tours)
    places = torch.zeros_like(tours).scatter(1, tours, index).gather(1, cities).sort(dim=1).values
    onwards = index + places[:, :1]
    turned = tours.gather(1, torch.where(onwards < n, onwards, onwards - n))
    places = places - places[:, :1]
    beyond = torch.cat((places[:, 1:], torch.full_like(places[:, :1], n)), dim=1)
    return Cuts(turned, places, beyond - places - 1)


def repair_problem(problem: Problem, cuts: Cuts) -> tuple[Costs, Fragments]:
    """Return the costs between the ends that cuts have left, and the fragments they belong to.

    There are three columns for a cut: the cut city, and the first and the last city of the path
    from there to the next one. Of a path of one city the last is closed, of an empty one both.
    Costs are returned under the weights, less the prices.
    """
    tours, places, gaps = cuts
    m = places.shape[1]
    columns = torch.cat((places, places + 1, places + gaps), dim=1).clamp(max=tours.shape[1] - 1)
    cities = tours.gather(1, columns)
    index = torch.arange(3 * m, device=tours.device).expand_as(columns)
    alone, first, last = index[:, :m], index[:, m : 2 * m], index[:, 2 * m :]
    long = gaps > 1
    across = torch.cat((alone, torch.where(long, last, first), torch.where(long, first, last)), 1)
    no_links = torch.full_like(index, -1)
    links = torch.where(across == index, -1, across)
    links = torch.cat((links, no_links, no_links[:, :1]), dim=1)
    open_ = torch.cat((gaps >= 0, gaps > 0, long), dim=1)
    left = m + (gaps > 0).sum(dim=1)
    fragments = Fragments(index, across, open_, links, left, _leans(problem, cuts, columns, cities))
    return costs_between(problem, cities), fragments


def _leans(
    problem: Problem, cuts: Cuts, columns: Int[Tensor, "r e"], cities: Int[Tensor, "r e"]
) -> Float[Tensor, "r e"] | None:
    """Return the leans of the ends that cuts have left, if costs have any."""
    costs, weights, prices = problem
    if prices is None:
        return None
    leans = along(costs, cuts.tours).leans
    assert leans is not None
    onwards = weighted_sums(leans, weights)
    until = (onwards.cumsum(dim=1) - onwards).gather(1, columns) + prices.tilts.gather(1, cities)
    alone, first, last = until.tensor_split(3, dim=1)
    return torch.cat((torch.zeros_like(alone), last - first, first - last), dim=1)


def laid_out(cuts: Cuts, fragments: Fragments) -> Int[Tensor, "r n"]:
    """Return the tours of rows that have one fragment left each."""
    tours, places = cuts.tours, cuts.places
    alone, first, last = _places(cuts, fragments).tensor_split(3, dim=1)
    turns = torch.where(last < first, -1, 1)
    starts = torch.stack((alone - places, first - turns * (places + 1)), dim=2).flatten(1)
    turns = torch.stack((torch.ones_like(turns), turns), dim=2).flatten(1)
    # A cut city and the path behind it are parts of the tour; none to two begin at a place.
    begins = torch.cat((places, places + 1), dim=1)
    marks = torch.zeros_like(torch.cat((tours, tours[:, :1]), dim=1))
    parts = marks.scatter_add(1, begins, torch.ones_like(begins))[:, :-1].cumsum(dim=1) - 1
    index = torch.arange(tours.shape[1], device=tours.device)
    new_places = starts.gather(1, parts) + turns.gather(1, parts) * index
    return torch.zeros_like(tours).scatter(1, new_places, tours)


def _places(cuts: Cuts, fragments: Fragments) -> Int[Tensor, "r e"]:
    """Return the place of each end in the new tour, which begins at the first cut city."""
    # The first neighbour of a path's end is its other end.
    across = torch.cat((torch.ones_like(cuts.gaps), cuts.gaps - 1, cuts.gaps - 1), dim=1)
    first_city = torch.zeros_like(cuts.places[:, :1])
    walks = begun(closed_neighbours(fragments), first_city, across.clamp(min=1))
    for _ in range(_DOUBLINGS):
        walks = doubled(walks)
    return places_on_tours(walks, cuts.tours.shape[1])
