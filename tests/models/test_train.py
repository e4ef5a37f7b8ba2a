"""Training runs: what a user of `python -m models.train` sees."""

import csv
import json
from pathlib import Path

import pytest
import torch

from models import train
from models.checkpoint import load_weights, new_run, save
from models.config import TrainingConfig, from_plain
from models.expert import ExpertConfig, make_shard
from models.steps import policy_gradient_step
from models.validation import validation_sets
from tests.helpers.small_runs import small_config

CPU = torch.device("cpu")
COUNTS = {6: 2}  # of validation instances, by number of cities


def test_a_run_leaves_its_configuration_log_curve_and_weights(tmp_path: Path) -> None:
    config = small_config()
    train.train(new_run(config, CPU), 6, validation_sets("coordinates", COUNTS, CPU), tmp_path)
    assert from_plain(json.loads((tmp_path / "config.json").read_text())) == config
    with (tmp_path / "log.csv").open() as file:
        lines = list(csv.DictReader(file))
    assert [line["step"] for line in lines] == ["3", "6"]
    assert 0 < float(lines[1]["hypervolume_6"]) < 1
    assert (tmp_path / "curve.png").read_bytes().startswith(b"\x89PNG")
    trained = load_weights(tmp_path / "weights.pt")
    assert (trained.config, trained.step) == (config, 6)


def test_the_command_goes_on_with_the_run_that_lies_there(tmp_path: Path) -> None:
    run = new_run(small_config(), CPU)
    policy_gradient_step(run)
    save(run, tmp_path / "run.pt")
    train.main(["--out", str(tmp_path)], counts=COUNTS)
    assert load_weights(tmp_path / "weights.pt").step == 6


def test_options_that_differ_from_those_of_the_run_are_refused_by_name(tmp_path: Path) -> None:
    save(new_run(small_config(), CPU), tmp_path / "run.pt")
    same = ["--out", str(tmp_path), "--steps", "6"]
    differing = ["--width", "640", "--learning-rate", "0.25", "--initial", "other.pt"]
    with pytest.raises(ValueError, match="must be resumed as it is") as refused:
        train.main([*same, *differing], counts=COUNTS)
    message = str(refused.value)
    assert all(
        f"{name} {value}" in message for name, value in zip(*[iter(differing)] * 2, strict=True)
    )
    assert "--steps" not in message
    assert not (tmp_path / "weights.pt").exists()
    train.main(same, counts=COUNTS)
    assert load_weights(tmp_path / "weights.pt").step == 6


def test_pa_one_learns_three_objectives_from_tours_and_then_from_repairs(tmp_path: Path) -> None:
    labels, imitated, repaired = (tmp_path / name for name in ("labels", "imitated", "repaired"))
    labels.mkdir()
    config = ExpertConfig(objectives=3, instances=3, preferences=6, least_cities=12, most_cities=12)
    make_shard(config, 0).save(labels / "shard-00000.npz")
    command = ["--objectives", "3", "--steps", "1", "--instances", "2", "--preferences", "5"]
    command += ["--width", "8", "--heads", "2", "--layers", "1", "--feedforward", "8"]
    imitation = ["--objective", "imitation", "--labels", str(labels), "--baseline", "critic"]
    train.main(["--out", str(imitated), *imitation, "--starts", "1", *command], COUNTS)
    repairs = ["--objective", "repairs", "--initial", str(imitated / "weights.pt")]
    sizes = ["--least-cities", "9", "--most-cities", "9", "--starts", "2"]
    train.main(["--out", str(repaired), *repairs, *sizes, *command], COUNTS)
    before, after = (load_weights(path / "weights.pt") for path in (imitated, repaired))
    assert after.config.objectives == 3
    pairs = zip(before.actor.parameters(), after.actor.parameters(), strict=True)
    assert any(not torch.equal(*pair) for pair in pairs)
    assert all(each.isfinite().all() for each in after.actor.parameters())
    with (repaired / "log.csv").open() as file:
        assert 0 < float(next(csv.DictReader(file))["hypervolume_6"]) < 1


def test_products_of_less_precision_train_as_well(tmp_path: Path) -> None:
    command = ["--out", str(tmp_path), "--precision", "bfloat16", "--steps", "2"]
    command += ["--name", "pa-at"]
    small = ["--width", "16", "--heads", "2", "--layers", "1", "--feedforward", "32"]
    train.main(
        [*command, *small, "--instances", "2", "--starts", "2", "--preferences", "5"], COUNTS
    )
    weights = load_weights(tmp_path / "weights.pt").actor.parameters()
    assert all(each.isfinite().all() and each.dtype == torch.float32 for each in weights)


def test_pa_one_trains_in_single_precision_alone(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="pa-one trains in float32, got precision bfloat16"):
        train.main(["--out", str(tmp_path), "--precision", "bfloat16"])


def test_imitation_without_labels_is_refused(tmp_path: Path) -> None:
    run = new_run(TrainingConfig(objective="imitation"), torch.device("cpu"))
    with pytest.raises(ValueError, match="labels must be given for imitation"):
        train.train(run, 1, [], tmp_path)
