"""Shards of expert tours for the tests of imitation."""

from dataclasses import replace
from pathlib import Path

import pytest

from models.expert import ExpertConfig, make_shard

SMALL_SHARDS = ExpertConfig(
    instances=6, preferences=10, least_cities=9, most_cities=9, iterations_per_city=5
)


def shards(path: Path, config: ExpertConfig) -> Path:
    for number in range(2):
        make_shard(config, number).save(path / f"shard-{number:05}.npz")
    return path


@pytest.fixture(scope="session")
def shards_of_cities(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return shards(tmp_path_factory.mktemp("cities"), SMALL_SHARDS)


@pytest.fixture(scope="session")
def shards_of_matrices(tmp_path_factory: pytest.TempPathFactory) -> Path:
    config = replace(SMALL_SHARDS, kind="matrices", instances=12)
    return shards(tmp_path_factory.mktemp("matrices"), config)
