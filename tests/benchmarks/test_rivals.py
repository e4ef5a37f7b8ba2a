"""The rivals give valid and good tours; those of a missing optional library are skipped."""

from importlib import import_module
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from numpy.typing import NDArray

from service.instance import Instance, tour_lengths
from service.pareto import nondominated
from tests.benchmarks.kro import rounded_distances
from tests.benchmarks.rivals.construction import (
    distances,
    greedy_edge,
    nearest_neighbour,
    spread_weights,
)
from tests.helpers.instances import all_tours

TINY = Instance(coordinates=np.random.default_rng(0).random((7, 4)) * [3, 3, 50, 50])
LIBRARIES = pytest.mark.parametrize(
    ("name", "library", "limit"),
    [("fast_tsp_weights", "fast_tsp", 0.01), ("ortools_routing", "ortools", None)],
)


def rival(name: str, library: str) -> ModuleType:
    pytest.importorskip(library)
    return import_module(f"tests.benchmarks.rivals.{name}")


def are_tours(tours: NDArray[np.integer], n: int) -> bool:
    return (np.sort(tours, axis=-1) == np.arange(n)).all()


def longer_than_shortest(tour: NDArray[np.integer], weights: NDArray[np.float64]) -> float:
    """By which factor, under weighted and scaled lengths."""
    shortest = (tour_lengths(TINY, all_tours(TINY.n)) / TINY.scale @ weights).min()
    return (tour_lengths(TINY, tour[None]) / TINY.scale @ weights)[0] / shortest


@pytest.mark.parametrize("construct", [nearest_neighbour, greedy_edge])
def test_construction_gives_one_tour_for_each_weight(construct) -> None:
    tours = construct(TINY, spread_weights(5))
    assert tours.shape == (5, TINY.n)
    assert are_tours(tours, TINY.n)


@LIBRARIES
def test_libraries_come_close_to_the_shortest_tour_under_each_weight(
    name: str, library: str, limit: float | None
) -> None:
    solve = rival(name, library).solve
    first, second = distances(TINY.scaled_coordinates)
    for weights in spread_weights(5):
        tour = solve(weights[0] * first + weights[1] * second, limit)
        assert are_tours(tour, TINY.n)
        assert longer_than_shortest(tour, weights) < 1.1


@LIBRARIES
def test_libraries_beat_greedy_edge(name: str, library: str, limit: float | None) -> None:
    solve = rival(name, library).solve
    instance = Instance(coordinates=np.random.default_rng(1).random((30, 4)))
    cost = distances(instance.scaled_coordinates)[0]
    tours = [solve(cost, limit), greedy_edge(instance, np.array([[1.0, 0.0]]))[0]]
    assert are_tours(tours[0], 30)
    found, greedy = tour_lengths(instance, np.array(tours))[:, 0] / instance.scale[0]
    assert found < greedy


def test_fast_tsp_takes_costs_of_any_magnitude() -> None:
    solve = rival("fast_tsp_weights", "fast_tsp").solve
    cost = distances(TINY.scaled_coordinates)[0]
    for magnitude in (1e-9, 1e12):
        assert longer_than_shortest(solve(cost * magnitude, 0.01), np.array([1.0, 0.0])) < 1.001


@pytest.mark.parametrize("name", ["nsga2", "moead"])
def test_evolution_finds_fronts_of_real_tours_that_only_grow(name: str) -> None:
    evolve = getattr(rival("evolutionary", "pymoo"), name)
    snapshots = evolve(TINY, population=10, evaluations=300)
    possible = tour_lengths(TINY, all_tours(TINY.n))
    seconds = [at for at, _ in snapshots]
    assert seconds == sorted(seconds)
    for _, points in snapshots:
        assert np.array_equal(nondominated(points), np.arange(len(points)))
        assert np.isclose(points[:, None], possible, rtol=1e-9).all(axis=2).any(axis=1).all()
    for (_, before), (_, after) in pairwise(snapshots):
        assert (after[:, None] <= before * (1 + 1e-12)).all(axis=2).any(axis=0).all()


def test_evolution_repeats_itself_under_the_same_seed() -> None:
    evolutionary = rival("evolutionary", "pymoo")
    [first, second] = [evolutionary.nsga2(TINY, 10, 200, seed=3)[-1][1] for _ in range(2)]
    assert np.array_equal(first, second)


def test_distances_of_tsplib_files_are_rounded_to_the_nearest(tmp_path: Path) -> None:
    path = tmp_path / "three.tsp"
    path.write_text(
        "NAME: three\nEDGE_WEIGHT_TYPE : EUC_2D\nNODE_COORD_SECTION\n"
        "1 0 0\n2 1 1\n3 2.5 0.0e0\nEOF\n",
        encoding="utf-8",
    )
    assert rounded_distances(path).tolist() == [[0, 1, 3], [1, 0, 2], [3, 2, 0]]
