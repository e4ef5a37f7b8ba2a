"""The data set of expert tours: shards in a folder, and random batches of them to imitate."""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Int
from numpy.typing import NDArray
from torch import Generator, Tensor

from models.data.instances import are_matrices


@dataclass(frozen=True, eq=False)
class Shard:
    """Instances of m objectives, preferences (k, m), and their tours (b, k, n).

    Under two objectives, preferences are by ascending angle. The instances are cities (b, n, 2m) or
    matrices (b, m, n, n).
    """

    instances: NDArray[np.float32]
    preferences: NDArray[np.float32]
    tours: NDArray[np.int16]

    @classmethod
    def load(cls, path: Path) -> "Shard":
        """Return the shard at path."""
        with np.load(path) as stored:
            return cls(stored["instances"], stored["preferences"], stored["tours"])

    def save(self, path: Path) -> None:
        """Write the shard whole or not at all."""
        unfinished = path.with_suffix(".part.npz")
        np.savez(
            unfinished,
            instances=self.instances,
            preferences=self.preferences,
            tours=self.tours,
        )
        unfinished.rename(path)


class Batch(NamedTuple):
    """Instances, cities (b, n, 2m) or matrices (b, m, n, n), and tours of each.

    Under two objectives, preferences are by ascending angle. For each there is a tour from several
    starts.
    """

    instances: Tensor
    preferences: Float[Tensor, "k m"]
    tours: Int[Tensor, "b ks n"]


class Labels:
    """The shards in a folder; shards that are added later are found too."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._load = lru_cache(maxsize=64)(Shard.load)

    def batch(self, instances: int, preferences: int, starts: int, generator: Generator) -> Batch:
        """Return a batch from one shard, mirrored, reversed and begun at random.

        Raises:
            FileNotFoundError: the folder has no shards.
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
            batch = _reversed(batch)
        tours = batch.tours.repeat_interleave(starts, dim=1)
        return batch._replace(tours=_begun_anywhere(tours, generator))


def _below(bound: int, generator: Generator) -> int:
    return int(torch.randint(bound, (), generator=generator))


def _one_of_each_stretch(count: int, k: int, generator: Generator) -> Int[Tensor, " k"]:
    """Draw one index from each of k equal stretches of range(count)."""
    shares = (torch.arange(k) + torch.rand(k, generator=generator)) / k
    return (shares * count).long().clamp(max=count - 1)


def _mirrored(cities: Float[Tensor, "b n x"], generator: Generator) -> Float[Tensor, "b n x"]:
    """Apply one of the eight symmetries of the square to each instance and plane."""
    b, m = cities.shape[0], cities.shape[2] // 2
    planes = cities.unflatten(2, (m, 2))
    swap = torch.rand(b, 1, m, 1, generator=generator) < 0.5
    planes = torch.where(swap, planes.flip(-1), planes)
    flip = torch.rand(b, 1, m, 2, generator=generator) < 0.5
    return torch.where(flip, 1 - planes, planes).flatten(2)


def _exchanged(batch: Batch) -> Batch:
    """Exchange the first objective for the last, and so on: of two, the angles ascend again."""
    if are_matrices(batch.instances):
        instances = batch.instances.flip(1)
    else:
        instances = batch.instances.unflatten(2, (-1, 2)).flip(2).flatten(2)
    return Batch(instances, batch.preferences.flip(0, 1), batch.tours.flip(1))


def _reversed(batch: Batch) -> Batch:
    """Reverse every step: its costs, and the tours."""
    instances = batch.instances.mT if are_matrices(batch.instances) else batch.instances
    return batch._replace(instances=instances, tours=batch.tours.flip(-1))


def _begun_anywhere(tours: Int[Tensor, "b r n"], generator: Generator) -> Int[Tensor, "b r n"]:
    """Begin each tour at a city at random."""
    b, r, n = tours.shape
    start = torch.randint(n, (b, r, 1), generator=generator)
    return tours.gather(-1, (start + torch.arange(n)) % n)
