"""Matrices of costs drawn at random: each kind by what sets it apart."""

import numpy as np
import pytest

from models.data.matrices import MATRICES, SHARES
from service.instance import Instance

SYMMETRIC = {"planes", "rounded_planes", "maps"}
METRIC = {"closed_entries", "planes", "maps", "roads"}


@pytest.mark.parametrize("kind", MATRICES)
def test_each_kind_is_costs_of_steps_between_cities(kind: str) -> None:
    for seed in range(3):
        matrices = MATRICES[kind](14, np.random.default_rng(seed))
        assert matrices.shape == (2, 14, 14)
        assert np.isfinite(matrices).all()
        assert (matrices >= 0).all()
        assert (np.einsum("mii->mi", matrices) == 0).all()
        assert Instance(matrices=matrices).symmetric == (kind in SYMMETRIC)
        assert np.array_equal(matrices, MATRICES[kind](14, np.random.default_rng(seed)))


@pytest.mark.parametrize("kind", MATRICES)
def test_no_way_round_is_shorter_where_costs_are_of_shortest_ways(kind: str) -> None:
    matrices = MATRICES[kind](14, np.random.default_rng(4))
    by_way_of_another = (matrices[:, :, :, None] + matrices[:, None]).min(axis=2)
    assert (by_way_of_another >= matrices - 1e-9).all() == (kind in METRIC)


def test_rounded_planes_have_whole_numbers() -> None:
    matrices = MATRICES["rounded_planes"](30, np.random.default_rng(5))
    assert np.array_equal(matrices, np.rint(matrices))
    assert matrices.max(axis=(1, 2)).min() > 3


def test_there_are_roads_for_few_cities_and_many() -> None:
    for n in (2, 3, 150):
        assert MATRICES["roads"](n, np.random.default_rng(n)).shape == (2, n, n)


def test_every_kind_has_its_share() -> None:
    assert len(SHARES) == len(MATRICES)
    assert sum(SHARES) == pytest.approx(1)
    assert min(SHARES) > 0
