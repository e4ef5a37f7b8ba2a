"""Configurations: checks, storage, labels."""

import json

import pytest

from models.config import NetworkConfig, as_plain, from_plain
from tests.helpers.small_runs import small_config


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"objective": "tchebycheff"}, "objective must be"),
        ({"baseline": "greedy"}, "baseline must be"),
        ({"starts": 1}, "at least 2 starts"),
        ({"baseline": "critic"}, "starts must be 1"),
        ({"least_cities": 9}, "least <= most"),
        ({"steps": 0}, "steps must be at least 1"),
        (
            {"network": NetworkConfig(name="pa-at"), "objectives": 3},
            "objectives of pa-at must be from 2 to 2",
        ),
        ({"objectives": 5}, "must be from 2 to 4"),
        (
            {"objectives": 3, "objective": "lagrangian"},
            "the Lagrangian is of two objectives",
        ),
    ],
)
def test_a_configuration_that_makes_no_sense_is_refused(
    changes: dict[str, object], complaint: str
) -> None:
    with pytest.raises(ValueError, match=complaint):
        small_config(**changes)


@pytest.mark.parametrize(
    ("name", "layers"), [("pa-one", 0), ("pa-at", 2), ("pa-ean", -1), ("pa-tsp", 1)]
)
def test_a_network_that_does_not_exist_is_refused(name: str, layers: int) -> None:
    with pytest.raises(ValueError, match="must be"):
        NetworkConfig(name=name, preference_layers=layers)


def test_a_configuration_survives_storage() -> None:
    config = small_config(seed=7)
    assert from_plain(json.loads(json.dumps(as_plain(config)))) == config
    with pytest.raises(ValueError, match="fields must be"):
        from_plain({**as_plain(config), "surprise": 1})


def test_a_configuration_from_before_there_were_three_objectives_is_of_two() -> None:
    plain = as_plain(small_config())
    del plain["objectives"]
    assert from_plain(plain) == small_config(objectives=2)


@pytest.mark.parametrize(
    ("changes", "label"),
    [
        ({"name": "pa-ad"}, "pa-ad"),
        ({"name": "pa-ad", "graph_layers": 0}, "pa-ad-"),
        ({"name": "pa-at", "preference_layers": 0}, "pa-at-"),
        ({"name": "pa-one", "graph_layers": 0}, "pa-one"),
    ],
)
def test_an_ablation_is_labelled_as_the_paper_does(changes: dict[str, object], label: str) -> None:
    assert NetworkConfig(**changes).label == label
