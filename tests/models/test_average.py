"""The mean of the weights of several runs."""

from pathlib import Path

import pytest
import torch

from models import average
from models.checkpoint import Trained, load_weights, write
from models.config import NetworkConfig, TrainingConfig
from models.networks.build import build


def trained(seed: int, width: int = 16) -> Trained:
    network = NetworkConfig(width=width, heads=2, layers=1, feedforward=32)
    config = TrainingConfig(network=network, seed=seed)
    return Trained(config, build(network, seed), step=100 * seed, seconds=10.0 * seed)


def test_the_command_writes_the_mean_of_the_checkpoints(tmp_path: Path) -> None:
    paths = [tmp_path / f"{seed}.pt" for seed in (1, 2, 3)]
    for seed, path in enumerate(paths, start=1):
        write(trained(seed), path)
    average.main(["--out", str(tmp_path / "mean.pt"), *map(str, paths)])
    mean = load_weights(tmp_path / "mean.pt")
    assert (mean.config, mean.step, mean.seconds) == (trained(3).config, 300, 60.0)
    states = [load_weights(path).actor.state_dict() for path in paths]
    for name, weights in mean.actor.state_dict().items():
        torch.testing.assert_close(weights, sum(state[name] for state in states) / 3)


def test_networks_of_two_shapes_have_no_mean() -> None:
    with pytest.raises(ValueError, match="checkpoints must be of one network, got 2"):
        average.average([trained(1), trained(2, width=32)])
