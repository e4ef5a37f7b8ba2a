"""Instances and preferences, drawn from an explicit generator."""

import math

import torch
from jaxtyping import Float, Int
from torch import Generator, Tensor

from models.data.instances import distance_matrices


def uniform_cities(
    count: int, cities: int, generator: Generator, device: torch.device
) -> Float[Tensor, "b n 4"]:
    """Cities uniform in the unit square of each plane; columns 0-1 are plane 1, 2-3 plane 2."""
    return torch.rand(count, cities, 4, generator=generator).to(device)


def uniform_instances(
    reads: str, count: int, cities: int, generator: Generator, device: torch.device
) -> Tensor:
    """Uniform cities as an actor reads them: coordinates, or matrices of their distances."""
    drawn = uniform_cities(count, cities, generator, device)
    return drawn if reads == "coordinates" else distance_matrices(drawn)


def city_count(least: int, most: int, generator: Generator) -> int:
    """A number of cities, uniform from least to most, both included."""
    return int(torch.randint(least, most + 1, (), generator=generator))


def fan_of_preferences(k: int, device: torch.device) -> Float[Tensor, "k 2"]:
    """Unit vectors at the middles of k equal parts of the open interval (0, 90) degrees."""
    return _directions((torch.arange(k) + 0.5) / k, device)


def spread_preferences(k: int, generator: Generator, device: torch.device) -> Float[Tensor, "k 2"]:
    """One unit vector from each of k equal parts of (0, 90) degrees, uniform within its part."""
    return _directions((torch.arange(k) + torch.rand(k, generator=generator)) / k, device)


def distinct_starts(
    count: int, cities: int, starts: int, generator: Generator, device: torch.device
) -> Int[Tensor, "b s"]:
    """For each instance, as many different cities as there are starts, in random order.

    Where there are fewer cities than starts, cities repeat.
    """
    keys = torch.rand(count, max(cities, starts), generator=generator)
    return (keys.argsort(dim=1)[:, :starts] % cities).to(device)


def _directions(shares: Tensor, device: torch.device) -> Float[Tensor, "k 2"]:
    radians = shares * (math.pi / 2)
    return torch.stack((radians.cos(), radians.sin()), dim=-1).to(device)
