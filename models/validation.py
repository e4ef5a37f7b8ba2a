"""How good an actor is: the hypervolume of its greedy front on fixed instances."""

from collections.abc import Callable
from dataclasses import dataclass

import torch
from jaxtyping import Float, Int
from torch import Generator, Tensor

from models.data.instances import tour_lengths
from models.data.sampling import fan_of_preferences, uniform_instances
from models.networks.build import Actor
from models.networks.pa_one import OneActor
from models.rollout import greedily, roll_out, starts_in_turn
from service.pareto import hypervolume

_SEED = 20_220_303  # apart from the seeds of training and from the instances of the paper
_PREFERENCES = 100
COUNTS = {40: 16, 200: 3}  # instances by number of cities, in training and for releases


@dataclass(frozen=True)
class ValidationSet:
    """Fixed instances of one size."""

    cities: int
    instances: Tensor


def validation_sets(
    reads: str, counts: dict[int, int], device: torch.device
) -> list[ValidationSet]:
    """For each number of cities, as many uniform instances as are asked for; always the same."""
    return [
        ValidationSet(
            n, uniform_instances(reads, count, n, Generator().manual_seed(_SEED + n), device)
        )
        for n, count in counts.items()
    ]


@torch.no_grad()
def greedy_tours(
    actor: Actor, instances: Tensor, preferences: Float[Tensor, "k 2"]
) -> Int[Tensor, "b k n"]:
    """The greedy tour of each instance and preference."""
    if isinstance(actor, OneActor):
        return actor.tours(instances, preferences)
    rows, _, places = actor.grouped(preferences)
    starts = starts_in_turn(rows, instances).repeat(len(instances), 1)
    memory = actor.remember(instances, rows)
    return roll_out(actor, memory, actor.decoder.condition(rows), starts, greedily)[:, places]


# Tours (b, k, n) of instances and preferences (k, 2), whoever builds them.
Build = Callable[[Tensor, Tensor], Tensor]


def mean_hypervolume(build: Build, validation: ValidationSet) -> float:
    """Mean over the instances, reference point (n, n), of fronts of 100 preferences."""
    preferences = fan_of_preferences(_PREFERENCES, validation.instances.device)
    shares = []
    for instance in validation.instances.split(1):
        points = tour_lengths(instance, build(instance, preferences))[0].cpu()
        reference_point = torch.full((2,), float(validation.cities), dtype=torch.float64)
        shares.append(hypervolume(points.double().numpy(), reference_point.numpy()))
    return sum(shares) / len(shares)
