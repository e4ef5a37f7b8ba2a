"""The last few fragments of each row, joined to one path: of all ways the cheapest as a tour.

There are 443 ways to close up to five fragments to a tour. The cost of each is a sum of costs of
edges, so one product of matrices has the costs of all ways in all rows. The code can be exported.
"""

from itertools import permutations, product
from typing import NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from models.networks.joining.costs import Costs
from models.networks.joining.fragments import NEVER, Fragments

ENOUGH = 5  # fragments, which are joined in the cheapest way
_SLOTS = 2 * ENOUGH  # for the first end of each fragment, then for the second of each


class _Ways(NamedTuple):
    """All ways to close fragments to a tour, a column each; the last edge of a way is left out.

    Parts are what a way's cost is a sum of: costs of edges between two slots; NEVER for a city
    alone that is gone through in the other direction, as this is the same tour; and NEVER for
    another number of fragments. Leans are those of the same edges, then of the first ends of
    fragments. Mates are the slots to which each slot is joined; minus one where it is not.
    """

    parts: Float[Tensor, "p w"]
    leans: Float[Tensor, "q w"]
    mates: Int[Tensor, "w s"]
    last: Int[Tensor, "w 1"]


_EDGES = [(a, b) for a in range(_SLOTS) for b in range(a + 1, _SLOTS)]


def _way(order: tuple[int, ...], turned: tuple[bool, ...]) -> tuple[list[float], ...]:
    """Return the parts, the leans and the mates of a way, and its last slot.

    The order is that of the fragments, the first one first; some of the others are turned.
    """
    alone, numbers = [0.0] * ENOUGH, [NEVER] * ENOUGH
    leans = [0.0] * ENOUGH
    numbers[len(order) - 1] = 0.0
    mates = [-1.0] * _SLOTS
    entries, exits = [], []
    for fragment, is_turned in zip(order, turned, strict=True):
        slots = fragment, fragment + ENOUGH
        entries.append(slots[is_turned])
        exits.append(slots[not is_turned])
        leans[fragment] = -1.0 if is_turned else 1.0
        alone[fragment] = 0.0 if is_turned or fragment == 0 else NEVER
    if order[1:] > order[:0:-1] or turned[1:] == (True,):
        alone[0] = NEVER  # the same tour in the other direction
    edges = [0.0] * len(_EDGES)
    signs = [0.0] * len(_EDGES)
    for start, stop in zip(exits, entries[1:] + entries[:1], strict=True):
        edge = _EDGES.index((min(start, stop), max(start, stop)))
        edges[edge] = 1.0
        signs[edge] = 1.0 if start < stop else -1.0
    for start, stop in zip(exits, entries[1:], strict=False):
        mates[start], mates[stop] = float(stop), float(start)
    return [*edges, *alone, *numbers], [*signs, *leans], mates, [float(exits[-1])]


def _all_ways() -> _Ways:
    ways = [
        _way((0, *order), (False, *turned))
        for count in range(1, ENOUGH + 1)
        for order in permutations(range(1, count))
        for turned in product((False, True), repeat=count - 1)
    ]
    parts, leans, mates, last = (torch.tensor(part) for part in zip(*ways, strict=True))
    return _Ways(parts.T.contiguous(), leans.T.contiguous(), mates.long(), last.long())


_WAYS = _all_ways()


def joined_to_one(costs: Costs, fragments: Fragments) -> Fragments:
    """Return one fragment for each row, joined of five at most so that its tour is the cheapest."""
    slots = _slots(fragments)
    cities = fragments.ends.gather(1, slots)
    is_alone = slots[:, :ENOUGH] == slots[:, ENOUGH:]
    way, lean = _cheapest(costs, fragments, slots, is_alone)
    ways = _Ways(*(part.to(way.device) for part in _WAYS))
    mates = ways.mates.index_select(0, way)
    n = (fragments.links.shape[1] - 1) // 2
    # A city alone is joined at its second slot first.
    seconds = torch.cat((torch.ones_like(is_alone), ~is_alone), dim=1).long()
    places = torch.where(mates >= 0, cities + n * seconds, 2 * n)
    links = fragments.links.scatter(1, places, cities.gather(1, mates.clamp(min=0)))
    both = torch.cat((slots[:, :1], slots.gather(1, ways.last.index_select(0, way))), dim=1)
    partners = torch.zeros_like(fragments.partners).scatter(1, both, both.flip(1))
    open_ = torch.zeros_like(partners).scatter(1, both, torch.ones_like(both)) > 0
    leans = fragments.leans
    if leans is not None and lean is not None:
        first, last = fragments.ends.gather(1, both).chunk(2, dim=1)
        closing = costs.steps(last, first)[1]
        assert closing is not None
        path = lean - closing
        leans = torch.zeros_like(leans).scatter(1, both, torch.cat((path, -path), dim=1))
    return Fragments(fragments.ends, partners, open_, links, torch.ones_like(fragments.left), leans)


def _slots(fragments: Fragments) -> Int[Tensor, "r s"]:
    """Return the positions of the first end of each fragment, then of the second of each."""
    partners = fragments.partners
    index = torch.arange(partners.shape[1], device=partners.device).expand_as(partners)
    is_first = fragments.open & (index <= partners)
    places = torch.where(is_first, is_first.long().cumsum(dim=1) - 1, ENOUGH)
    room = fragments.left[:, None] * torch.zeros(
        ENOUGH + 1, dtype=torch.long, device=partners.device
    )
    firsts = room.scatter(1, places, index)[:, :ENOUGH]
    return torch.cat((firsts, partners.gather(1, firsts)), dim=1)


def _cheapest(
    costs: Costs, fragments: Fragments, slots: Int[Tensor, "r s"], is_alone: Bool[Tensor, "r f"]
) -> tuple[Int[Tensor, " r"], Float[Tensor, "r 1"] | None]:
    """Return the cheapest way of each row, and what it costs more than the other direction."""
    cities = fragments.ends.gather(1, slots)
    starts, stops = (
        cities.index_select(1, ends) for ends in torch.tensor(_EDGES, device=cities.device).T
    )
    means, leans = costs.steps(starts, stops)
    numbers = fragments.left[:, None] == torch.arange(1, ENOUGH + 1, device=cities.device)
    parts = torch.cat((means, is_alone.to(means), numbers.to(means)), dim=1)
    of_ways = parts @ _WAYS.parts.to(parts)
    if leans is None or fragments.leans is None:
        return of_ways.argmin(dim=1), None
    of_fragments = fragments.leans.gather(1, slots[:, :ENOUGH])
    leaning = torch.cat((leans, of_fragments), dim=1) @ _WAYS.leans.to(parts)
    way = (of_ways - leaning.abs()).argmin(dim=1, keepdim=True)
    return way[:, 0], leaning.gather(1, way)
