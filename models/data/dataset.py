"""Batches of expert tours to imitate, no two alike."""

from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Generator, Tensor

from models.data.instances import are_matrices
from models.expert import Shard


class Batch(NamedTuple):
    """Instances, cities (b, n, 4) or matrices (b, 2, n, n), and tours of each.

    Preferences are by ascending angle; for each there is a tour from several starts.
    """

    instances: Tensor
    preferences: Float[Tensor, "k 2"]
    tours: Int[Tensor, "b ks n"]


class Labels:
    """The shards in a folder; those that are added to it later are found too."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._load = lru_cache(maxsize=64)(Shard.load)

    def batch(self, instances: int, preferences: int, starts: int, generator: Generator) -> Batch:
        """A batch from one shard, mirrored, turned and begun at random.

        Raises:
            FileNotFoundError: the folder has no shard.
        """
        paths = sorted(self._folder.glob("shard-?????.npz"))
        if not paths:
            raise FileNotFoundError(f"{self._folder} must hold shards, got none")
        shard = self._load(paths[_below(len(paths), generator)])
        some = torch.randperm(len(shard.instances), generator=generator)[:instances].numpy()
        members = _one_of_each_stretch(len(shard.preferences), preferences, generator).numpy()
        batch = Batch(
            torch.from_numpy(shard.instances[some]),
            torch.from_numpy(shard.preferences[members]),
            torch.from_numpy(shard.tours[some][:, members]).long(),
        )
        if not are_matrices(batch.instances):
            batch = batch._replace(instances=_mirrored(batch.instances, generator))
        if _below(2, generator):
            batch = _exchanged(batch)
        if _below(2, generator):
            batch = _turned_back(batch)
        tours = batch.tours.repeat_interleave(starts, dim=1)
        return batch._replace(tours=_begun_anywhere(tours, generator))


def _below(bound: int, generator: Generator) -> int:
    return int(torch.randint(bound, (), generator=generator))


def _one_of_each_stretch(count: int, wanted: int, generator: Generator) -> Int[Tensor, " k"]:
    """Indices, one at random from each of `wanted` equal stretches of range(count)."""
    shares = (torch.arange(wanted) + torch.rand(wanted, generator=generator)) / wanted
    return (shares * count).long().clamp(max=count - 1)


def _mirrored(cities: Float[Tensor, "b n 4"], generator: Generator) -> Float[Tensor, "b n 4"]:
    """One of the eight symmetries of the square for each instance and plane."""
    b, n, _ = cities.shape
    planes = cities.view(b, n, 2, 2)
    swap = torch.rand(b, 1, 2, 1, generator=generator) < 0.5
    planes = torch.where(swap, planes.flip(-1), planes)
    flip = torch.rand(b, 1, 2, 2, generator=generator) < 0.5
    return torch.where(flip, 1 - planes, planes).view(b, n, 4)


def _exchanged(batch: Batch) -> Batch:
    """The same with the planes exchanged: preference a becomes 90 degrees minus a."""
    if are_matrices(batch.instances):
        instances = batch.instances.flip(1)
    else:
        instances = batch.instances.roll(2, dims=-1)
    return Batch(instances, batch.preferences.flip(0, 1), batch.tours.flip(1))


def _turned_back(batch: Batch) -> Batch:
    """The same with every step the other way: what it costs, and the tours."""
    turned = batch.instances.mT if are_matrices(batch.instances) else batch.instances
    return batch._replace(instances=turned, tours=batch.tours.flip(-1))


def _begun_anywhere(tours: Int[Tensor, "b r n"], generator: Generator) -> Int[Tensor, "b r n"]:
    """Each tour from a city at random."""
    b, r, n = tours.shape
    start = torch.randint(n, (b, r, 1), generator=generator)
    return tours.gather(-1, (start + torch.arange(n)) % n)
