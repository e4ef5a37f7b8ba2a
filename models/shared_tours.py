"""Which tours the rows of a front keep between repairs, of all tours that any of them has found.

A tour that one row finds may be better for another row. So after each repair every row takes the
best of all tours for its own preference. Taken by their weighted sums alone, most rows would soon
share a few tours. So the lengths, times the weights, are compared by a norm with a high exponent:
it prefers tours that lie along the preference of the row.

A repair makes a row's tour better by its weighted sum, not by the norm. So it has weights of its
own, the slopes of the norm at this tour: an objective in which the tour is long for its row weighs
more.

The tours that no row keeps are candidates for a memory of as many tours as there are rows. It
keeps those that the other tours come least close to dominating.
"""

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

ROUNDING = 2e-6  # of a length: the error of sums of float32
_ROUNDING_OF_NORMS = 2e-5  # of sums of eighth powers
_FLAT = 2.5  # objectives: fewer are two
_LEAST_LENGTH = 1e-9
_LEAST_PART = 1e-3  # of the mean part of a weighted sum
_FAR = 1e3  # times as long


def best_for_rows(weights: Float[Tensor, "r o"], points: Float[Tensor, "p o"]) -> Int[Tensor, " r"]:
    """Return which of all points is the best for each row, by number.

    The first point is of the first row's own tour, and so on: each row keeps its own unless another
    is better. Of equally good ones it takes the first. The exponent of the norm is eight under two
    objectives. Under more it is two, as rows are further apart there.
    """
    r = weights.shape[0]
    own = (points[:r] * weights).sum(dim=1, keepdim=True)
    norms = _norms(weights / own, points)
    least = norms.amin(dim=1, keepdim=True)
    own_norms = norms.gather(1, _numbers(own))
    others = (norms <= (1 + _ROUNDING_OF_NORMS) * least).long().argmax(dim=1, keepdim=True)
    is_better = own_norms > (1 + _ROUNDING_OF_NORMS) * least
    return torch.where(is_better, others, _numbers(own))[:, 0]


def worth_remembering(
    kept: Float[Tensor, "r o"], others: Float[Tensor, "q o"]
) -> Int[Tensor, " r"]:
    """Return as many of the other points as are kept, by number, that tell most of the front.

    For each other point, the point that comes closest to dominating it counts, of the kept ones
    and of the others before it: the factor by which it would have to be shorter.
    """
    points = torch.cat((kept, others))
    r = kept.shape[0]
    factors = points.T / others.clamp(min=_LEAST_LENGTH)[..., None]
    index = torch.arange(points.shape[0], device=points.device)
    is_later = index >= index[r:, None]
    closest = (factors.amax(dim=1) + _FAR * is_later.to(factors)).amin(dim=1)
    return closest.topk(r).indices


def slopes_for_rows(
    weights: Float[Tensor, "r o"], points: Float[Tensor, "r o"]
) -> Float[Tensor, "r o"]:
    """Return the slopes of the norm of each row at its own point, as weights that add to one.

    Under two objectives they are less steep than those of the norm, by a power: it gains as much,
    and close comparisons are rarer.
    """
    parts = points * weights
    least = _LEAST_PART * parts.mean(dim=1, keepdim=True).clamp(min=_LEAST_LENGTH)
    parts = torch.maximum(parts, least)
    shares = parts / parts.sum(dim=1, keepdim=True)
    squares = shares * shares
    slopes = weights * torch.where(_has_two(weights), squares * squares, shares)
    return slopes / slopes.sum(dim=1, keepdim=True)


def gains_for_rows(
    weights: Float[Tensor, "r o"], kept: Float[Tensor, "r o"], points: Float[Tensor, "p o"]
) -> Float[Tensor, " p"]:
    """Return by what share each point is better for a row than what it keeps, over all rows."""
    scaled = weights / (kept * weights).sum(dim=1, keepdim=True)
    own = _norms(scaled, kept).diagonal()[:, None]
    exponent = 8 if weights.shape[1] < _FLAT else 2
    shorter = 1 - (_norms(scaled, points) / own) ** (1 / exponent)
    return shorter.clamp(min=0).sum(dim=0)


def _norms(scaled: Float[Tensor, "r o"], points: Float[Tensor, "p o"]) -> Float[Tensor, "r p"]:
    """Return the norm of each point's lengths, times the weights of each row, to its exponent."""
    parts = scaled[..., None] * points.T
    squares = parts * parts
    fourths = squares * squares
    return torch.where(_has_two(scaled), fourths * fourths, squares).sum(dim=1)


def _has_two(weights: Float[Tensor, "r o"]) -> Bool[Tensor, ""]:
    """Return whether there are two objectives, written so that their number stays free."""
    return torch.ones_like(weights[0]).sum() < _FLAT


def _numbers(rows: Float[Tensor, "r 1"]) -> Int[Tensor, "r 1"]:
    return torch.arange(rows.shape[0], device=rows.device)[:, None]
