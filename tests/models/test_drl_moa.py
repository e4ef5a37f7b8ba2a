"""DRL-MOA: the transfer of weights, and what a user of its command sees."""

import csv
from pathlib import Path

import pytest
import torch

from models import drl_moa
from models.drl_moa import TransferConfig, finish, load_actors, new_run, resume, save, take_step

SMALL = TransferConfig(
    subproblems=3, first_steps=4, steps=2, instances=8, cities=6, width=16, save_every=1
)


def test_a_network_begins_with_the_weights_of_the_one_before() -> None:
    run = new_run(SMALL)
    assert run.weights.tolist() == [1.0, 0.0]
    for _ in range(4):
        take_step(run)
    finish(run)
    assert run.weights.tolist() == [0.5, 0.5]
    assert run.steps == 2
    before = run.finished[0]
    assert all(torch.equal(x, before[name]) for name, x in run.actor.state_dict().items())
    take_step(run)
    assert not torch.equal(run.actor.judges, before["judges"])


def test_training_lowers_the_weighted_sum() -> None:
    config = TransferConfig(instances=32, cities=8, width=32, learning_rate=3e-3)
    run = new_run(config)
    objectives = [take_step(run) for _ in range(120)]
    assert sum(objectives[-20:]) < 0.93 * sum(objectives[:20])


def test_resuming_equals_not_having_stopped(tmp_path: Path) -> None:
    """Stopped within the second network, by the same command as it was begun with."""
    straight, stopped = new_run(SMALL), new_run(SMALL)
    drl_moa.train(straight, tmp_path / "straight")
    for _ in range(4):
        take_step(stopped)
    finish(stopped)
    take_step(stopped)
    (tmp_path / "stopped").mkdir()
    save(stopped, tmp_path / "stopped/run.pt")
    drl_moa.main(["--out", str(tmp_path / "stopped")])
    runs = (load_actors(tmp_path / name / "weights.pt") for name in ("straight", "stopped"))
    for theirs, ours in zip(*runs, strict=True):
        found = ours.state_dict()
        assert all(torch.equal(x, found[name]) for name, x in theirs.state_dict().items())
    assert len(resume(tmp_path / "stopped/run.pt").finished) == 3


def test_a_run_leaves_a_line_for_each_network(tmp_path: Path) -> None:
    drl_moa.train(new_run(SMALL), tmp_path)
    with (tmp_path / "log.csv").open() as file:
        lines = list(csv.DictReader(file))
    assert [(line["weight_1"], line["steps"]) for line in lines] == [
        ("1.0000", "4"),
        ("0.5000", "2"),
        ("0.0000", "2"),
    ]


@pytest.mark.parametrize("changes", [{"subproblems": 1}, {"steps": 0}, {"cities": 0}])
def test_a_configuration_that_makes_no_sense_is_refused(changes: dict[str, int]) -> None:
    with pytest.raises(ValueError, match="must be at least"):
        TransferConfig(**changes)


def test_options_that_differ_from_those_of_the_run_are_refused_by_name(tmp_path: Path) -> None:
    save(new_run(SMALL), tmp_path / "run.pt")
    with pytest.raises(
        ValueError, match=r"must be resumed as it is, got --width 640, which has 16$"
    ):
        drl_moa.main(["--out", str(tmp_path), "--width", "640", "--cities", "6"])
    assert not (tmp_path / "weights.pt").exists()
