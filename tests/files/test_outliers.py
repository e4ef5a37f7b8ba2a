"""Stops far from all others, as by a mistyped digit; and files whose stops are far apart."""

import numpy as np
import pytest
from numpy.typing import NDArray

from service.files.places import note_places
from service.files.reading import Bounds, NamedFile, Source

Array = NDArray[np.float64]
RANDOM = np.random.default_rng(1)
CAPITALS = np.array([[13.4, 52.5], [2.4, 48.9], [-3.7, 40.4], [12.5, 41.9], [24.9, 60.2], [18, 59]])
TYPO = np.array([[21.4, 41.9]])
REMOTE = np.array([[27, 68.4], [25.7, 66.5], [25.5, 65], [29.8, 62.6], [21.6, 63.1]])


def city(longitude: float, latitude: float, count: int, width: float = 0.05) -> Array:
    return RANDOM.normal([longitude, latitude], width, (count, 2))


ROME = city(12.4, 41.9, 40)


def noted(*places: Array) -> list[str]:
    source = Source(NamedFile("stops.csv", b""), Bounds())
    located = np.vstack(places).tolist()
    note_places(
        source, [{"id": f"order-{at}", "location": each} for at, each in enumerate(located)]
    )
    return [note.text for note in source.notes if note.code == "outlier"]


@pytest.mark.parametrize("others", [ROME, ROME[:5], city(12.4, 41.9, 40, 0.2)])
def test_a_stop_far_from_all_others_is_noted(others: Array) -> None:
    [text] = noted(others, TYPO)
    name, metres = text.split(" is ")
    assert name == f"'order-{len(others)}'"
    assert metres.endswith(" km from the nearest other stop: check its place.")
    assert 650 < float(metres.split()[0]) < 750


@pytest.mark.parametrize(
    "places",
    [
        [ROME],
        [ROME[:4], TYPO],
        [RANDOM.uniform([7, 47.5], [14, 54.5], (200, 2))],  # a country
        [RANDOM.uniform([-124, 26], [-68, 48], (300, 2))],  # a continent
        [city(13.4, 52.5, 30), city(11.6, 48.1, 10)],
        [CAPITALS],
        [city(13.4, 52.5, 30), CAPITALS],
        [ROME, CAPITALS, np.array([[139.7, 35.7], [151.2, -33.9], [-74, 40.7]])],
        [city(24.9, 60.2, 60, 0.1), city(23.8, 61.5, 10), REMOTE],
        [city(179.9, -17, 20), city(-179.9, -17, 20)],  # on both sides of the date line
    ],
)
def test_files_whose_stops_are_far_apart_have_no_outliers(places: list[Array]) -> None:
    assert noted(*places) == []


def test_a_place_at_zero_is_noted_once() -> None:
    assert noted(ROME, np.zeros((1, 2))) == []
