"""Near-optimal tours to learn from: `python -m models.expert --out runs/expert --shards 100`.

A shard holds instances of one size and, for each of its preferences, the best tour that the local
search of the service found. Its content follows from the seed and its number: shards that
exist are left as they are, and several processes may make shards of one folder.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.random import Generator
from numpy.typing import NDArray
from tqdm import tqdm

from models.data.dataset import Shard
from models.data.generators import PLANES
from models.data.instances import distance_matrices
from models.data.matrices import any_matrices
from models.data.preferences import FLAT, directions_of, weights
from models.networks.pa_one import OneActor
from models.options import add_options, from_options, setting
from service import preferences as of_service
from service.instance import Instance
from service.search.improve import improve

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class ExpertConfig:
    """The content of the shards: kind, sizes, and how long the search works."""

    kind: str = setting("coordinates", "coordinates, or matrices of several kinds")
    instances: int = setting(200, "instances of a shard")
    preferences: int = setting(40, "preferences of a shard, a tour of each instance for each")
    least_cities: int = setting(20, "least cities of an instance; all of a shard have as many")
    most_cities: int = setting(100, "most cities of an instance")
    shaped: float = setting(
        0.5, "share of coordinates' planes that are clusters, boxes or streets; others are uniform"
    )
    iterations_per_city: int = setting(50, "iterations of the search for each city")
    objectives: int = setting(2, "objectives of an instance; more than two of coordinates only")
    seed: int = setting(1, "of the instances and the search")

    def __post_init__(self) -> None:
        if self.kind not in ("coordinates", "matrices"):
            raise ValueError(f"kind must be coordinates or matrices, got {self.kind}")
        if not 0 <= self.shaped <= 1:
            raise ValueError(f"shaped must be from 0 to 1, got {self.shaped}")
        most = OneActor.most_objectives if self.kind == "coordinates" else FLAT
        if not FLAT <= self.objectives <= most:
            raise ValueError(
                f"objectives of {self.kind} must be from 2 to {most}, got {self.objectives}"
            )


def make_shard(config: ExpertConfig, number: int) -> Shard:
    """Return the shard with that number."""
    generator = np.random.default_rng([config.seed, number])
    n = int(generator.integers(config.least_cities, config.most_cities + 1))
    preferences = _preferences(config, generator)
    instances = np.stack([_instance(n, config, generator) for _ in range(config.instances)])
    iterations = config.iterations_per_city * n
    tours = [expert_tours(costs, preferences, iterations, number) for costs in instances]
    return Shard(
        instances.astype(np.float32),
        preferences.astype(np.float32),
        np.stack(tours).astype(np.int16),
    )


def expert_tours(
    costs: Array, preferences: Array, iterations: int, seed: int
) -> NDArray[np.integer]:
    """Return, for each preference (k, m), the best tour that the search finds.

    The best is that with the least weighted sum of scaled lengths. Under two objectives it is of
    the front that one search finds; under more, each preference has a search of its own.
    The costs are given by cities (n, 2m) or, of two objectives, matrices (2, n, n).
    """
    if preferences.shape[1] > FLAT:
        scaled = _scaled_distances(costs)
        rows = weights(torch.from_numpy(preferences)).numpy()
        return np.stack([_tour(np.tensordot(row, scaled, 1), iterations, seed) for row in rows])
    instance = Instance(coordinates=costs) if costs.ndim == 2 else Instance(matrices=costs)
    no_tours = np.empty((0, instance.n), dtype=np.int64)
    front = improve(instance, no_tours, iterations=iterations, seed=seed)
    rows = of_service.weights(preferences)
    sums = (front.points / instance.scale) @ rows.T  # (p, k)
    return front.tours[sums.argmin(axis=0)]


def _scaled_distances(cities: Array) -> Array:
    """Return the distances in each plane, (m, n, n), in units of the longer side of its box."""
    sides = np.ptp(cities.reshape(len(cities), -1, 2), axis=0).max(axis=1)
    return distance_matrices(torch.from_numpy(cities)[None])[0].numpy() / sides[:, None, None]


def _tour(costs: Array, iterations: int, seed: int) -> NDArray[np.integer]:
    """Return the tour that the search finds under one matrix of costs, given it as both."""
    instance = Instance(matrices=np.stack((costs, costs)))
    no_tours = np.empty((0, instance.n), dtype=np.int64)
    return improve(instance, no_tours, iterations=iterations, seed=seed).tours[0]


def _preferences(config: ExpertConfig, generator: Generator) -> Array:
    """Draw one preference of each of equal parts of the angles; or of any weights, where more."""
    if config.objectives > FLAT:
        drawn = generator.dirichlet(np.ones(config.objectives), config.preferences)
        return directions_of(torch.from_numpy(drawn)).numpy()
    shares = (np.arange(config.preferences) + generator.random(config.preferences)) * 90
    return of_service.from_angles(shares / config.preferences)


def _instance(n: int, config: ExpertConfig, generator: Generator) -> Array:
    if config.kind == "coordinates":
        return _cities(n, config, generator)
    return any_matrices(n, generator)


def _cities(n: int, config: ExpertConfig, generator: Generator) -> Array:
    """Draw cities in the unit squares of all planes, each plane of a kind of its own."""
    names, shaped = list(PLANES), config.shaped
    shares = [1 - shaped] + [shaped / (len(names) - 1)] * (len(names) - 1)
    kinds = generator.choice(names, p=shares, size=config.objectives)
    return np.concatenate([PLANES[kind](n, generator) for kind in kinds], axis=1)


def main(arguments: list[str] | None = None) -> None:
    """Run the command."""
    parser = argparse.ArgumentParser("python -m models.expert", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder of the shards")
    parser.add_argument("--shards", type=int, default=100, help="the number of shards")
    add_options(parser, ExpertConfig)
    options = parser.parse_args(arguments)
    config = from_options(ExpertConfig, options)
    options.out.mkdir(parents=True, exist_ok=True)
    for number in tqdm(range(options.shards), unit="shard"):
        path = options.out / f"shard-{number:05}.npz"
        if not path.exists():
            make_shard(config, number).save(path)


if __name__ == "__main__":
    main()
