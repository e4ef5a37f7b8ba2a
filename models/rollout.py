"""Tours from an actor that builds them city by city, and their log-likelihoods.

They are built without gradients; the log-likelihoods of finished tours come from
one pass over all their moments at once (teacher forcing), which is where gradients flow.
"""

from collections.abc import Callable

import torch
from jaxtyping import Float, Int
from torch import Generator, Tensor

from models.networks.build import Conditioning, Memory, StepwiseActor
from models.networks.stepwise import Moment

# How the next cities, (b, r), follow from the logits, (b, r, n).
Choose = Callable[[Tensor], Tensor]


def greedily(logits: Float[Tensor, "b r n"]) -> Int[Tensor, "b r"]:
    """The likeliest city; of equals the first."""
    return logits.argmax(dim=-1)


def sampling(generator: Generator) -> Choose:
    """A way to choose that draws from the softmax, by the Gumbel-max trick."""

    def choose(logits: Float[Tensor, "b r n"]) -> Int[Tensor, "b r"]:
        noise = torch.empty_like(logits).exponential_(generator=generator)
        return (logits - noise.log()).argmax(dim=-1)

    return choose


def starts_in_turn(preferences: Float[Tensor, "r 2"], instances: Tensor) -> Int[Tensor, " r"]:
    """A first city for each preference, for neighbouring ones different cities.

    The tours of neighbouring preferences would otherwise repeat each other's mistakes, and add
    little to each other's front.
    """
    each = torch.arange(preferences.shape[0], device=preferences.device)
    n = torch.zeros_like(each) + instances.shape[-2]  # the exporter wants a tensor on both sides
    return each % n


@torch.no_grad()
def roll_out(
    actor: StepwiseActor,
    memory: Memory,
    rows: Conditioning,
    starts: Int[Tensor, "b r"],
    choose: Choose,
) -> Int[Tensor, "b r n"]:
    """A tour for each row. Actors that choose their first city disregard the starts."""
    decoder = actor.decoder
    n = memory.pointers.shape[-1]
    visited = torch.zeros(*starts.shape, n, dtype=torch.bool, device=starts.device)
    nowhere = torch.full_like(starts, n)
    tour = [nowhere] * 3
    if decoder.chooses_first:
        moment = Moment(_recent(tour), nowhere, visited)
        starts = choose(decoder.logits(memory, rows, moment))
    tour.append(starts)
    visited.scatter_(-1, starts[..., None], True)
    for _ in range(1, n):
        moment = Moment(_recent(tour), starts, visited)
        tour.append(choose(decoder.logits(memory, rows, moment)))
        visited.scatter_(-1, tour[-1][..., None], True)
    return torch.stack(tour[3:], dim=-1)


def _recent(tour: list[Tensor]) -> Int[Tensor, "b r 3"]:
    return torch.stack(tour[:-4:-1], dim=-1)


def log_likelihoods(
    actor: StepwiseActor, memory: Memory, rows: Conditioning, tours: Int[Tensor, "b r n"]
) -> Float[Tensor, "b r"]:
    """The log-likelihood of each tour: the sum over the cities that the actor chose."""
    return log_likelihoods_by_city(actor, memory, rows, tours).sum(dim=-1)


def log_likelihoods_by_city(
    actor: StepwiseActor, memory: Memory, rows: Conditioning, tours: Int[Tensor, "b r n"]
) -> Float[Tensor, "b r t"]:
    """The log-likelihood of each city that the actor chose, given those before it in its tour."""
    b, r, _ = tours.shape
    moments, targets = _moments(tours, actor.decoder.chooses_first)
    logits = actor.decoder.logits(memory, repeated(rows, targets.shape[-1]), moments)
    chosen = logits.float().log_softmax(dim=-1).gather(-1, targets.reshape(b, -1, 1))
    return chosen.view(b, r, -1)


def repeated(rows: Conditioning, times: int) -> Conditioning:
    """Each row several times, one copy after the other."""
    return type(rows)(*(part.repeat_interleave(times, dim=0) for part in rows))


def _moments(
    tours: Int[Tensor, "b r n"], chooses_first: bool
) -> tuple[Moment, Int[Tensor, "b r t"]]:
    """All moments of the tours as rows, b by r t, and the cities that follow them."""
    n = tours.shape[-1]
    position = tours.argsort(dim=-1)  # of each city in its tour
    now = torch.arange(n, device=tours.device)
    visited = position[:, :, None, :] < now[:, None]  # (b, r, t, n)
    recent = torch.stack([tours.roll(back, dims=-1) for back in (1, 2, 3)], dim=-1)
    recent[..., now[:, None] < torch.arange(1, 4, device=tours.device)] = n
    first = tours[..., :1].expand_as(tours).clone()
    first[..., 0] = n
    begin = 0 if chooses_first else 1
    moment = Moment(
        recent[..., begin:, :].flatten(1, 2),
        first[..., begin:].flatten(1),
        visited[:, :, begin:].flatten(1, 2),
    )
    return moment, tours[..., begin:]
