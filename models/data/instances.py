"""Instances as tensors, of either kind: cities (b, n, 4), or matrices of costs (b, 2, n, n).

The last axis but one has the cities of both.
"""

import torch
from jaxtyping import Float, Int
from torch import Tensor


def are_matrices(instances: Tensor) -> bool:
    """Whether the instances are given by what each step costs, not by where the cities are."""
    return instances.ndim == 4


def distance_matrices(cities: Float[Tensor, "b n 4"]) -> Float[Tensor, "b 2 n n"]:
    """Distances in each plane.

    Written without cdist, which would freeze n when a network is exported.
    """
    x, y = cities.transpose(1, 2)[:, 0::2], cities.transpose(1, 2)[:, 1::2]  # (b, 2, n)
    squares = (x[..., :, None] - x[..., None, :]) ** 2 + (y[..., :, None] - y[..., None, :]) ** 2
    return squares.sqrt()


def closed(matrices: Float[Tensor, "*b n n"]) -> Float[Tensor, "*b n n"]:
    """The least costs of getting from city to city over any others (Floyd, 1962)."""
    for k in range(matrices.shape[-1]):
        by_way_of_k = matrices[..., :, k, None] + matrices[..., None, k, :]
        matrices = torch.minimum(matrices, by_way_of_k)
    return matrices


def tour_lengths(instances: Tensor, tours: Int[Tensor, "b r n"]) -> Float[Tensor, "b r 2"]:
    """Both lengths of each closed tour."""
    b, r, n = tours.shape
    if are_matrices(instances):
        steps = (tours * n + tours.roll(-1, dims=2)).view(b, 1, r * n).expand(-1, 2, -1)
        return instances.flatten(2).gather(2, steps).view(b, 2, r, n).sum(dim=3).mT
    visited = instances.gather(1, tours.reshape(b, -1, 1).expand(-1, -1, 4)).view(b, r, n, 2, 2)
    return (visited - visited.roll(1, dims=2)).norm(dim=-1).sum(dim=2)
