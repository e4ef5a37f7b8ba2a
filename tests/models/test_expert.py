"""Expert tours, and the batches that are drawn from them."""

from dataclasses import replace
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import Generator

from models import expert, train
from models.checkpoint import new_run
from models.config import NetworkConfig, TrainingConfig
from models.data.dataset import Labels
from models.data.generators import PLANES
from models.data.instances import tour_lengths
from models.expert import ExpertConfig, expert_tours
from service import instance
from service.instance import Instance
from service.preferences import fan, from_angles, weights

SMALL = ExpertConfig(
    instances=6, preferences=10, least_cities=9, most_cities=9, iterations_per_city=5
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path: Path = tmp_path_factory.mktemp("shards")
    for number in range(2):
        expert.make_shard(SMALL, number).save(path / f"shard-{number:05}.npz")
    return path


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


def test_a_shard_follows_from_seed_and_number() -> None:
    first, again = (expert.make_shard(SMALL, 3) for _ in range(2))
    assert np.array_equal(first.instances, again.instances)
    assert np.array_equal(first.tours, again.tours)
    assert not np.array_equal(first.instances, expert.make_shard(SMALL, 4).instances)


def test_the_command_makes_only_the_shards_that_are_missing(folder: Path, tmp_path: Path) -> None:
    kept = tmp_path / "shard-00000.npz"
    kept.write_bytes((folder / "shard-00000.npz").read_bytes())
    before = kept.stat().st_mtime_ns
    options = ["--instances", "2", "--preferences", "5", "--most-cities", "21"]
    expert.main(["--out", str(tmp_path), "--shards", "2", *options])
    assert kept.stat().st_mtime_ns == before
    assert (tmp_path / "shard-00001.npz").exists()


@pytest.fixture(scope="module")
def matrices(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("matrices")
    config = replace(SMALL, kind="matrices", instances=12)
    for number in range(2):
        expert.make_shard(config, number).save(path / f"shard-{number:05}.npz")
    return path


@pytest.mark.parametrize("kind", ["folder", "matrices"])
def test_turning_mirroring_and_exchanging_planes_changes_no_length(
    kind: str, request: pytest.FixtureRequest
) -> None:
    folder = request.getfixturevalue(kind)
    shards = [expert.Shard.load(path) for path in sorted(folder.iterdir())]
    known = torch.cat(
        [
            tour_lengths(
                torch.from_numpy(shard.instances), torch.from_numpy(shard.tours).long()
            ).flatten(0, 1)
            for shard in shards
        ]
    )
    known = torch.cat((known, known.flip(1)))
    for seed in range(20):
        batch = Labels(folder).batch(4, 5, 3, Generator().manual_seed(seed))
        assert batch.tours.shape == (4, 15, 9)
        assert (batch.tours.sort(dim=-1).values == torch.arange(9)).all()
        angles = torch.atan2(batch.preferences[:, 1], batch.preferences[:, 0])
        assert (angles.diff() > 0).all()
        for point in tour_lengths(batch.instances, batch.tours).flatten(0, 1):
            assert torch.isclose(known, point, rtol=1e-5).all(dim=1).any()


def test_shards_of_matrices_hold_those_that_differ_by_direction(matrices: Path) -> None:
    shards = [expert.Shard.load(path).instances for path in matrices.iterdir()]
    symmetric = np.concatenate([(each == each.swapaxes(2, 3)).all((1, 2, 3)) for each in shards])
    assert 0 < symmetric.sum() < len(symmetric)


def test_a_tour_short_in_the_first_length_belongs_to_a_steep_preference(folder: Path) -> None:
    """In every batch, also with the planes exchanged."""
    for seed in range(10):
        batch = Labels(folder).batch(6, 10, 1, Generator().manual_seed(seed))
        points = tour_lengths(batch.instances, batch.tours).mean(dim=0)
        assert points[-1, 0] < points[0, 0]
        assert points[-1, 1] > points[0, 1]


@pytest.mark.parametrize("name", ["pa-one", "pa-at"])
def test_imitation_makes_the_expert_likelier(folder: Path, name: str) -> None:
    config = TrainingConfig(
        network=NetworkConfig(name=name, width=32, heads=2, layers=1, feedforward=32),
        objective="imitation",
        steps=60,
        instances=6,
        preferences=5,
        starts=2,
        learning_rate=3e-3,
        warmup=5,
    )
    run = new_run(config, torch.device("cpu"))
    losses = [train.imitate(run, Labels(folder)).loss for _ in range(60)]
    assert sum(losses[-10:]) < 0.9 * sum(losses[:10])


def test_imitation_without_labels_is_refused(tmp_path: Path) -> None:
    run = new_run(TrainingConfig(objective="imitation"), torch.device("cpu"))
    with pytest.raises(ValueError, match="labels must be given for imitation"):
        train.train(run, 1, [], tmp_path)
    with pytest.raises(FileNotFoundError, match="must hold shards, got none"):
        Labels(tmp_path).batch(1, 5, 1, Generator())


@pytest.mark.parametrize("kind", PLANES)
def test_every_kind_of_plane_fills_the_unit_square_in_its_own_way(kind: str) -> None:
    cities = PLANES[kind](300, np.random.default_rng(2))
    assert cities.shape == (300, 2)
    assert cities.min() >= 0
    assert cities.max() <= 1
    extent = np.sort(np.ptp(cities, axis=0))
    on_streets = [len(np.unique(cities[:, axis])) < 299 for axis in (0, 1)]
    spacing = np.sqrt(((cities[:, None] - cities) ** 2).sum(-1) + 9 * np.eye(300)).min(axis=1)
    match kind:
        case "uniform":
            assert extent[0] > 0.9
        case "clustered":
            assert spacing.mean() < 0.02
        case "stretched":
            assert extent[0] < 0.9
        case "streets":
            assert all(on_streets)


def test_a_share_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match="shaped must be from 0 to 1"):
        ExpertConfig(shaped=2.0)
