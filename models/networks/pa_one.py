"""PA-One: an actor that joins cities to paths, and paths to a tour, where a network wants it.

A tour grows everywhere at once, as in the greedy edge heuristic (Bentley, 1992). In each round
every end of a path has its nearest ends as candidates, by the costs of a preference; a network
says how much each edge to them is wanted; and the edges that nothing better stands against are
taken. The ends that are left are looked at anew in the next round, so that the network always
sees the problem as it then is: a smaller one of the same kind. It knows nothing of coordinates,
preferences or the number of cities, only what the edges between neighbours cost, against each
other; which is why what it learns at 20 to 180 cities holds at 1000.
"""

from typing import NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

from models.config import NetworkConfig
from models.data.instances import distance_matrices
from models.lagrangian import weights
from models.networks.aiming import aimed
from models.networks.fragments import (
    NEVER,
    Fragments,
    all_alone,
    best_mates,
    joined,
    possible,
    walked,
)
from models.networks.layers import feedforward

CANDIDATES = 8  # of an end
_TOLD = 4  # features that an end tells its neighbours
_WEIGHED = 4  # hidden features of an edge
JOININGS = 2  # for one look of the network

# Bounds on what the network sees. Costs are in units of their mean over the candidates of a row.
_MOST = 5.0  # of a cost against the mean of the candidates of an end
_LEAST_SCALE = 1e-3
_STEEP = 1.5  # how fast edges are wanted less with such a cost, at first


class Look(NamedTuple):
    """What the candidates of each end cost, and their positions. Impossible ones cost NEVER."""

    costs: Float[Tensor, "r e c"]
    candidates: Int[Tensor, "r e c"]

    @property
    def real(self) -> Bool[Tensor, "r e c"]:
        """Whether there is such an edge."""
        return self.costs < NEVER / 2


def padded_distances(cities: Float[Tensor, "n 4"]) -> Float[Tensor, "2 n m"]:
    """Distances in each plane; no city has itself for a neighbour.

    There are as many columns more as an end has candidates, of cities that are never reached.
    """
    distances = distance_matrices(cities[None])[0]
    each = torch.arange(distances.shape[-1], device=cities.device)
    own = torch.where(each == each[:, None], NEVER, 0.0)
    return nn.functional.pad(distances + own, (0, CANDIDATES), value=NEVER)


def by_weight(
    distances: Float[Tensor, "2 n m"], weights: Float[Tensor, "r 2"]
) -> Float[Tensor, "r n m"]:
    """What a step costs each row."""
    return (weights @ distances.flatten(1)).unflatten(1, distances.shape[1:])


def begun(costs: Float[Tensor, "r n m"]) -> Fragments:
    """The fragments that a tour of each row begins from: cities alone."""
    return all_alone(costs[:, :, 0])


def first_look(costs: Float[Tensor, "r n m"]) -> Look:
    """What `look` finds while all cities are alone, for less."""
    cheapest, cities = costs.topk(CANDIDATES, largest=False)
    return Look(cheapest, torch.where(cheapest < NEVER / 2, cities, 0))


def look(costs: Float[Tensor, "r n m"], fragments: Fragments) -> Look:
    """The candidates of each end: the cheapest open ends."""
    ends, partners, open_ = fragments[:3]
    n = costs.shape[1]
    nobody = torch.zeros_like(costs[:, 0])
    place = torch.where(open_, ends, n)
    closed = (nobody + NEVER).scatter(1, place, torch.where(open_, 0.0, NEVER).to(costs))
    rows = torch.arange(costs.shape[0], device=costs.device)[:, None]
    from_ends = costs.flatten(0, 1).index_select(0, (n * rows + ends).flatten())
    open_costs = from_ends.unflatten(0, ends.shape) + closed[:, None]
    cheapest, cities = open_costs.topk(CANDIDATES, largest=False)
    each = torch.arange(ends.shape[1], device=costs.device).expand_as(ends)
    position = nobody.long().scatter(1, place, each)
    candidates = position.gather(1, cities.flatten(1)).view_as(cities)
    impossible = (candidates == partners[..., None]) | ~open_[..., None] | (cheapest >= NEVER / 2)
    return Look(torch.where(impossible, NEVER, cheapest), candidates)


