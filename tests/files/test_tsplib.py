"""Files of TSPLIB: every kind of distance and layout, and the optima that are known for them."""

import numpy as np
import pytest

from service.files.benchmarks.keywords import check_costs
from service.files.reading import Bounds, FileTooLarge, NamedFile, Source, UnreadableFile
from service.files.tsplib import costs, split_tsplib
from tests.helpers.tsplib_files import EUCLIDEAN, EXPLICIT

BURMA14 = """
16.47 96.10 16.47 94.44 20.09 92.54 22.39 93.37 25.23 97.24 22.00 96.05 20.47 97.02
17.20 96.29 16.30 97.38 14.05 98.12 16.53 97.38 21.52 95.59 19.41 97.13 20.09 94.55
"""
BURMA14_OPTIMUM = 3323  # as TSPLIB gives it


def matrix_of(text: str) -> list[list[float]]:
    source = Source(NamedFile("a.tsp", b""), Bounds())
    file = split_tsplib(source, text)
    check_costs(file)
    return costs(file).tolist()


def test_euclidean_distances_are_rounded() -> None:
    assert matrix_of(EUCLIDEAN) == [[0, 3, 1], [3, 0, 3], [1, 3, 0]]


def test_a_full_matrix_is_read_as_it_is() -> None:
    assert matrix_of(EXPLICIT) == [[0, 1, 2], [3, 0, 4], [5, 6, 0]]


@pytest.mark.parametrize("n", [1, 20])
def test_distances_are_rounded_as_tsplib_says(n: int) -> None:
    cities = np.random.default_rng(n).integers(0, 50, (n, 2)).tolist()
    for (x1, y1), row in zip(cities, matrix_of(placed("EUC_2D", cities)), strict=True):
        for (x2, y2), distance in zip(cities, row, strict=True):
            squared = (x1 - x2) ** 2 + (y1 - y2) ** 2
            # Twice the distance lies within one of twice the root: whole numbers, no root taken.
            assert max(2 * distance - 1, 0) ** 2 <= 4 * squared < (2 * distance + 1) ** 2


def placed(kind: str, places: list[list[float]]) -> str:
    lines = "\n".join(" ".join(map(str, (i, *place))) for i, place in enumerate(places, 1))
    return f"DIMENSION: {len(places)}\nEDGE_WEIGHT_TYPE: {kind}\nNODE_COORD_SECTION\n{lines}\n"


@pytest.mark.parametrize(
    ("kind", "there", "distance"),
    [
        ("EUC_2D", [3.3, 1], 3),
        ("CEIL_2D", [3, 0.1], 4),
        ("MAN_2D", [3.3, 1.3], 5),
        ("MAX_2D", [3.3, 1.3], 3),
        ("FLOOR_2D", [3.9, 0], 3),
        ("EXACT_2D", [1.5, 2], 2.5),
        ("ATT", [10, 1], 4),  # the root of 10.1 is 3.18, which is never rounded down
        ("EUC_3D", [2, 3, 6], 7),
        ("MAN_3D", [2, 3, 6], 11),
        ("MAX_3D", [2, 3, 6], 6),
    ],
)
def test_every_kind_has_its_own_distances(kind: str, there: list[float], distance: float) -> None:
    places = [[0.0] * len(there), there]
    assert matrix_of(placed(kind, places)) == [[0, distance], [distance, 0]]


def test_the_optimum_of_burma14_is_that_of_tsplib() -> None:
    places = np.array(BURMA14.split(), float).reshape(14, 2).tolist()
    assert held_karp(np.array(matrix_of(placed("GEO", places)))) == BURMA14_OPTIMUM


def held_karp(matrix: np.ndarray) -> float:
    """The length of a shortest tour."""
    n = len(matrix) - 1
    best = np.full((1 << n, n), np.inf)
    best[1 << np.arange(n), np.arange(n)] = matrix[0, 1:]
    for visited in range(1, 1 << n):
        last = np.flatnonzero(np.isfinite(best[visited]))
        for city in range(n):
            if not visited >> city & 1 and len(last):
                reached = (best[visited, last] + matrix[last + 1, city + 1]).min()
                at = visited | 1 << city
                best[at, city] = min(best[at, city], reached)
    return float((best[-1] + matrix[1:, 0]).min())


SYMMETRIC = [[0, 1, 2, 3], [1, 0, 4, 5], [2, 4, 0, 6], [3, 5, 6, 0]]


@pytest.mark.parametrize(
    ("layout", "words"),
    [
        ("FULL_MATRIX", "0 1 2 3 1 0 4 5 2 4 0 6 3 5 6 0"),
        ("UPPER_ROW", "1 2 3 4 5 6"),
        ("LOWER_COL", "1 2 3 4 5 6"),
        ("LOWER_ROW", "1 2 4 3 5 6"),
        ("UPPER_COL", "1 2 4 3 5 6"),
        ("UPPER_DIAG_ROW", "0 1 2 3 0 4 5 0 6 0"),
        ("LOWER_DIAG_COL", "0 1 2 3 0 4 5 0 6 0"),
        ("LOWER_DIAG_ROW", "0 1 0 2 4 0 3 5 6 0"),
        ("UPPER_DIAG_COL", "0 1 0 2 4 0 3 5 6 0"),
    ],
)
def test_every_layout_is_the_same_matrix(layout: str, words: str) -> None:
    header = f"TYPE: TSP\nDIMENSION : 4\nEDGE_WEIGHT_TYPE : EXPLICIT\nEDGE_WEIGHT_FORMAT:{layout}"
    loose = f"{header} \nEDGE_WEIGHT_SECTION:\n {words}\nDISPLAY_DATA_TYPE : NO_DISPLAY\nEOF :\nx"
    assert matrix_of(f"{header}\nEDGE_WEIGHT_SECTION\n{words}\nEOF\n") == SYMMETRIC
    assert matrix_of(loose) == SYMMETRIC


WRONG = [
    (EUCLIDEAN.replace("EUC_2D", "XRAY1"), "got 'XRAY1'"),
    (EXPLICIT.replace("FULL_MATRIX", "FUNCTION"), "got 'FUNCTION'"),
    (EXPLICIT.replace("6 0", "6"), "3 rows of 3 numbers"),
    (EXPLICIT.replace("6 0", "6 7x"), "must hold numbers"),
    ("", "got 'nothing'"),
    (EUCLIDEAN.replace(": 3", ": three"), "got 'three'"),
    ("TYPE: SOP\n", "an order of cities"),
]


@pytest.mark.parametrize(("text", "sentence"), WRONG)
def test_a_file_of_another_kind_is_refused(text: str, sentence: str) -> None:
    with pytest.raises(UnreadableFile, match=sentence):
        matrix_of(text)


def test_a_file_of_too_many_cities_is_refused_before_it_is_read() -> None:
    with pytest.raises(FileTooLarge, match=r"at most 1000 .* got 20000"):
        matrix_of("DIMENSION: 20000\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n")
