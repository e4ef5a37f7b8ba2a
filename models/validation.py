"""Validation of an actor: the hypervolume of its greedy fronts on fixed instances."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Generator, Tensor

from models.data.instances import tour_lengths, uniform_instances
from models.data.preferences import FLAT, fan_or_lattice
from service import pareto

Array = NDArray[np.float64]

_SEED = 20_220_303  # apart from the seeds of training and from the instances of the paper
_PREFERENCES = 100
COUNTS = {40: 16, 200: 3}  # instances by number of cities, in training and for releases

# From instances and preferences (k, 2) to tours (b, k, n).
Build = Callable[[Tensor, Tensor], Tensor]


@dataclass(frozen=True)
class ValidationSet:
    """Fixed instances of one size, and of one number of objectives."""

    cities: int
    instances: Tensor
    objectives: int = 2


def validation_sets(
    reads: str, counts: dict[int, int], device: torch.device, objectives: int = 2
) -> list[ValidationSet]:
    """Return the requested counts of uniform instances by number of cities; always the same."""
    return [
        ValidationSet(
            n,
            uniform_instances(
                reads, count, n, Generator().manual_seed(_SEED + n), device, objectives
            ),
            objectives,
        )
        for n, count in counts.items()
    ]


def mean_hypervolume(build: Build, validation: ValidationSet) -> float:
    """Return the mean over the instances, reference point (n, n, ...), of 100 preferences or so."""
    device, m = validation.instances.device, validation.objectives
    preferences = fan_or_lattice(_PREFERENCES, m, device)
    shares = []
    for instance in validation.instances.split(1):
        points = tour_lengths(instance, build(instance, preferences))[0].cpu()
        reference_point = np.full(m, float(validation.cities))
        shares.append(hypervolume(points.double().numpy(), reference_point))
    return sum(shares) / len(shares)


def hypervolume(points: Array, reference_point: Array) -> float:
    """Return the share of the box below the reference point, shape (m,), that points dominate.

    Under more than two objectives it is the sum of slices between the lengths of the last one.
    """
    if points.shape[1] == FLAT:
        return pareto.hypervolume(points, reference_point)
    inside = points[(points < reference_point).all(axis=1)]
    inside = inside[inside[:, -1].argsort()]
    levels = np.append(inside[:, -1], reference_point[-1]) / reference_point[-1]
    slices = (
        (levels[i + 1] - levels[i]) * hypervolume(inside[: i + 1, :-1], reference_point[:-1])
        for i in range(len(inside))
        if levels[i + 1] > levels[i]
    )
    return float(sum(slices))
