"""That tours point where they are asked to."""

from pathlib import Path

import pytest
import torch
from torch import Generator, Tensor

from models.checkpoint import load_weights
from models.data.instances import tour_lengths
from models.data.sampling import fan_of_preferences, uniform_instances
from models.networks import build, pa_one
from models.networks.aiming import aimed
from models.validation import greedy_tours

CHECKPOINTS = Path(__file__).parents[3] / "models/checkpoints"
CPU = torch.device("cpu")


def directions(*degrees: float) -> Tensor:
    radians = torch.tensor(degrees, dtype=torch.float64).deg2rad()
    return torch.stack((radians.cos(), radians.sin()), dim=-1)


def angles(points: Tensor) -> Tensor:
    return torch.atan2(points[..., 1], points[..., 0]).rad2deg()


def test_the_axes_and_the_diagonal_stay() -> None:
    torch.testing.assert_close(aimed(directions(0, 45, 90)), directions(0, 45, 90))


def test_every_angle_turns_away_from_the_diagonal_and_none_passes_another() -> None:
    asked = torch.linspace(0, 90, 181, dtype=torch.float64)
    turned = angles(aimed(directions(*asked.tolist())))
    assert (turned.diff() > 0).all()
    assert ((turned - 45).abs() >= (asked - 45).abs() - 1e-9).all()
    torch.testing.assert_close(turned, 90 - turned.flip(0))


def test_unit_vectors_stay_unit_vectors() -> None:
    lengths = aimed(fan_of_preferences(33, CPU)).norm(dim=-1)
    torch.testing.assert_close(lengths, torch.ones(33))


@pytest.mark.parametrize("name", ["pa-one", "pa-one-matrix"])
def test_tours_of_the_released_actor_point_nearer_to_what_was_asked(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    actor = load_weights(CHECKPOINTS / f"{name}.pt").actor
    preferences = fan_of_preferences(20, CPU)
    instances = uniform_instances(actor.reads, 3, 80, Generator().manual_seed(1), CPU)

    def errors() -> Tensor:
        points = tour_lengths(instances, greedy_tours(actor, instances, preferences))
        return (angles(points) - angles(preferences)).abs()

    beyond = errors()
    for module in (build, pa_one):
        monkeypatch.setattr(module, "aimed", lambda asked: asked)
    assert beyond.mean() < errors().mean()
