"""Checkpoints: runs that go on as if they had not stopped, and networks that grow."""

from dataclasses import replace
from pathlib import Path

import pytest
import torch

from models.checkpoint import averaged_actor, new_run, resume, save, start_from
from models.config import NetworkConfig
from models.data.instances import uniform_instances
from models.data.preferences import fan_of_preferences
from models.steps import policy_gradient_step
from tests.helpers.small_runs import SMALL_NETWORK, small_config

CPU = torch.device("cpu")


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"objective": "lagrangian", "multiplier": 5.0},
        {
            "baseline": "critic",
            "starts": 1,
            "network": NetworkConfig(name="pa-at", width=16, heads=2, layers=1, feedforward=32),
        },
        {
            "baseline": "critic",
            "starts": 1,
            "network": NetworkConfig(name="pa-ad", width=16, heads=2, layers=1, feedforward=32),
        },
    ],
)
def test_resuming_equals_not_having_stopped(tmp_path: Path, changes: dict[str, object]) -> None:
    config = small_config(**changes)
    straight = new_run(config, CPU)
    for _ in range(6):
        policy_gradient_step(straight)
    stopped = new_run(config, CPU)
    for _ in range(3):
        policy_gradient_step(stopped)
    save(stopped, tmp_path / "run.pt")
    resumed = resume(tmp_path / "run.pt", CPU)
    for _ in range(3):
        policy_gradient_step(resumed)
    assert resumed.step == 6
    for name in ("actor", "averaged", "critic"):
        ours, theirs = getattr(resumed, name).state_dict(), getattr(straight, name).state_dict()
        assert all(torch.equal(ours[key], theirs[key]) for key in theirs), name
    assert torch.equal(resumed.multipliers, straight.multipliers)


@pytest.mark.parametrize("name", ["pa-one", "pa-one-matrix"])
@torch.no_grad()
def test_a_deeper_network_begins_as_the_one_it_grew_from(name: str) -> None:
    network = replace(SMALL_NETWORK, name=name)
    grown = new_run(small_config(network=replace(network, layers=3)), CPU)
    shallow = new_run(small_config(network=network, seed=9), CPU).actor.eval()
    start_from(grown, shallow)
    generator = torch.Generator().manual_seed(1)
    sampled = uniform_instances(shallow.reads, 2, 9, generator, CPU)
    preferences = fan_of_preferences(5, CPU)
    for actor in (grown.actor, averaged_actor(grown)):
        tours = actor.eval().tours(sampled, preferences)
        assert torch.equal(tours, shallow.tours(sampled, preferences))
    layer = grown.actor.encoder_layers[2]
    before = [weights.clone() for weights in layer.parameters()]
    with torch.enable_grad():
        policy_gradient_step(grown)
        policy_gradient_step(grown)
    after = layer.parameters()
    assert all((b != a).any() for b, a in zip(before, after, strict=True))


def test_only_a_network_that_can_stay_what_it_was_grows() -> None:
    network = replace(SMALL_NETWORK, name="pa-at")
    grown = new_run(small_config(network=replace(network, layers=2)), CPU)
    with pytest.raises(ValueError, match="must begin from weights of as many layers"):
        start_from(grown, new_run(small_config(network=network), CPU).actor)
