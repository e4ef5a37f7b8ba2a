"""Validation of an actor: the hypervolume of its greedy fronts on fixed instances."""

from collections.abc import Callable
from dataclasses import dataclass

import torch
from torch import Generator, Tensor

from models.data.instances import tour_lengths, uniform_instances
from models.data.preferences import fan_of_preferences
from service.pareto import hypervolume

_SEED = 20_220_303  # apart from the seeds of training and from the instances of the paper
_PREFERENCES = 100
COUNTS = {40: 16, 200: 3}  # instances by number of cities, in training and for releases

# From instances and preferences (k, 2) to tours (b, k, n).
Build = Callable[[Tensor, Tensor], Tensor]


@dataclass(frozen=True)
class ValidationSet:
    """Fixed instances of one size."""

    cities: int
    instances: Tensor


def validation_sets(
    reads: str, counts: dict[int, int], device: torch.device
) -> list[ValidationSet]:
    """Return the requested counts of uniform instances by number of cities; always the same."""
    return [
        ValidationSet(
            n, uniform_instances(reads, count, n, Generator().manual_seed(_SEED + n), device)
        )
        for n, count in counts.items()
    ]


def mean_hypervolume(build: Build, validation: ValidationSet) -> float:
    """Return the mean over the instances, reference point (n, n), of fronts of 100 preferences."""
    preferences = fan_of_preferences(_PREFERENCES, validation.instances.device)
    shares = []
    for instance in validation.instances.split(1):
        points = tour_lengths(instance, build(instance, preferences))[0].cpu()
        reference_point = torch.full((2,), float(validation.cities), dtype=torch.float64)
        shares.append(hypervolume(points.double().numpy(), reference_point.numpy()))
    return sum(shares) / len(shares)
