"""Batches of expert tours to imitate."""

from pathlib import Path

import pytest
import torch
from torch import Generator

from models.data.dataset import Labels, Shard
from models.data.instances import tour_lengths


@pytest.mark.parametrize("kind", ["shards_of_cities", "shards_of_matrices"])
def test_turning_mirroring_and_exchanging_planes_changes_no_length(
    kind: str, request: pytest.FixtureRequest
) -> None:
    folder = request.getfixturevalue(kind)
    shards = [Shard.load(path) for path in sorted(folder.iterdir())]
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


def test_a_tour_short_in_the_first_length_belongs_to_a_steep_preference(
    shards_of_cities: Path,
) -> None:
    """In every batch, also with the planes exchanged."""
    for seed in range(10):
        batch = Labels(shards_of_cities).batch(6, 10, 1, Generator().manual_seed(seed))
        points = tour_lengths(batch.instances, batch.tours).mean(dim=0)
        assert points[-1, 0] < points[0, 0]
        assert points[-1, 1] > points[0, 1]


def test_a_folder_without_shards_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="must hold shards, got none"):
        Labels(tmp_path).batch(1, 5, 1, Generator())
