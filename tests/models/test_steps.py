"""Training steps: that actors learn."""

from pathlib import Path

import pytest
import torch

from models import repair_steps
from models.checkpoint import new_run
from models.config import NAMES, NetworkConfig, TrainingConfig
from models.data.dataset import Labels
from models.networks.pa_one import OneActor
from models.steps import imitation_step, policy_gradient_step
from tests.helpers.sampled import at_night
from tests.helpers.small_runs import small_config
from tests.helpers.type_checks import unchecked_types

CPU = torch.device("cpu")
# By baseline: a critic must first learn itself.
STEPS = {"shared": 50, "critic": 150}
RATES = {"shared": 1e-2, "critic": 3e-3}
BRIEF = ("pa-one-matrix",)  # trained by day beside pa-at: what training does is in steps.py


@pytest.mark.parametrize(
    ("objective", "name", "baseline", "starts"),
    [
        pytest.param("weighted-sum", name, "shared", 8, marks=[at_night] * (name not in BRIEF))
        for name in NAMES
    ]
    + [
        ("lagrangian", "pa-at", "shared", 8),
        pytest.param("lagrangian", "pa-ad", "shared", 8, marks=at_night),
        ("weighted-sum", "pa-at", "critic", 1),
    ],
)
def test_training_lowers_the_objective(
    objective: str, name: str, baseline: str, starts: int
) -> None:
    config = small_config(
        network=NetworkConfig(name=name, width=32, heads=2, layers=1, feedforward=32),
        objective=objective,
        baseline=baseline,
        starts=starts,
        steps=STEPS[baseline],
        instances=16,
        least_cities=6,
        most_cities=6,
        learning_rate=RATES[baseline],
        warmup=5,
        multiplier=2.0,
        ascent_rate=0.0,
    )
    run = new_run(config, CPU)

    def step() -> float:
        # The same instances in each step: matrices are of kinds whose tours differ in length.
        run.instance_generator.manual_seed(1)
        return policy_gradient_step(run).objective

    objectives = [step()]
    with unchecked_types():
        objectives += [step() for _ in range(STEPS[baseline] - 1)]
    # PA-One begins near where the others end.
    most = 0.99 if name.startswith("pa-one") else 0.97
    assert sum(objectives[-15:]) < most * sum(objectives[:15])


@pytest.mark.parametrize("name", ["pa-one", pytest.param("pa-one-matrix", marks=at_night)])
def test_learning_from_repairs_makes_repaired_tours_shorter(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(repair_steps, "_REPAIRS", 24)
    config = small_config(
        network=NetworkConfig(name=name, width=16, heads=2, layers=1, feedforward=16),
        objective="repairs",
        steps=8,
        instances=1,
        least_cities=14,  # of 9 cities half of a repair is not the network's
        most_cities=14,
        preferences=12,
        learning_rate=3e-3,
        warmup=1,
    )
    run = new_run(config, CPU)
    assert isinstance(run.actor, OneActor)
    with torch.no_grad():  # it begins near the best: let it prefer long edges
        run.actor.project_edge.weight.fill_(1.0)
        run.actor.judge.weight.fill_(0.5)

    def step() -> float:
        run.instance_generator.manual_seed(1)
        return repair_steps.repair_step(run).objective

    objectives = [step()]
    with unchecked_types():
        objectives.append(step())
    assert run.step == 2
    # How bad the first tours are depends on rounding, so on the number of threads.
    assert objectives[-1] < 0.995 * objectives[0]


def test_multipliers_rise_while_tours_miss_their_preference() -> None:
    run = new_run(small_config(objective="lagrangian", multiplier=1.0, ascent_rate=2.0), CPU)
    policy_gradient_step(run)
    assert (run.multipliers > 1.0).all()


@pytest.mark.parametrize("name", ["pa-one", "pa-at"])
def test_imitation_makes_the_expert_likelier(shards_of_cities: Path, name: str) -> None:
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
    labels = Labels(shards_of_cities)
    run = new_run(config, torch.device("cpu"))
    losses = [imitation_step(run, labels).loss]
    with unchecked_types():
        losses += [imitation_step(run, labels).loss for _ in range(59)]
    assert sum(losses[-10:]) < 0.9 * sum(losses[:10])
