"""Great-circle distances: known ones, and those of another formula."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.roads.great_circle import (
    EARTH_RADIUS,
    great_circle_distances,
    great_circle_matrix,
)

QUARTER = math.pi / 2 * EARTH_RADIUS
PLACES = st.lists(st.tuples(st.floats(-180, 180), st.floats(-90, 90)), min_size=1, max_size=6).map(
    np.array
)


@pytest.mark.parametrize(
    ("here", "there", "metres"),
    [
        ((0, 0), (0, 0), 0),
        ((0, 0), (90, 0), QUARTER),
        ((-135, 0), (135, 0), QUARTER),  # over the antimeridian
        ((12, 90), (-77, -90), 2 * QUARTER),  # from pole to pole, whatever the longitudes
        ((10, 20), (-170, -20), 2 * QUARTER),  # antipodes, where rounding may exceed 1
        ((0, 0), (0, 1), math.pi / 180 * EARTH_RADIUS),
        # Between the airports BNA and LAX, 2887.26 km on a sphere of 6372.8 km (Rosetta Code,
        # Haversine formula).
        ((-86.67, 36.12), (-118.40, 33.94), 2887259.95 * EARTH_RADIUS / 6372800),
    ],
)
def test_a_known_distance(
    here: tuple[float, float], there: tuple[float, float], metres: float
) -> None:
    distances = great_circle_matrix(np.array([here, there], dtype=np.float64))
    np.testing.assert_allclose(distances, [[0, metres], [metres, 0]], rtol=2e-6, atol=1e-6)


@given(PLACES)
def test_distances_are_those_between_vectors_to_the_places(places: np.ndarray) -> None:
    longitude, latitude = np.radians(places).T
    vectors = np.stack(
        (
            np.cos(latitude) * np.cos(longitude),
            np.cos(latitude) * np.sin(longitude),
            np.sin(latitude),
        ),
        axis=1,
    )
    chords = np.linalg.norm(vectors[:, np.newaxis] - vectors, axis=2)
    opposite = np.linalg.norm(vectors[:, np.newaxis] + vectors, axis=2)
    expected = EARTH_RADIUS * 2 * np.arctan2(chords, opposite)
    distances = great_circle_matrix(places)
    # Half a metre at the antipodes, where the sine is flat; elsewhere far less.
    np.testing.assert_allclose(distances, expected, rtol=1e-9, atol=0.5)
    np.testing.assert_array_equal(distances, distances.T)
    assert (np.diag(distances) == 0).all()


def test_places_a_metre_apart_keep_their_digits() -> None:
    north = np.degrees(1 / EARTH_RADIUS)
    distances = great_circle_matrix(np.array([[24.94, 60.17], [24.94, 60.17 + north]]))
    np.testing.assert_allclose(distances[0, 1], 1, rtol=1e-6)


@given(PLACES)
def test_distances_from_places_to_others_are_those_of_the_matrix(places: np.ndarray) -> None:
    others = np.roll(places, 1, axis=0)
    matrix = great_circle_matrix(places)
    expected = matrix[np.arange(len(places)), np.roll(np.arange(len(places)), 1)]
    np.testing.assert_allclose(great_circle_distances(places, others), expected)