class OneActor(nn.Module):
    """PA-One. Of the configuration it takes width, layers and feedforward."""

    reads = "coordinates"

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.embed = feedforward(5 * CANDIDATES + 6, config.width, config.feedforward)
        self.layers = nn.ModuleList(
            TellingLayer(config.width, config.feedforward) for _ in range(config.layers)
        )
        self.project_end = nn.Linear(config.width, _WEIGHED)
        self.project_edge = nn.Linear(2, _WEIGHED, bias=False)
        self.judge = nn.Linear(_WEIGHED, 1, bias=False)

    def wanted(
        self, costs: Float[Tensor, "r n m"], fragments: Fragments, seen: Look
    ) -> Float[Tensor, "r e c"]:
        """How much each edge is wanted, its log-odds; -NEVER where there is none."""
        real, near = seen.real, _Neighbours(seen, fragments.partners)
        found = torch.where(real, seen.costs, 0.0).sum(dim=-1)
        count = real.sum(dim=-1)
        unit = found.sum(dim=-1, keepdim=True) / count.sum(dim=-1, keepdim=True).clamp(min=1)
        unit = unit.clamp(min=1 / NEVER)  # (r, 1)
        scale = found / unit / count.clamp(min=1) + _LEAST_SCALE
        in_units = seen.costs / unit[..., None]
        own = (in_units / scale[..., None]).clamp(max=_MOST)
        nearest = own[..., 0]
        paths = fragments.on_paths.to(costs)
        told = near.candidates_of(torch.stack((1 / scale, nearest, paths), dim=-1).flatten(0, 1))
        told = told.unflatten(0, scale.shape)
        theirs = torch.where(real, in_units * told[..., 0], _MOST).clamp(max=_MOST)
        across = fragments_across(costs, fragments) / unit
        ends = (
            scale.log(),
            paths,
            (paths * across / scale).log1p(),
            fragments.left[:, None].to(costs).rsqrt().expand_as(scale),
            nearest,
            count.to(costs) / CANDIDATES,
        )
        known = torch.cat((own, theirs, told.flatten(2), torch.stack(ends, dim=-1)), dim=-1)
        features = self.embed(known.flatten(0, 1))
        for layer in self.layers:
            features = layer(features, near)
        of_ends = self.project_end(features)
        dear = own + theirs
        of_edges = torch.stack((dear, in_units.clamp(max=_MOST)), dim=-1).flatten(0, 1)
        weighed = near.candidates_of(of_ends) + of_ends[:, None] + self.project_edge(of_edges)
        wanted = self.judge(weighed.relu()).view_as(dear) - _STEEP * dear
        return torch.where(real, wanted, -NEVER)

    @torch.no_grad()
    def tours(
        self, instances: Float[Tensor, "b n 4"], preferences: Float[Tensor, "k 2"]
    ) -> Int[Tensor, "b k n"]:
        """A tour of each instance for each preference."""
        rows = weights(aimed(preferences))
        return torch.stack([self._tours(cities, rows) for cities in instances])

    def _tours(self, cities: Float[Tensor, "n 4"], rows: Float[Tensor, "k 2"]) -> Tensor:
        costs = by_weight(padded_distances(cities), rows)
        fragments = self.round(costs, begun(costs), first_look(costs)).trimmed()
        while bool((fragments.left > 1).any()):
            fragments = self.round(costs, fragments, look(costs, fragments)).trimmed()
        return walked(fragments)

    def round(self, costs: Float[Tensor, "r n m"], fragments: Fragments, seen: Look) -> Fragments:
        """The fragments after joining by what was seen."""
        wanted = self.wanted(costs, fragments, seen)
        fragments = joined(fragments, best_mates(fragments, seen.candidates, wanted))
        for _ in range(JOININGS - 1):
            wanted = torch.where(possible(fragments, seen.candidates), wanted, -NEVER)
            fragments = joined(fragments, best_mates(fragments, seen.candidates, wanted))
        return fragments


def fragments_across(costs: Float[Tensor, "r n m"], fragments: Fragments) -> Float[Tensor, "r e"]:
    """What the edge from each end to its partner would cost."""
    rows = torch.arange(costs.shape[0], device=costs.device)[:, None]
    return costs[rows, fragments.ends, fragments.ends.gather(1, fragments.partners)]


class _Neighbours:
    """Lookups of what other ends of the same row have; zeros where a candidate is impossible.

    Axis x is rows and ends, ends inner.
    """

    def __init__(self, seen: Look, partners: Int[Tensor, "r e"]) -> None:
        r, e, c = seen.candidates.shape
        first = e * torch.arange(r, device=partners.device)
        of_candidates = seen.candidates + first[:, None, None]
        self._candidates = torch.where(seen.real, of_candidates, r * e).flatten()
        self._partners = (partners + first[:, None]).flatten()
        self._each = c

    def candidates_of(self, features: Float[Tensor, "x d"]) -> Float[Tensor, "x c d"]:
        """The features of each end's candidates."""
        table = nn.functional.pad(features, (0, 0, 0, 1))
        return table.index_select(0, self._candidates).unflatten(0, (-1, self._each))

    def partners_of(self, features: Float[Tensor, "x d"]) -> Float[Tensor, "x d"]:
        """The features of each end's partner."""
        return features.index_select(0, self._partners)


class TellingLayer(nn.Module):
    """Ends tell a few features to those whose candidate or partner they are.

    Candidates come by ascending cost, so that one product over all of them side by side treats
    the nearest, the second and so on each in a way of its own.
    """

    def __init__(self, width: int, hidden: int) -> None:
        super().__init__()
        self.tell = nn.Linear(width, _TOLD)
        self.think = feedforward(width + (CANDIDATES + 1) * _TOLD, width, hidden)
        self.silence()

    def silence(self) -> None:
        """Makes the layer give back the features as they came, until it is trained."""
        for last in self.think[-1].parameters():
            nn.init.zeros_(last)

    def forward(self, features: Float[Tensor, "x d"], near: _Neighbours) -> Float[Tensor, "x d"]:
        """Features of the ends, each after listening to its neighbours."""
        told = self.tell(features).relu()
        heard = near.candidates_of(told).flatten(1)
        thought: Tensor = self.think(torch.cat((features, near.partners_of(told), heard), dim=-1))
        return features + thought
