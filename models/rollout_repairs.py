"""Repaired tours of PA-One: a few cities of each tour are cut out and joined again, many times.

All tours of a front are repaired at once, each at a place of its own, where its edges are long
for what the edges to its cities' nearest neighbours would cost. PA-One joins what the cuts have
left. Then every row takes the best of all tours for its preference, of the old ones and the new
ones, and as many others are remembered as there are rows: see `models.shared_tours`.

PA-One joins the same cities in the same way each time. So every repair has a pattern of its own,
by which it takes some of the cities near its place and leaves others. Rows have different patterns
at the same time, as several may have the same tour. Late repairs, when those of few cities hardly
gain any more, cut out more.
"""

from typing import NamedTuple, cast

import torch
from jaxtyping import Float, Int
from torch import Generator, Tensor, nn

from models.networks.joining.candidates import Candidates
from models.networks.joining.costs import Matrices, Planes, Problem, along, weighted_sums
from models.networks.joining.fragments import NEVER
from models.shared_tours import best_for_rows, slopes_for_rows, worth_remembering


class Cut(NamedTuple):
    """The numbers of cities that a repair looks at, and that it cuts out of a tour."""

    near: int
    cities: int


EARLY, LATE = Cut(16, 8), Cut(24, 12)
LATE_FROM = 64  # repairs, after which they are late; each as many late ones have the same patterns
_NEARNESS = 0.15  # how much less a city counts than the next nearer one
_AFTER_A_CUT = 0.5  # of a city's freshness


def _patterns(near: int, seed: int) -> Float[Tensor, "p near"]:
    """Return keys for each pattern; the ranks with the greatest keys are those that it takes.

    Ranks are drawn without replacement (Gumbel-top-k), nearer ones rather than others.
    """
    drawn = torch.empty(LATE_FROM, near).exponential_(generator=Generator().manual_seed(seed))
    keys = -drawn.log() - _NEARNESS * torch.arange(near)
    keys[:, 0] = torch.inf
    return nn.functional.pad(keys, (0, LATE.near - near))


_PATTERNS = torch.cat((_patterns(EARLY.near, seed=5), _patterns(LATE.near, seed=6)))


class RepairState(NamedTuple):
    """The best tour for each row, as many others, and the freshness of each row's cities.

    Points are the lengths of each tour. A city's freshness falls each time that it is cut out,
    so that others have their turn.
    """

    tours: Int[Tensor, "r n"]
    points: Float[Tensor, "r o"]
    visited: Int[Tensor, "r n"]
    visited_points: Float[Tensor, "r o"]
    freshness: Float[Tensor, "r n"]


def from_the_first_city(tours: Int[Tensor, "k n"]) -> Int[Tensor, "k n"]:
    """Return the same closed tours, in the same direction, from city 0 on."""
    n = tours.shape[1]
    places = tours.argmin(dim=1, keepdim=True) + torch.arange(n)
    return tours.gather(1, places % n)


def least_costs(candidates: Candidates) -> Float[Tensor, "r n"]:
    """Return the least possible cost of both edges of each city, by its first candidates."""
    return candidates.costs[..., :2].sum(dim=-1)


def unrepaired(costs: Planes | Matrices, tours: Int[Tensor, "r n"]) -> RepairState:
    """Return the state before the first repair, of tours as they were built."""
    points = edge_lengths(costs, tours).sum(dim=2).T
    return RepairState(tours, points, tours, points, torch.ones_like(tours, dtype=points.dtype))


def as_repaired(problem: Problem, points: Float[Tensor, "r o"]) -> Problem:
    """Return the problem under the weights by which repairs make tours of these lengths better."""
    return problem._replace(weights=slopes_for_rows(problem.weights, points))


def edge_lengths(costs: Planes | Matrices, tours: Int[Tensor, "r n"]) -> Float[Tensor, "o r n"]:
    """Return the cost in each objective from each place of a tour to the next."""
    means, leans = along(costs, tours)
    return means if leans is None else means + leans


def sizes_of_cut(n: int, number: int) -> Cut:
    """Return how many of n cities the repair of this number looks at and cuts out."""
    near, cities = LATE if number >= LATE_FROM else EARLY
    return Cut(min(near, n), min(cities, n))


