"""Preferences in groups of neighbours."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from models.networks.groups import grouped


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
