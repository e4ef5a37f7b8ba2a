"""Tours from a decoder that builds them city by city, and their log-likelihoods.

They are built without gradients; the log-likelihoods of finished tours come from one pass over
all their moments at once (teacher forcing), through which the gradients flow.
"""

from collections.abc import Callable

import torch
from jaxtyping import Float, Int
from torch import Generator, Tensor

from models.networks.rows import repeated
from models.networks.stepwise import Conditioning, Decoder, Memory, Moment

# From logits, (b, r, n), to the next cities, (b, r).
Choose = Callable[[Tensor], Tensor]


def greedily(logits: Float[Tensor, "b r n"]) -> Int[Tensor, "b r"]:
    """Return the likeliest city; of equals the first."""
    return logits.argmax(dim=-1)


def sampling(generator: Generator) -> Choose:
    """Return a way to choose that draws from the softmax, by the Gumbel-max trick."""

    def choose(logits: Float[Tensor, "b r n"]) -> Int[Tensor, "b r"]:
        noise = torch.empty_like(logits).exponential_(generator=generator)
        return (logits - noise.log()).argmax(dim=-1)

    return choose


def starts_in_turn(preferences: Float[Tensor, "r 2"], instances: Tensor) -> Int[Tensor, " r"]:
    """Return a first city for each preference, for neighbouring ones different cities.

    The tours of neighbouring preferences would otherwise repeat each other's mistakes, and add
    little to each other's front.
    """
    index = torch.arange(preferences.shape[0], device=preferences.device)
    n = torch.zeros_like(index) + instances.shape[-2]  # the exporter wants a tensor on both sides
    return index % n


@torch.no_grad()
def roll_out(
    decoder: Decoder,
    memory: Memory,
    rows: Conditioning,
    starts: Int[Tensor, "b r"],
    choose: Choose,
) -> Int[Tensor, "b r n"]:
    """Build a tour for each row. Decoders that choose the first city ignore the starts."""
    n = memory.pointers.shape[-1]
    visited = torch.zeros(*starts.shape, n, dtype=torch.bool, device=starts.device)
    no_city = torch.full_like(starts, n)
    tour = [no_city] * 3
    if decoder.chooses_first:
        moment = Moment(_recent(tour), no_city, visited)
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
    decoder: Decoder, memory: Memory, rows: Conditioning, tours: Int[Tensor, "b r n"]
) -> Float[Tensor, "b r"]:
    """Return the log-likelihood of each tour: the sum over the cities that were chosen."""
    return log_likelihoods_by_city(decoder, memory, rows, tours).sum(dim=-1)


def log_likelihoods_by_city(
    decoder: Decoder, memory: Memory, rows: Conditioning, tours: Int[Tensor, "b r n"]
) -> Float[Tensor, "b r t"]:
    """Return the log-likelihood of each chosen city, given those before it in its tour."""
    b, r, _ = tours.shape
    moments, targets = _moments(tours, decoder.chooses_first)
    logits = decoder.logits(memory, repeated(rows, targets.shape[-1]), moments)
    chosen = logits.float().log_softmax(dim=-1).gather(-1, targets.reshape(b, -1, 1))
    return chosen.view(b, r, -1)


def _moments(
    tours: Int[Tensor, "b r n"], chooses_first: bool
) -> tuple[Moment, Int[Tensor, "b r t"]]:
    """Return all moments of the tours as rows, b by r t, and the cities that follow them."""
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