def cities_to_cut(
    problem: Problem,
    least: Float[Tensor, "r n"],
    places: tuple[Int[Tensor, "r n"], Float[Tensor, "r n"]],
    number: Int[Tensor, ""],
    sizes: tuple[int | Tensor, int | Tensor],
) -> Int[Tensor, "r m"]:
    """Return the cities that a repair cuts out: of those near to a place, by its pattern.

    Repairs are numbered from 0. Places are the tours, and the freshness of their cities. Sizes are
    as of `sizes_of_cut`, or tensors while the graph is traced for its export.
    """
    near, count = sizes
    rows = torch.arange(least.shape[0], device=least.device)
    first = torch.minimum(number - number % LATE_FROM, torch.full_like(number, LATE_FROM))
    patterns = _PATTERNS.index_select(0, first + (number + rows) % LATE_FROM)
    ranks = patterns[:, : cast(int, near)].topk(cast(int, count)).indices
    return _cities_near(problem, least, places, near).gather(1, ranks)


def _cities_near(
    problem: Problem,
    least: Float[Tensor, "r n"],
    places: tuple[Int[Tensor, "r n"], Float[Tensor, "r n"]],
    count: int | Tensor,
) -> Int[Tensor, "r near"]:
    """Return the city of most regret in each row, and those nearest to it, in this order.

    The regret of a city is what its edges cost above the least possible, times its freshness;
    costs are less the prices, where there are any.
    """
    costs, weights, prices = problem
    tours, freshness = places
    onwards = weighted_sums(edge_lengths(costs, tours), weights)
    if prices is not None:
        leaving, entering = prices.fees + prices.tilts, prices.fees - prices.tilts
        onwards = onwards - leaving.gather(1, tours) - entering.gather(1, tours).roll(-1, dims=1)
    regret = (onwards + onwards.roll(1, dims=1) - least.gather(1, tours)) * freshness.gather(
        1, tours
    )
    centres = tours.gather(1, regret.argmax(dim=1, keepdim=True))
    away = _costs_from(problem, centres[:, 0]).scatter(1, centres, -NEVER)
    return away.topk(cast(int, count), largest=False).indices


def _costs_from(problem: Problem, cities: Int[Tensor, " r"]) -> Float[Tensor, "r n"]:
    """Return the least cost of the edges at one city of each row, without the price of the city."""
    costs, weights, prices = problem
    in_each = costs.beginning_at(cities)
    means = weighted_sums(in_each.means, weights)
    if in_each.leans is None or prices is None:
        return means
    fees, tilts = prices
    leans = weighted_sums(in_each.leans, weights) - tilts.gather(1, cities[:, None])
    return means - fees - (leans + tilts).abs()


def state_after_repair(
    costs: Planes | Matrices,
    weights: Float[Tensor, "r o"],
    state: RepairState,
    cities: Int[Tensor, "r m"],
    tours: Int[Tensor, "r n"],
) -> RepairState:
    """Return the state with the best tour for each row, after these cities were cut out."""
    tours, points = cheaper_way(costs, weights, tours)
    all_tours, all_points = torch.cat((state.tours, tours)), torch.cat((state.points, points))
    taken = best_for_rows(weights, all_points)
    best = all_points.index_select(0, taken)
    is_left = (taken != torch.arange(taken.shape[0], device=taken.device))[:, None]
    others = torch.cat((state.visited, torch.where(is_left, state.tours, tours)))
    other_points = torch.cat((state.visited_points, torch.where(is_left, state.points, points)))
    remembered = worth_remembering(best, other_points)
    freshness = _AFTER_A_CUT * state.freshness.gather(1, cities)
    return RepairState(
        all_tours.index_select(0, taken),
        best,
        others.index_select(0, remembered),
        other_points.index_select(0, remembered),
        state.freshness.scatter(1, cities, freshness),
    )


def cheaper_way(
    costs: Planes | Matrices, weights: Float[Tensor, "r o"], tours: Int[Tensor, "r n"]
) -> tuple[Int[Tensor, "r n"], Float[Tensor, "r o"]]:
    """Return each tour in the direction that costs its row less, and its lengths."""
    means, leans = along(costs, tours)
    if leans is None:
        return tours, means.sum(dim=2).T
    # Both are added for each edge before the sum: they may be far longer than their sum.
    there, back = ((means + part).sum(dim=2).T for part in (leans, -leans))
    is_back = ((there - back) * weights).sum(dim=1, keepdim=True) > 0
    return torch.where(is_back, tours.flip(1), tours), torch.where(is_back, back, there)
