"""Preferences: turned away from the diagonal, and in groups of neighbours."""

import math
from pathlib import Path

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import Generator, Tensor

from models.checkpoint import load_weights
from models.data.instances import tour_lengths, uniform_instances
from models.data.preferences import (
    directions_of,
    fan_of_preferences,
    fan_or_lattice,
    grouped,
    turned_outwards,
    weights,
)
from service import preferences as service_preferences

CHECKPOINTS = Path(__file__).parents[3] / "models/checkpoints"
CPU = torch.device("cpu")


def directions(*degrees: float) -> Tensor:
    radians = torch.tensor(degrees, dtype=torch.float64).deg2rad()
    return torch.stack((radians.cos(), radians.sin()), dim=-1)


def angles(points: Tensor) -> Tensor:
    return torch.atan2(points[..., 1], points[..., 0]).rad2deg()


def test_the_axes_and_the_diagonal_stay() -> None:
    torch.testing.assert_close(turned_outwards(directions(0, 45, 90)), directions(0, 45, 90))


def test_every_angle_turns_away_from_the_diagonal_and_none_passes_another() -> None:
    asked = torch.linspace(0, 90, 181, dtype=torch.float64)
    turned = angles(turned_outwards(directions(*asked.tolist())))
    assert (turned.diff() > 0).all()
    assert ((turned - 45).abs() >= (asked - 45).abs() - 1e-9).all()
    torch.testing.assert_close(turned, 90 - turned.flip(0))


def test_unit_vectors_stay_unit_vectors() -> None:
    lengths = turned_outwards(fan_of_preferences(33, CPU)).norm(dim=-1)
    torch.testing.assert_close(lengths, torch.ones(33))


def turned_inwards(preferences: Tensor) -> Tensor:
    """The preferences that are turned outwards to these."""
    radians = torch.atan2(preferences[:, 1], preferences[:, 0])
    share = radians * (4 / math.pi) - 1
    turned = (1 + share.sign() * share.abs() ** (1 / 0.8)) * (math.pi / 4)
    return torch.stack((turned.cos(), turned.sin()), dim=-1)


@pytest.mark.parametrize("name", ["pa-one", "pa-one-matrix"])
def test_tours_of_the_released_actor_point_nearer_to_their_preference(name: str) -> None:
    """Than those built for the preferences as they are, which the turn is undone for."""
    actor = load_weights(CHECKPOINTS / f"{name}.pt").actor
    preferences = fan_of_preferences(20, CPU)
    unturned = turned_inwards(preferences)
    torch.testing.assert_close(turned_outwards(unturned), preferences, atol=1e-5, rtol=0)
    instances = uniform_instances(actor.reads, 3, 80, Generator().manual_seed(1), CPU)

    def mean_error(asked: Tensor) -> Tensor:
        points = tour_lengths(instances, actor.tours(instances, asked))
        return (angles(points) - angles(preferences)).abs().mean()

    assert mean_error(preferences) < mean_error(unturned)


@given(angles=st.lists(st.floats(0, 90), min_size=1, max_size=30), groups=st.integers(1, 6))
def test_every_preference_is_found_where_it_was_put(angles: list[float], groups: int) -> None:
    radians = torch.tensor(angles).deg2rad()
    preferences = torch.stack((radians.cos(), radians.sin()), dim=-1)
    rows, members, places = grouped(preferences, groups)
    assert torch.equal(rows[places], preferences)
    assert torch.equal(rows, preferences[members])
    assert len(rows) % groups == 0
    assert len(rows) < len(angles) + groups


def test_groups_hold_neighbours() -> None:
    radians = torch.tensor([80.0, 10, 45, 50, 15, 85]).deg2rad()
    rows = grouped(torch.stack((radians.cos(), radians.sin()), dim=-1), 3).rows
    found = torch.atan2(rows[:, 1], rows[:, 0]).rad2deg().tolist()
    assert found == pytest.approx([10, 15, 45, 50, 80, 85], abs=1e-3)


@given(st.lists(st.floats(0.01, 1), min_size=2, max_size=4))
def test_a_direction_has_equal_parts_in_its_weighted_sum(parts: list[float]) -> None:
    rows = torch.tensor([parts], dtype=torch.float64)
    rows = rows / rows.sum()
    found = directions_of(rows)
    torch.testing.assert_close(found.norm(dim=1), torch.ones(1, dtype=torch.float64))
    torch.testing.assert_close(found * rows, (found * rows)[:, :1].expand_as(rows))
    torch.testing.assert_close(weights(found), rows)


def test_the_lattice_of_three_objectives_is_that_of_the_literature() -> None:
    rows = weights(fan_or_lattice(100, 3, CPU))
    multiples = 13 * rows
    assert rows.shape == (105, 3)
    assert (multiples - multiples.round()).abs().max() < 0.03  # no weight is zero
    assert len({tuple(row) for row in multiples.round().tolist()}) == 105
    assert torch.equal(fan_or_lattice(100, 2, CPU), fan_of_preferences(100, CPU))


@given(angle=st.floats(0.06, 89.94))
def test_the_weights_of_a_direction_are_those_of_the_service(angle: float) -> None:
    found = weights(directions(angle)).numpy()
    assert found == pytest.approx(service_preferences.weights(directions(angle).numpy()))
