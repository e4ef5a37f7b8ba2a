"""Fragments: the paths that PA-One joins to a tour, and the operations that join them.

A row is one tour. Its *ends* are the cities that still need a neighbour: both ends of each path,
and every single city, which is one end but needs two neighbours. An end with all its neighbours is
closed; closed ends are removed from time to time. Paths have no direction. If costs differ by
direction, each end has a number: how much the path costs less if a tour leaves it at this end. The
code can be exported with any numbers of rows, ends and cities.
"""

from collections.abc import Sequence
from typing import NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from models.networks.rows import side_by_side

# The cost of an impossible edge, and minus its logit. Twice this is a finite float.
NEVER = 1e9
# Logits and numbers of edges make one integer, of up to 2**15 ends.
MOST_LOGIT, _PARTS_OF_ONE = 2.0**10, 2.0**20
_LEAST = -(2**62)


class Fragments(NamedTuple):
    """The fragments of each row, given by their ends; here and below e counts ends, by position.

    An end's partner is the position of the other end of its path; a city alone is its own. The
    links are the first neighbour of each city, then the second of each, then a place without
    meaning; minus one where a neighbour is missing. The lean of an end is half the cost that its
    path saves if it is travelled towards this end; None where costs have no direction.
    """

    ends: Int[Tensor, "r e"]
    partners: Int[Tensor, "r e"]
    open: Bool[Tensor, "r e"]
    links: Int[Tensor, "r l"]
    left: Int[Tensor, " r"]
    leans: Float[Tensor, "r e"] | None = None

    @property
    def on_paths(self) -> Bool[Tensor, "r e"]:
        """The ends that are of a path; the others are cities alone."""
        return self.partners != _positions(self.ends)

    @property
    def names(self) -> Int[Tensor, "r e"]:
        """One number for both ends of a fragment."""
        return torch.minimum(self.partners, _positions(self.ends))

    def trimmed(self) -> "Fragments":
        """Return the fragments without positions at which no row has an open end."""
        moved, kept = cleared(self)
        ends, partners, open_ = (part[:, : int(kept)] for part in moved[:3])
        leans = None if moved.leans is None else moved.leans[:, : int(kept)]
        return Fragments(ends, partners, open_, self.links, self.left, leans)


def _positions(positions: Tensor) -> Int[Tensor, " e"]:
    return torch.arange(positions.shape[1], device=positions.device)


def all_alone(like: Float[Tensor, "r n"], *, leaning: bool = False) -> Fragments:
    """Return every city as a fragment of its own, for the rows and cities of the tensor."""
    zeros = torch.zeros_like(like, dtype=torch.long)
    cities = zeros + torch.arange(like.shape[1], device=like.device)
    links = torch.cat((zeros, zeros, zeros[:, :1]), dim=1) - 1
    leans = torch.zeros_like(like) if leaning else None
    return Fragments(cities, cities.clone(), zeros == 0, links, (zeros + 1).sum(dim=1), leans)


def cleared(fragments: Fragments) -> tuple[Fragments, Int[Tensor, ""]]:
    """Return the open ends of each row first, and how many positions hold an open end."""
    open_ = fragments.open
    positions = open_.long().cumsum(dim=1) - 1
    e = open_.shape[1]
    index = _positions(open_).expand_as(positions)
    room = torch.cat((index, index[:, :1]), dim=1)  # closed ends go beyond the last
    order = room.scatter(1, torch.where(open_, positions, e), index)[:, :-1]
    kept = open_.sum(dim=1, keepdim=True)
    partners = positions.gather(1, fragments.partners.gather(1, order))
    moved = Fragments(
        fragments.ends.gather(1, order),
        torch.where(index < kept, partners, index),
        index < kept,
        fragments.links,
        fragments.left,
        None if fragments.leans is None else fragments.leans.gather(1, order),
    )
    return moved, kept.max()


def impossible(fragments: Fragments, candidates: Int[Tensor, "r e c"]) -> Bool[Tensor, "r e c"]:
    """Return whether each end, if it is open, may not be joined to each of its candidates.

    Candidates are given by position.
    """
    names = fragments.names.float()  # which are compared faster
    theirs = torch.where(fragments.open, names, -1.0).gather(1, candidates.flatten(1))
    theirs = theirs.view_as(candidates)
    return (theirs < 0) | (theirs == side_by_side(names, candidates.shape[2]))


