"""Expert tours, and the command that stores them."""

from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
import torch

from models import expert
from models.data.dataset import Shard
from models.data.instances import tour_lengths
from models.data.preferences import directions_of
from models.expert import ExpertConfig, expert_tours
from service import instance
from service.instance import Instance
from service.preferences import fan, from_angles, weights

SMALL = ExpertConfig(
    instances=3, preferences=10, least_cities=9, most_cities=9, iterations_per_city=5
)


def test_the_expert_finds_the_best_tour_for_each_preference() -> None:
    """Against all tours of eight cities, one length in units fifty times as small."""
    cities = np.random.default_rng(4).random((8, 4)) * (50, 50, 1, 1)
    preferences = from_angles(fan(7))
    every = np.array([(0, *rest) for rest in permutations(range(1, 8))])
    this = Instance(coordinates=cities)
    every_point = instance.tour_lengths(this, every) / this.scale
    best = (every_point @ weights(preferences).T).min(axis=0)
    found = expert_tours(cities, preferences, iterations=2000, seed=0)
    lengths = instance.tour_lengths(this, found) / this.scale
    assert (lengths * weights(preferences)).sum(axis=1) == pytest.approx(best)


def test_the_expert_finds_the_best_tour_for_each_preference_of_three_objectives() -> None:
    cities = np.random.default_rng(4).random((8, 6)) * (50, 50, 1, 1, 1, 1)
    every = torch.tensor([(0, *rest) for rest in permutations(range(1, 8))])[None]
    sides = np.ptp(cities.reshape(8, 3, 2), axis=0).max(axis=1)
    rows = np.random.default_rng(5).dirichlet(np.ones(3), 6)
    preferences = directions_of(torch.from_numpy(rows)).numpy()
    this = torch.from_numpy(cities)[None]
    best = (tour_lengths(this, every)[0].numpy() / sides @ rows.T).min(axis=0)
    found = torch.from_numpy(expert_tours(cities, preferences, iterations=400, seed=0))[None]
    lengths = tour_lengths(this, found)[0].numpy() / sides
    assert (lengths * rows).sum(axis=1) == pytest.approx(best, rel=1e-2)


def test_a_shard_follows_from_seed_and_number() -> None:
    first, again = (expert.make_shard(SMALL, 3) for _ in range(2))
    assert np.array_equal(first.instances, again.instances)
    assert np.array_equal(first.tours, again.tours)
    assert not np.array_equal(first.instances, expert.make_shard(SMALL, 4).instances)


def test_the_command_makes_only_the_shards_that_are_missing(
    shards_of_cities: Path, tmp_path: Path
) -> None:
    kept = tmp_path / "shard-00000.npz"
    kept.write_bytes((shards_of_cities / "shard-00000.npz").read_bytes())
    before = kept.stat().st_mtime_ns
    options = ["--instances", "2", "--preferences", "5", "--most-cities", "21"]
    expert.main(["--out", str(tmp_path), "--shards", "2", *options])
    assert kept.stat().st_mtime_ns == before
    assert (tmp_path / "shard-00001.npz").exists()


def test_shards_of_matrices_hold_those_that_differ_by_direction(shards_of_matrices: Path) -> None:
    shards = [Shard.load(path).instances for path in shards_of_matrices.iterdir()]
    symmetric = np.concatenate([(each == each.swapaxes(2, 3)).all((1, 2, 3)) for each in shards])
    assert 0 < symmetric.sum() < len(symmetric)


def test_a_share_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match="shaped must be from 0 to 1"):
        ExpertConfig(shaped=2.0)
