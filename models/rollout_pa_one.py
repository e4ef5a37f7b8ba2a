"""Learning to join: tours drawn from PA-One with their likelihoods, and what imitation costs it."""

import torch
from jaxtyping import Bool, Float, Int
from torch import Generator, Tensor
from torch.nn.functional import binary_cross_entropy_with_logits

from models.data.dataset import Batch
from models.lagrangian import weights
from models.networks.fragments import NEVER, Fragments, best_mates, joined, possible, walked
from models.networks.pa_one import JOININGS, OneActor, begun, by_weight, look, padded_distances

_TEMPERATURE = 0.5  # of what is drawn, against log-odds


def sampled_tours(
    actor: OneActor,
    instances: Float[Tensor, "b n 4"],
    preferences: Float[Tensor, "k 2"],
    times: int,
    generator: Generator,
) -> tuple[Int[Tensor, "b r n"], Float[Tensor, "b r"]]:
    """Tours, several for each preference one after the other, and how likely they were.

    Each edge is wanted more or less by chance (Gumbel's distribution, so that the best of several
    is drawn from their softmax). The log-likelihood takes each fragment's choice among its own
    edges for a draw of its own, which it is but for edges that two fragments share.
    """
    costs = _costs(instances, preferences).repeat_interleave(times, dim=0)
    fragments = begun(costs)
    likelihoods = costs.new_zeros(len(costs))
    while bool((fragments.left > 1).any()):
        seen = look(costs, fragments)
        logits = actor.wanted(costs, fragments, seen) / _TEMPERATURE
        noisy = logits.detach() + _noise(seen.candidates, generator)
        for _ in range(JOININGS):
            may = possible(fragments, seen.candidates)
            noisy, logits = (torch.where(may, each, -NEVER) for each in (noisy, logits))
            mates = best_mates(fragments, seen.candidates, noisy)
            likelihoods = likelihoods + _chosen(fragments, seen.candidates, logits, mates)
            fragments = joined(fragments, mates)
        fragments = fragments.trimmed()
    by_instance = (len(instances), -1)
    return walked(fragments).unflatten(0, by_instance), likelihoods.unflatten(0, by_instance)


def imitation_loss(actor: OneActor, batch: Batch) -> Float[Tensor, ""]:
    """The binary cross-entropy of each edge that the network looks at, summed, for each end.

    There is one tour for each instance and preference. Of the edges that the expert's tours have,
    those are taken that the network wants most, until the tours are whole or it sees no more of
    them.
    """
    costs = _costs(batch.instances, batch.preferences)
    tours = batch.tours.flatten(0, 1)
    fragments = begun(costs)
    loss, ends = costs.new_zeros(()), costs.new_zeros(())
    while bool((fragments.left > 2).any()):
        seen = look(costs, fragments)
        wanted = actor.wanted(costs, fragments, seen)
        theirs = _in_tours(tours, fragments.ends, seen.candidates) & seen.real
        each = binary_cross_entropy_with_logits(wanted, theirs.float(), reduction="none")
        loss = loss + torch.where(seen.real, each, 0.0).sum()
        ends = ends + fragments.open.sum()
        allowed = torch.where(theirs, wanted.detach(), -NEVER)
        before = fragments.left.sum()
        for _ in range(JOININGS):
            allowed = torch.where(possible(fragments, seen.candidates), allowed, -NEVER)
            fragments = joined(fragments, best_mates(fragments, seen.candidates, allowed))
        if bool(fragments.left.sum() == before):
            break
        fragments = fragments.trimmed()
    return loss / ends


def _costs(
    instances: Float[Tensor, "b n 4"], preferences: Float[Tensor, "k 2"]
) -> Float[Tensor, "r n m"]:
    rows = weights(preferences)
    return torch.cat([by_weight(padded_distances(cities), rows) for cities in instances])


def _noise(candidates: Int[Tensor, "r e c"], generator: Generator) -> Float[Tensor, "r e c"]:
    """What chance adds to each edge: the same to both directions."""
    r, e, _ = candidates.shape
    drawn = torch.empty(r, e * e, device=candidates.device).exponential_(generator=generator)
    each = torch.arange(e, device=candidates.device)[:, None]
    edges = torch.minimum(each, candidates) * e + torch.maximum(each, candidates)
    return -drawn.gather(1, edges.flatten(1)).log().view_as(candidates)


def _chosen(
    fragments: Fragments,
    candidates: Int[Tensor, "r e c"],
    logits: Float[Tensor, "r e c"],
    mates: Int[Tensor, "r e"],
) -> Float[Tensor, " r"]:
    """The log-likelihood of the edges to the mates, each among all of its fragment's edges."""
    names = fragments.names
    nothing = torch.full_like(logits[..., 0], -NEVER)
    highest = nothing.scatter_reduce(1, names, logits.detach().amax(dim=-1), "amax")
    above = logits - highest.gather(1, names)[..., None]
    sums = torch.zeros_like(nothing).scatter_add(1, names, above.exp().sum(dim=-1))
    # What fills up the candidates of an end may name its mate, too.
    is_chosen = (candidates == mates[..., None]) & (logits > -NEVER / 2)
    shares = above - sums.gather(1, names)[..., None].log()
    return torch.where(is_chosen, shares, 0.0).sum(dim=(1, 2))


def _in_tours(
    tours: Int[Tensor, "r n"], ends: Int[Tensor, "r e"], candidates: Int[Tensor, "r e c"]
) -> Bool[Tensor, "r e c"]:
    """Whether each end and each of its candidates are neighbours in its row's tour."""
    places = tours.argsort(dim=1).gather(1, ends)
    theirs = places.gather(1, candidates.flatten(1)).view_as(candidates)
    apart = (theirs - places[..., None]).abs()
    return (apart == 1) | (apart == tours.shape[1] - 1)
