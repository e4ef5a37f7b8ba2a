"""Prices of cities, from the assignment problem with entropy.

A tour leaves each city once and enters it once. So if the steps of a city cost less by a price, all
tours become shorter by the same amount. The remaining costs show better which steps a tour needs:
with the best prices of the assignment problem, only steps of optimal assignments cost nothing. The
prices here are those of the assignment problem with entropy, which a few products of matrices find
(Sinkhorn's iteration; Cuturi, 2013, arXiv:1306.0895). They are computed for some weights, the
knots, and interpolated between these: inexact prices do no harm. Under more than two objectives
they are computed for the weights of each row.
"""

import torch
from jaxtyping import Float
from torch import Tensor

from models.networks.joining.costs import Costs, Matrices, Planes, Prices, Problem, weighted_costs
from models.networks.joining.fragments import NEVER
from models.networks.rows import stacked

KNOTS = 9  # weights for which prices are found
_CHEAPEST = 4  # steps of each city, whose mean is the unit of the temperature
_TEMPERATURE = 0.5
_ITERATIONS = 10
_LEAST_UNIT = 1e-6
_ROOM = 3_000_000  # costs in the rows whose prices are found at one time
_LEAST = 1e-30  # entry of a kernel: a city so far from all others gets no higher price


def knots(like: Tensor, count: int = KNOTS) -> Float[Tensor, "g 2"]:
    """Return `count` weights, spread evenly, by ascending first weight."""
    first = torch.arange(count, device=like.device).to(like) / (count - 1)
    return torch.stack((first, 1 - first), dim=1)


def places_among_knots(
    weights: Float[Tensor, "r 2"], count: int | Tensor = KNOTS
) -> Float[Tensor, " r"]:
    """Return the place of each row's weights among the knots: 0 is the first knot."""
    return weights[:, 0] * (count - 1)


def prices_between(weights: Float[Tensor, "r 2"], known: Prices) -> Prices:
    """Return the prices under the weights of each row, from those at the knots."""
    index = torch.arange(KNOTS, device=weights.device).to(weights)
    shares = (1 - (places_among_knots(weights)[:, None] - index).abs()).clamp(min=0)  # (r, knots)
    return Prices(shares @ known.fees, shares @ known.tilts)


def priced_problem(
    costs: Planes | Matrices, weights: Float[Tensor, "r 2"], known: Prices | None
) -> Problem:
    """Return the problem under these weights, with prices where those at the knots are known."""
    return Problem(costs, weights, None if known is None else prices_between(weights, known))


def prices_at_knots(costs: Matrices) -> Prices:
    """Return the prices of the cities at each knot, from the costs in both objectives."""
    return prices_of(costs, knots(costs.means))


def own_prices(costs: Matrices, weights: Float[Tensor, "r o"]) -> Prices:
    """Return the prices of the cities in each row, found for some rows at a time."""
    at_a_time = max(1, _ROOM // costs.n**2)
    return stacked([prices_of(costs, some) for some in weights.split(at_a_time)])


def prices_of(costs: Matrices, weights: Float[Tensor, "r o"]) -> Prices:
    """Return the prices of the cities under the weights of each row."""
    return _prices(weighted_costs(costs.tables, weights))


def _prices(costs: Costs) -> Prices:
    """Return the prices of the cities in each row of costs, which have leans."""
    means, leans = costs
    assert leans is not None
    n = means.shape[1]
    there, back = means + leans, means - leans
    unit = _unit(torch.cat((there, back), dim=1))[:, None] * _TEMPERATURE
    kernel, back_kernel = (
        (-table[:, :, :n] / unit[..., None]).exp().clamp(min=_LEAST) for table in (there, back)
    )
    # First to leave, then to enter. The city at the other end of a step has them exchanged.
    kernels = torch.stack((kernel, back_kernel))
    both = kernels.sum(dim=3, keepdim=True).rsqrt()
    other_way = torch.tensor([1, 0], device=both.device)
    for _ in range(_ITERATIONS):
        both = (both / (kernels @ both.index_select(0, other_way))).sqrt()
    leave, enter = unit * both.squeeze(3).log()
    return Prices((leave + enter) / 2, (leave - enter) / 2)


def _unit(costs: Float[Tensor, "g two_n m"]) -> Float[Tensor, " g"]:
    """Return the mean of the cheapest steps from and to each city."""
    cheapest = costs.topk(_CHEAPEST, largest=False).values
    real = cheapest < NEVER / 2
    total = torch.where(real, cheapest, 0.0).sum(dim=(1, 2))
    return (total / real.sum(dim=(1, 2)).clamp(min=1)).clamp(min=_LEAST_UNIT)
