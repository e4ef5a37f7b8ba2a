"""A benchmark that is run again measures only the rows that are missing."""

from pathlib import Path

import numpy as np
import pytest
import torch

from models.checkpoint import new_run, save_weights
from models.config import NetworkConfig, TrainingConfig
from models.drl_moa import TransferConfig
from models.drl_moa import new_run as new_transfer
from models.drl_moa import train as train_transfer
from service.instance import Instance
from tests.benchmarks import layers, provenance, training
from tests.benchmarks.rows import resume

INSTANCES = [Instance(coordinates=np.random.default_rng(i).random((5, 4))) for i in range(4)]
CPU = torch.device("cpu")


@pytest.fixture(autouse=True)
def results(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder of results."""
    monkeypatch.setattr(provenance, "RESULTS", tmp_path / "results")
    monkeypatch.setattr(provenance, "changed_files", list)
    monkeypatch.setattr(provenance, "UNSTORED", {})
    return tmp_path / "results"


class Counted:
    """Measures an instance by how often it was asked, and breaks off at the given time."""

    def __init__(self, breaks_at: int = -1) -> None:
        self.asked, self.breaks_at = 0, breaks_at

    def __call__(self, instance: Instance) -> int:
        self.asked += 1
        if self.asked == self.breaks_at:
            raise KeyboardInterrupt
        return instance.n + self.asked


def test_a_benchmark_that_was_broken_off_measures_what_is_left() -> None:
    with pytest.raises(KeyboardInterrupt):
        resume("row", "5 cities", "", INSTANCES, Counted(breaks_at=3))
    again = Counted()
    resume("row", "5 cities", "", INSTANCES, again)
    assert again.asked == 2
    assert provenance.load("row")["5 cities"]["instances"] == [6, 7, 6, 7]


def test_results_of_another_network_are_measured_anew() -> None:
    for digest, asked in (("one", 4), ("one", 0), ("other", 4)):
        counted = Counted()
        resume("row", "5 cities", digest, INSTANCES, counted)
        assert counted.asked == asked
    assert provenance.load("row")["5 cities"]["digest"] == "other"


def test_stored_results_are_measured_again_where_that_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    resume("row", "5 cities", "", INSTANCES, Counted())
    monkeypatch.setattr(provenance, "RUN", provenance.Run(again=True))
    again = Counted()
    resume("row", "5 cities", "", INSTANCES, again)
    assert again.asked == 4
    assert not provenance.UNSTORED


def small(name: str, preference_layers: int) -> TrainingConfig:
    network = NetworkConfig(
        name=name,
        width=16,
        heads=2,
        layers=1,
        feedforward=16,
        preference_layers=preference_layers,
    )
    return TrainingConfig(network=network)


@pytest.mark.parametrize(("preference_layers", "row"), [(1, "PA-EAN"), (0, "PA-EAN-")])
def test_a_checkpoint_without_preference_layer_has_a_minus_in_its_row(
    preference_layers: int, row: str, tmp_path: Path
) -> None:
    save_weights(new_run(small("pa-ean", preference_layers), CPU), tmp_path / "weights.pt")
    layers.main([str(tmp_path / "weights.pt"), "--cities", "40", "--count", "2"])
    [(key, entry)] = provenance.load("layers").items()
    assert key == f"40 {row}"
    assert all(0 < each["hypervolume"]["(50, 50)"] < 100 for each in entry["instances"])


def test_the_training_table_tells_what_checkpoints_say(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(training, "CHECKPOINTS", tmp_path)
    save_weights(new_run(small("pa-at", 1), CPU), tmp_path / "pa-at.pt")
    config = TransferConfig(
        subproblems=3, first_steps=2, steps=1, instances=2, cities=5, width=8, save_every=9
    )
    train_transfer(new_transfer(config), tmp_path / "run")
    (tmp_path / "run/weights.pt").rename(tmp_path / "drl-moa.pt")
    training.main([])
    rows = provenance.load("training")["rows"]
    assert rows["pa-at"]["cities"] == "40"
    assert (rows["drl-moa"]["preferences"], rows["drl-moa"]["steps"]) == (3, 4)
