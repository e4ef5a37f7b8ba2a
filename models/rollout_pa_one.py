"""Tours drawn from PA-One with their likelihoods, and the loss of imitating an expert's tours."""

from collections.abc import Callable
from typing import NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Generator, Tensor
from torch.nn.functional import binary_cross_entropy_with_logits

from models.networks.joining.candidates import (
    Candidates,
    cheapest_candidates,
    joined_at_cost,
    no_more_possible,
    single_cities,
    toured,
)
from models.networks.joining.costs import Costs
from models.networks.joining.fragments import NEVER, Fragments, impossible, mutual_best

_TEMPERATURE = 0.5  # of the distribution that is drawn from, against log-odds

# From costs, fragments and candidates to the log-odds of each edge, (r, e, c).
EdgeLogits = Callable[[Costs, Fragments, Candidates], Tensor]


class Judgement(NamedTuple):
    """A network that rates edges, the candidates of an end, and the joinings of one look."""

    edge_logits: EdgeLogits
    candidates: int
    joinings: int


def sampled_tours(
    judgement: Judgement, costs: Costs, generator: Generator
) -> tuple[Int[Tensor, "r n"], Float[Tensor, " r"]]:
    """Draw a tour for each row of costs, and return their log-likelihoods.

    Noise is added to the logit of each edge: with Gumbel's distribution, the best of several edges
    is then drawn from their softmax. The log-likelihood treats the choice of each fragment among
    its own edges as a separate draw. That is exact except for edges that two fragments share.
    """
    fragments, likelihoods = joined_by_chance(judgement, costs, single_cities(costs), generator)
    return toured(costs, fragments), likelihoods


def joined_by_chance(
    judgement: Judgement,
    costs: Costs,
    fragments: Fragments,
    generator: Generator,
    enough: int = 1,
) -> tuple[Fragments, Float[Tensor, " r"]]:
    """Join fragments of each row until `enough` are left, and return the log-likelihoods."""
    likelihoods = torch.zeros_like(costs.means[:, 0, 0])
    while bool((fragments.left > enough).any()):
        candidates = cheapest_candidates(costs, fragments, judgement.candidates)
        positions = candidates.positions
        logits = judgement.edge_logits(costs, fragments, candidates) / _TEMPERATURE
        noisy = logits.detach() + _noise(positions, generator)
        before = fragments
        for _ in range(judgement.joinings):
            forbidden = no_more_possible(candidates, before, fragments)
            forbidden = forbidden | ~fragments.open[..., None]
            noisy = torch.where(forbidden, -NEVER, noisy)
            logits = torch.where(forbidden, -NEVER, logits)
            mates = mutual_best(fragments, positions, noisy)
            likelihoods = likelihoods + _log_likelihoods(fragments, positions, logits, mates)
            fragments = joined_at_cost(costs, fragments, mates)
        fragments = fragments.trimmed()
    return fragments, likelihoods


def imitation_loss(
    judgement: Judgement, costs: Costs, tours: Int[Tensor, "r n"]
) -> Float[Tensor, ""]:
    """Return the binary cross-entropy of each edge to a candidate, summed, for each end.

    There is one tour for each row of costs. Of the edges that the expert's tours have,
    those with the highest logits are taken, until the tours are whole or no candidates are left
    among them.
    """
    fragments = single_cities(costs)
    loss, ends = costs.means.new_zeros(()), costs.means.new_zeros(())
    while bool((fragments.left > 2).any()):
        candidates = cheapest_candidates(costs, fragments, judgement.candidates)
        positions, real = candidates.positions, candidates.real
        logits = judgement.edge_logits(costs, fragments, candidates)
        expected = _in_tours(tours, fragments.ends, positions) & real
        entropies = binary_cross_entropy_with_logits(logits, expected.float(), reduction="none")
        loss = loss + torch.where(real, entropies, 0.0).sum()
        ends = ends + fragments.open.sum()
        allowed = torch.where(expected, logits.detach(), -NEVER)
        before = fragments.left.sum()
        for _ in range(judgement.joinings):
            allowed = torch.where(impossible(fragments, positions), -NEVER, allowed)
            mates = mutual_best(fragments, positions, allowed)
            fragments = joined_at_cost(costs, fragments, mates)
        if bool(fragments.left.sum() == before):
            break
        fragments = fragments.trimmed()
    return loss / ends


def _noise(positions: Int[Tensor, "r e c"], generator: Generator) -> Float[Tensor, "r e c"]:
    """Draw the noise of each edge: the same for both directions."""
    r, e, _ = positions.shape
    drawn = torch.empty(r, e * e, device=positions.device).exponential_(generator=generator)
    index = torch.arange(e, device=positions.device)[:, None]
    edges = torch.minimum(index, positions) * e + torch.maximum(index, positions)
    return -drawn.gather(1, edges.flatten(1)).log().view_as(positions)


def _log_likelihoods(
    fragments: Fragments,
    positions: Int[Tensor, "r e c"],
    logits: Float[Tensor, "r e c"],
    mates: Int[Tensor, "r e"],
) -> Float[Tensor, " r"]:
    """Return the log-likelihood of the edges to the mates, each among all of its fragment's."""
    names = fragments.names
    lowest = torch.full_like(logits[..., 0], -NEVER)
    highest = lowest.scatter_reduce(1, names, logits.detach().amax(dim=-1), "amax")
    above = logits - highest.gather(1, names)[..., None]
    sums = torch.zeros_like(lowest).scatter_add(1, names, above.exp().sum(dim=-1))
    # The entries that fill up the candidates of an end may name its mate, too.
    is_chosen = (positions == mates[..., None]) & (logits > -NEVER / 2)
    shares = above - sums.gather(1, names)[..., None].log()
    return torch.where(is_chosen, shares, 0.0).sum(dim=(1, 2))


def _in_tours(
    tours: Int[Tensor, "r n"], ends: Int[Tensor, "r e"], positions: Int[Tensor, "r e c"]
) -> Bool[Tensor, "r e c"]:
    """Return whether each end and each of its candidates are neighbours in its row's tour."""
    places = tours.argsort(dim=1).gather(1, ends)
    theirs = places.gather(1, positions.flatten(1)).view_as(positions)
    apart = (theirs - places[..., None]).abs()
    return (apart == 1) | (apart == tours.shape[1] - 1)