def mutual_best(
    fragments: Fragments, candidates: Int[Tensor, "r e c"], edge_logits: Float[Tensor, "r e c"]
) -> Int[Tensor, "r e"]:
    """Return the end to which to join each end, by position, or minus one.

    Every open end names its candidate with the highest logit, and two fragments are joined by an
    edge if no other edge that either of them names, or is named for, has a higher logit; of edges
    whose logits are the same to a millionth, by the one with the highest number. So
    each fragment is joined to one other at most, no cycle closes, and in every row some are joined.
    The logit of an edge is the same for both its ends, and -NEVER where it is impossible.
    """
    best, which = edge_logits.max(dim=-1)
    index, c = _positions(best), candidates.shape[2]
    mates = candidates.flatten(1).gather(1, which + c * index)
    e = edge_logits.shape[1]
    numbers = torch.minimum(index, mates) * e + torch.maximum(index, mates)
    logits = (best * _PARTS_OF_ONE).long()
    is_named = fragments.open & (best > -NEVER / 2)
    ranks = torch.where(is_named, logits * (e * e) + numbers, _LEAST)
    highest = ranks.scatter_reduce(1, mates, ranks, "amax")
    highest = torch.maximum(highest, highest.gather(1, fragments.partners))
    agreed = is_named & (highest == ranks) & (highest.gather(1, mates) == ranks)
    # To the mate, too, where it is not the end that it names itself.
    chosen, back = (torch.where(agreed, ends, -1) for ends in (mates, index))
    return chosen.scatter_reduce(1, mates, back, "amax")


def joined(
    fragments: Fragments,
    mates: Int[Tensor, "r e"],
    edge_leans: Float[Tensor, "r e"] | None = None,
) -> Fragments:
    """Return the fragments with each end joined to its mate, if it has one.

    The lean of the edge to a mate is half the difference between its cost and the cost back.
    """
    return linked([fragments, grown(fragments, mates, edge_leans)], [mates])


def grown(
    fragments: Fragments,
    mates: Int[Tensor, "r e"],
    edge_leans: Float[Tensor, "r e"] | None = None,
) -> Fragments:
    """Return the fragments joined like that, with the links and the number left of before."""
    ends, partners, open_, links, left, leans = fragments
    at = mates >= 0
    if leans is not None and edge_leans is not None:
        gained = torch.where(at, leans.gather(1, mates.clamp(min=0)) + edge_leans, 0.0)
        leans = leans + gained.gather(1, partners)
    # The partner of a partner is the end itself.
    through = torch.where(at, mates, partners)
    beyond = partners.gather(1, through).gather(1, partners)
    return Fragments(ends, beyond, open_ & ~(at & fragments.on_paths), links, left, leans)


def linked(growing: Sequence[Fragments], mates: Sequence[Int[Tensor, "r e"]]) -> Fragments:
    """Return the last of these fragments with its links and the number left.

    Each has grown from the one before, its ends joined to these mates. An end of a path is joined
    once, to its second neighbour, and a city alone to its first one before.
    """
    ends, links, left = growing[0].ends, growing[0].links, growing[0].left
    both = torch.zeros_like(ends)  # positions of mates, from 1 on
    seconds = torch.zeros_like(ends)
    for fragments, of_ends in zip(growing, mates, strict=False):
        both = both + (of_ends + 1)
        seconds = seconds + (of_ends + 1) * fragments.on_paths
    found = torch.cat((both - seconds, seconds), dim=1)
    n = (links.shape[1] - 1) // 2
    places = torch.where(found > 0, torch.cat((ends, ends + n), dim=1), 2 * n)
    links = links.scatter(1, places, ends.gather(1, (found - 1).clamp(min=0)))
    return growing[-1]._replace(links=links, left=left - (found > 0).sum(dim=1) // 2)


def first_open(fragments: Fragments) -> Int[Tensor, "r 1"]:
    """Return the position of the first end of each row that is open."""
    return fragments.open.long().argmax(dim=1, keepdim=True)
