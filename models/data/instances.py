"""Instances as tensors: uniform ones, tour lengths, starts.

An instance of m objectives is given by its cities (n, 2m), columns 0-1 in plane 1, 2-3 in plane 2
and so on, or by its matrices of costs (m, n, n). A batch has the axis b before: (b, n, 2m) or
(b, m, n, n). The last axis but one counts the cities of both.
"""

import torch
from jaxtyping import Float, Int
from torch import Generator, Tensor


def uniform_cities(
    count: int, cities: int, generator: Generator, device: torch.device, objectives: int = 2
) -> Float[Tensor, "b n x"]:
    """Draw cities uniform in the unit square of each plane, one an objective."""
    return torch.rand(count, cities, 2 * objectives, generator=generator).to(device)


def uniform_instances(
    reads: str,
    count: int,
    cities: int,
    generator: Generator,
    device: torch.device,
    objectives: int = 2,
) -> Tensor:
    """Draw uniform cities, as an actor reads them: "coordinates", or "matrices" of distances."""
    drawn = uniform_cities(count, cities, generator, device, objectives)
    return drawn if reads == "coordinates" else distance_matrices(drawn)


def city_count(least: int, most: int, generator: Generator) -> int:
    """Draw a number of cities, uniform from least to most, both included."""
    return int(torch.randint(least, most + 1, (), generator=generator))


def distinct_starts(
    count: int, cities: int, starts: int, generator: Generator, device: torch.device
) -> Int[Tensor, "b s"]:
    """Draw a different city for each start of each instance, in random order.

    Where there are fewer cities than starts, cities repeat.
    """
    keys = torch.rand(count, max(cities, starts), generator=generator)
    return (keys.argsort(dim=1)[:, :starts] % cities).to(device)


def are_matrices(instances: Tensor) -> bool:
    """Return whether the instances are matrices of costs rather than coordinates of cities."""
    return instances.ndim == 4


def distance_matrices(cities: Float[Tensor, "b n x"]) -> Float[Tensor, "b m n n"]:
    """Return the distances in each plane.

    Written without cdist, which would freeze n when a network is exported.
    """
    x, y = cities.transpose(1, 2)[:, 0::2], cities.transpose(1, 2)[:, 1::2]  # (b, m, n)
    squares = (x[..., :, None] - x[..., None, :]) ** 2 + (y[..., :, None] - y[..., None, :]) ** 2
    return squares.sqrt()


def tour_lengths(instances: Tensor, tours: Int[Tensor, "b r n"]) -> Float[Tensor, "b r m"]:
    """Return the lengths of each closed tour."""
    b, r, n = tours.shape
    if are_matrices(instances):
        steps = (tours * n + tours.roll(-1, dims=2)).view(b, 1, r * n)
        steps = steps.expand(-1, instances.shape[1], -1)
        return instances.flatten(2).gather(2, steps).view(b, -1, r, n).sum(dim=3).mT
    places = tours.reshape(b, -1, 1).expand(-1, -1, instances.shape[2])
    visited = instances.gather(1, places).view(b, r, n, -1, 2)
    return (visited - visited.roll(1, dims=2)).norm(dim=-1).sum(dim=2)
