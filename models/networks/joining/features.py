"""The features of ends and edges that the network reads: relative costs.

Costs are divided by their mean over the candidates of a row, so that the network does not see their
scale. The scale of an end is the mean cost of the edges to its candidates.
"""

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from models.networks.joining.candidates import Candidates
from models.networks.joining.fragments import NEVER, Fragments
from models.networks.joining.neighbours import Neighbours
from models.networks.rows import side_by_side

_MOST = 5.0  # of a cost against the mean of the candidates of an end
_LEAST_SCALE = 1e-3


class Seen(NamedTuple):
    """Features of ends and of edges to candidates.

    The relative cost of an edge is the sum of its costs in the scales of both ends. Directions are
    from -1 to 1, and None if costs do not differ by direction.
    """

    of_ends: Float[Tensor, "r e i"]
    of_edges: Float[Tensor, "r e c j"]
    relative_costs: Float[Tensor, "r e c"]
    directions: Float[Tensor, "r e c"] | None


class _Scales(NamedTuple):
    """The unit of each row; each end's scale in it, its number of candidates, and its costs."""

    unit: Float[Tensor, "r 1"]
    scale: Float[Tensor, "r e"]
    counts: Float[Tensor, "r e"]
    in_units: Float[Tensor, "r e c"]


def features_seen(
    across: Float[Tensor, "r e"],
    fragments: Fragments,
    candidates: Candidates,
    near: Neighbours,
) -> Seen:
    """Return what the network sees, given the cost of an edge from each end to its partner."""
    unit, scale, count, in_units = _scales(candidates)
    own = (in_units / side_by_side(scale, in_units.shape[2])).clamp(max=_MOST)
    nearest = own[..., :1]
    on_paths = fragments.on_paths.to(unit)
    inverse = 1 / scale
    known = torch.cat((inverse[..., None], nearest, on_paths[..., None]), dim=-1)
    theirs = in_units * candidates.theirs(inverse)
    theirs = theirs.clamp(max=_MOST)  # which those of impossible edges exceed
    of_ends = [
        *(own, theirs, near.side_by_side(known.flatten(0, 1)).view(*scale.shape, -1)),
        *(scale.log()[..., None], on_paths[..., None]),
        (on_paths * (across.clamp(min=0.0) / unit) / scale).log1p()[..., None],
        fragments.left[:, None].to(unit).rsqrt().expand_as(scale)[..., None],
        *(nearest, (count / own.shape[2])[..., None]),
    ]
    relative_costs = own + theirs
    of_edges = [relative_costs, in_units.clamp(max=_MOST)]
    directions = None
    if candidates.leans is not None and fragments.leans is not None:
        leans = torch.where(candidates.real, candidates.leans, 0.0) / unit[..., None]
        of_ends.append((leans / scale[..., None]).clamp(-_MOST, _MOST))
        of_ends.append((fragments.leans / unit / scale).clamp(-_MOST, _MOST)[..., None])
        directions = leans.clamp(-1, 1)
        of_edges.append(directions.abs())
    return Seen(
        torch.cat(of_ends, dim=-1), torch.stack(of_edges, dim=-1), relative_costs, directions
    )


def _scales(candidates: Candidates) -> _Scales:
    costs = candidates.costs.clamp(min=0.0)  # prices may be a little too high
    are_real = candidates.real.to(costs)
    total, count = (costs * are_real).sum(dim=-1), are_real.sum(dim=-1)
    unit = total.sum(dim=-1, keepdim=True) / count.sum(dim=-1, keepdim=True).clamp(min=1)
    unit = unit.clamp(min=1 / NEVER)
    scale = total / unit / count.clamp(min=1) + _LEAST_SCALE
    return _Scales(unit, scale, count, costs / unit[..., None])
