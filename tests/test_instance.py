"""What an instance is, and what it refuses to be."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from service.errors import InvalidInstance
from service.instance import (
    Instance,
    least_lengths,
    step_lengths,
    tour_lengths,
)
from service.kinds.tours import cumulated_lengths
from tests.helpers.instances import (
    ENDS,
    KINDS,
    every_tour,
    opened,
    random_routes,
    small_integers,
)

COORDINATES = arrays(
    np.float64, st.tuples(st.integers(1, 6), st.just(4)), elements=st.integers(-5, 5)
)
SQUARE = np.array([[0, 0, 0, 0], [3, 0, 0, 1], [3, 4, 2, 1], [0, 4, 2, 0]], dtype=np.float64)


@given(
    kind=st.sampled_from(KINDS),
    ends=st.sampled_from(("closed", *ENDS)),
    n=st.integers(2, 7),
    seed=st.integers(0, 10**6),
)
def test_no_tour_is_shorter_than_the_least_lengths(kind: str, ends: str, n: int, seed: int) -> None:
    instance = small_integers(kind, n, seed)
    if ends != "closed":
        instance = opened(instance, ends, seed)
    shortest = tour_lengths(instance, every_tour(instance)).min(axis=0)
    assert (least_lengths(instance) <= shortest * (1 + 1e-12)).all()


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({}, "either coordinates or matrices"),
        ({"coordinates": SQUARE, "matrices": np.zeros((2, 4, 4))}, "and not both"),
        ({"coordinates": np.zeros((0, 4))}, r"n at least 1, got \(0, 4\)"),
        ({"coordinates": np.zeros((3, 2))}, r"shape \(n, 4\), .* got \(3, 2\)"),
        ({"coordinates": np.zeros(4)}, r"got \(4,\)"),
        ({"coordinates": np.array([[0, 0, 0, np.nan]])}, "coordinates must be finite"),
        ({"coordinates": np.array([[0, 0, 0, np.inf]])}, "coordinates must be finite"),
        # Each is finite; their difference is not.
        ({"coordinates": np.array([[1e308] * 4, [-1e308] * 4])}, "length finite"),
        ({"matrices": np.zeros((2, 3, 4))}, r"shape \(m, n, n\) .* got \(2, 3, 4\)"),
        ({"matrices": np.zeros((1, 3, 3))}, r"got \(1, 3, 3\)"),
        ({"matrices": np.zeros((2, 0, 0))}, "n at least 1"),
        ({"matrices": -np.ones((2, 2, 2))}, "not be negative, got -1"),
        ({"matrices": np.full((2, 2, 2), np.nan)}, "got NaN from city 0 to 1 in matrix 0; .* null"),
        ({"matrices": np.full((2, 2, 2), -np.inf)}, "not be negative, got -inf"),
        ({"matrices": np.full((2, 2, 2), 1e308)}, r"got costs up to 1e\+308"),
        ({"coordinates": SQUARE, "start": 1}, "a closed tour has no start, got 1"),
        ({"coordinates": SQUARE, "end": 0}, "a closed tour has no end, got 0"),
        ({"coordinates": SQUARE, "closed": False, "end": 4}, "end must be a city, 0 to 3, got 4"),
        ({"coordinates": SQUARE, "closed": False, "start": -1}, "start must be a city"),
        ({"coordinates": SQUARE, "closed": False, "start": 2, "end": 2}, "cannot end where"),
    ],
)
def test_what_is_not_an_instance_is_refused(given: dict[str, np.ndarray], sentence: str) -> None:
    with pytest.raises(InvalidInstance, match=sentence):
        Instance(**given)


def test_a_leg_that_is_infinite_under_one_objective_is_forbidden() -> None:
    costs = np.arange(1.0, 19.0).reshape(2, 3, 3)
    costs[0, 0, 1] = np.inf
    costs[1, 2, 2] = np.nan  # on the diagonal anything is disregarded
    instance = Instance(matrices=costs)
    assert instance.matrices is not None
    assert instance.matrices[:, 0, 1].tolist() == [np.inf, np.inf]
    assert np.isfinite(instance.matrices).sum() == 16
    assert instance.scale.tolist() == [8, 17]
    tours = np.array([[0, 1, 2], [0, 2, 1]])
    assert tour_lengths(instance, tours).tolist() == [[np.inf, np.inf], [15, 42]]
    assert (instance.scaled_matrices[:, 0, 1] == np.inf).all()


def test_the_least_lengths_are_infinite_where_a_city_has_no_leg_out() -> None:
    costs = np.ones((2, 3, 3))
    costs[:, 1] = np.inf
    assert (least_lengths(Instance(matrices=costs)) == np.inf).all()
    assert least_lengths(Instance(matrices=costs, closed=False)).tolist() == [2, 2]
    assert Instance(matrices=np.full((2, 3, 3), np.inf)).scale.tolist() == [1, 1]


def test_the_scale_is_the_longer_side_of_each_plane() -> None:
    assert Instance(coordinates=SQUARE).scale.tolist() == [4, 2]


def test_the_scale_of_matrices_is_their_largest_cost_beside_the_diagonal() -> None:
    matrices = np.array([[[9, 2], [1, 9]], [[0, 0], [0, 0]]])
    assert Instance(matrices=matrices).scale.tolist() == [2, 1]


def test_the_scale_of_coincident_cities_is_one() -> None:
    assert Instance(coordinates=np.full((5, 4), 7.0)).scale.tolist() == [1, 1]


@given(COORDINATES)
def test_scaled_coordinates_fill_the_unit_square_and_no_more(coordinates: np.ndarray) -> None:
    scaled = Instance(coordinates=coordinates).scaled_coordinates
    assert scaled.min() == 0
    longer_sides = scaled.max(axis=0).reshape(2, 2).max(axis=1)
    assert set(longer_sides) <= {0.0, 1.0}


def test_matrices_have_no_scaled_coordinates() -> None:
    with pytest.raises(InvalidInstance, match="no coordinates"):
        _ = Instance(matrices=np.ones((2, 3, 3))).scaled_coordinates


@given(COORDINATES)
def test_scaled_matrices_are_the_distances_of_scaled_coordinates(coordinates: np.ndarray) -> None:
    instance = Instance(coordinates=coordinates)
    cities = instance.scaled_coordinates
    expected = np.array(
        [[[math.dist(a[m : m + 2], b[m : m + 2]) for b in cities] for a in cities] for m in (0, 2)]
    )
    np.testing.assert_allclose(instance.scaled_matrices, expected)


def test_scaled_matrices_have_a_largest_entry_of_one_and_a_diagonal_of_zeros() -> None:
    scaled = Instance(matrices=np.array([[[9, 2], [1, 9]], [[5, 3], [30, 5]]])).scaled_matrices
    assert scaled.tolist() == [[[0, 1], [0.5, 0]], [[0, 0.1], [1, 0]]]


def test_a_tour_is_closed() -> None:
    lengths = tour_lengths(Instance(coordinates=SQUARE), np.array([[0, 1, 2, 3], [0, 2, 1, 3]]))
    np.testing.assert_allclose(lengths[0], [3 + 4 + 3 + 4, 1 + 2 + 1 + 2])
    np.testing.assert_allclose(lengths[1], [5 + 4 + 5 + 4, 5**0.5 + 2 + 5**0.5 + 2])


@given(COORDINATES)
def test_an_open_route_is_shorter_by_the_step_back(coordinates: np.ndarray) -> None:
    closed = Instance(coordinates=coordinates)
    both = replace(closed, closed=False)
    by_matrices = replace(
        both, coordinates=None, matrices=closed.scaled_matrices * closed.scale[:, None, None]
    )
    tours = np.array([range(closed.n), range(closed.n)[::-1]])
    back = step_lengths(closed, tours[:, -1], tours[:, 0])
    expected = tour_lengths(closed, tours) - back
    np.testing.assert_allclose(tour_lengths(both, tours), expected, atol=1e-12)
    np.testing.assert_allclose(tour_lengths(by_matrices, tours), expected, atol=1e-12)


@given(COORDINATES, st.randoms(use_true_random=False))
def test_coordinates_and_their_distances_give_the_same_lengths(
    coordinates: np.ndarray, random: np.random.Generator
) -> None:
    steps = coordinates[:, None] - coordinates
    matrices = np.stack([np.hypot(steps[..., 0], steps[..., 1]), np.hypot(*steps.T[2:]).T])
    tour = list(range(len(coordinates)))
    random.shuffle(tour)
    tours = np.array([tour])
    by_coordinates = tour_lengths(Instance(coordinates=coordinates), tours)
    by_matrices = Instance(matrices=matrices)
    np.testing.assert_allclose(by_coordinates, tour_lengths(by_matrices, tours))
    assert by_matrices.symmetric


def test_the_direction_of_a_tour_matters_where_costs_are_asymmetric() -> None:
    matrices = np.array([[[0, 1, 5], [5, 0, 1], [1, 5, 0]], [[0, 1, 1], [1, 0, 1], [1, 1, 0]]])
    instance = Instance(matrices=matrices)
    assert not instance.symmetric
    lengths = tour_lengths(instance, np.array([[0, 1, 2], [0, 2, 1]]))
    assert lengths.tolist() == [[3, 3], [15, 3]]


def test_an_instance_keeps_its_own_copy() -> None:
    given = SQUARE.copy()
    instance = Instance(coordinates=given)
    given[0] = 99
    assert instance.coordinates is not None
    assert instance.coordinates[0].tolist() == [0, 0, 0, 0]
    with pytest.raises(ValueError, match="read-only"):
        instance.coordinates[0] = 99


@given(
    st.sampled_from(KINDS),
    st.integers(1, 8),
    st.sampled_from(["closed", *ENDS]),
    st.integers(0, 1000),
)
def test_lengths_are_cumulated_step_by_step(kind: str, n: int, ends: str, seed: int) -> None:
    instance = small_integers(kind, n, seed)
    if ends != "closed" and n > 1:
        instance = opened(instance, ends, seed)
    tours = random_routes(instance, 3, seed)
    found = cumulated_lengths(instance, tours)
    for tour, arrivals in zip(tours.tolist(), found, strict=True):
        way = [*tour, tour[0]] if instance.closed else tour
        so_far = np.zeros(2)
        assert len(arrivals) == len(way)
        np.testing.assert_array_equal(arrivals[0], so_far)
        for k in range(1, len(way)):
            so_far += step_lengths(instance, np.array(way[k - 1]), np.array(way[k]))
            np.testing.assert_allclose(arrivals[k], so_far)
    np.testing.assert_allclose(found[:, -1], tour_lengths(instance, tours))
