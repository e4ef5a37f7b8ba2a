"""Random instances: planes of several shapes, maps, and coverage matrices."""

import numpy as np
import pytest

from models.data.generators import MAPS, PLANES, coverage_map, coverage_matrices, drawn_map
from service.coverage.grid import largest_region, regions
from service.instance import Instance


@pytest.mark.parametrize("kind", MAPS)
def test_the_same_seed_draws_the_same_map_and_another_seed_another(kind: str) -> None:
    first, again, other = (drawn_map(np.random.default_rng(seed), kind, 64) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()
    assert first.shape == (64, 64)


@pytest.mark.parametrize("kind", ["random", "blocks"])
def test_a_tenth_to_a_third_of_a_map_is_filled(kind: str) -> None:
    for seed in range(20):
        free = drawn_map(np.random.default_rng(seed), kind, 64)
        assert 0.08 < 1 - free.mean() < 0.34


def test_all_rooms_of_a_house_are_reached_through_doors() -> None:
    for seed in range(20):
        free = drawn_map(np.random.default_rng(seed), "house", 64)
        assert regions(free).max() == 1
        assert not free.all()


def test_an_unknown_kind_is_named() -> None:
    with pytest.raises(ValueError, match="random, blocks, house, got 'maze'"):
        drawn_map(np.random.default_rng(0), "maze", 64)


def test_places_are_different_and_in_one_region() -> None:
    for seed in range(10):
        free, places = coverage_map(np.random.default_rng(seed), 100)
        assert len(np.unique(places, axis=0)) == 100
        assert largest_region(free)[tuple(places.T)].all()


def test_a_small_map_is_drawn_until_it_has_room() -> None:
    free, places = coverage_map(np.random.default_rng(0), 12, side=4)
    assert (free.shape, places.shape) == ((4, 4), (12, 2))


def test_coverage_matrices_are_symmetric_metrics() -> None:
    for seed in range(5):
        matrices = coverage_matrices(np.random.default_rng(seed), 30)
        assert Instance(matrices=matrices).symmetric
        detours = matrices[:, :, :, None] + matrices[:, None]
        assert (matrices[:, :, None] <= detours + 1e-9).all()
        assert (matrices[0] + np.eye(30) >= 1).all()
        assert 0 < matrices[1].max() < np.sqrt(2)


@pytest.mark.parametrize("kind", PLANES)
def test_every_kind_of_plane_fills_the_unit_square_in_its_own_way(kind: str) -> None:
    cities = PLANES[kind](300, np.random.default_rng(2))
    assert cities.shape == (300, 2)
    assert cities.min() >= 0
    assert cities.max() <= 1
    extent = np.sort(np.ptp(cities, axis=0))
    on_streets = [len(np.unique(cities[:, axis])) < 299 for axis in (0, 1)]
    spacing = np.sqrt(((cities[:, None] - cities) ** 2).sum(-1) + 9 * np.eye(300)).min(axis=1)
    match kind:
        case "uniform":
            assert extent[0] > 0.9
        case "clustered":
            assert spacing.mean() < 0.02
        case "stretched":
            assert extent[0] < 0.9
        case "streets":
            assert all(on_streets)
