"""Files of TSPLIB, and those that are none or of a kind that is not supported."""

import numpy as np
import pytest

from service.cli.errors import UnreadableFile
from service.cli.inputs.tsplib import parse_coordinates, parse_matrix
from tests.helpers.tsplib_files import EUCLIDEAN, EXPLICIT


def test_euclidean_distances_are_rounded() -> None:
    assert parse_matrix(EUCLIDEAN).tolist() == [[0, 3, 1], [3, 0, 3], [1, 3, 0]]


def test_a_full_matrix_is_read_as_it_is() -> None:
    assert parse_matrix(EXPLICIT).tolist() == [[0, 1, 2], [3, 0, 4], [5, 6, 0]]


def test_coordinates_are_not_rounded() -> None:
    assert parse_coordinates(EUCLIDEAN).tolist() == [[0, 0], [3.4, 0], [0, 0.5]]


@pytest.mark.parametrize("n", [1, 20])
def test_distances_are_rounded_as_tsplib_says(n: int) -> None:
    cities = np.random.default_rng(n).integers(0, 50, (n, 2)).tolist()
    lines = "\n".join(f"{i} {x} {y}" for i, (x, y) in enumerate(cities, 1))
    text = f"DIMENSION: {n}\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n{lines}\n"
    matrix = parse_matrix(text)
    for (x1, y1), row in zip(cities, matrix, strict=True):
        for (x2, y2), distance in zip(cities, row, strict=True):
            squared = (x1 - x2) ** 2 + (y1 - y2) ** 2
            # Twice the distance lies within one of twice the root: whole numbers, no root taken.
            assert max(2 * distance - 1, 0) ** 2 <= 4 * squared < (2 * distance + 1) ** 2


WRONG = [
    (EUCLIDEAN.replace("EUC_2D", "GEO"), "got GEO with nothing"),
    (EXPLICIT.replace("FULL_MATRIX", "UPPER_ROW"), "with UPPER_ROW"),
    (EXPLICIT.replace("6 0", "6"), "3 rows of 3 numbers"),
    (EXPLICIT.replace("6 0", "6 x"), "must hold numbers"),
    ("", "got nothing"),
    (EUCLIDEAN.replace(": 3", ": three"), "got three"),
]


@pytest.mark.parametrize(("text", "sentence"), WRONG)
def test_a_file_of_another_kind_is_refused(text: str, sentence: str) -> None:
    with pytest.raises(UnreadableFile, match=sentence):
        parse_matrix(text)


def test_planes_need_euclidean_files() -> None:
    with pytest.raises(UnreadableFile, match="EDGE_WEIGHT_TYPE must be EUC_2D, got EXPLICIT"):
        parse_coordinates(EXPLICIT)
