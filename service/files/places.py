"""Check places on the earth: degrees out of range, and places that look mistaken."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from paretour.member_parts import FleetStopRequest

from service.files.reading import Source
from service.requests.notes.places import doubtful_places
from service.roads.great_circle import great_circle_matrix

Array = NDArray[np.float64]


def weighted(places: Array, weights: Array) -> list[list[float]]:
    """Return the metres between all places, times the mean of the weights of both ends."""
    costs = great_circle_matrix(places) * (weights[:, np.newaxis] + weights) / 2
    return [[float(f"{cost:.7g}") for cost in row] for row in costs.tolist()]


def check_range(source: Source, place: Sequence[float], where: str) -> None:
    """Raise UnreadableFile if a longitude or a latitude is out of range."""
    for _, code, values in out_of_range(place):
        raise source.refusal(code, where, **values)


def out_of_range(place: Sequence[float]) -> Iterator[tuple[int, str, dict[str, object]]]:
    """Yield each axis on which a place is not on the earth, and what is wrong, with its values."""
    for axis, (name, most) in enumerate((("longitude", 180), ("latitude", 90))):
        value = place[axis]
        if not -most <= value <= most:
            wrong = "off-the-earth"
            if name == "latitude" and abs(value) <= 180 and abs(place[0]) <= 90:
                wrong = "degrees-swapped"
            elif max(abs(place[0]), abs(place[1])) > 180:
                wrong = "not-in-degrees"
            yield axis, wrong, {"axis": name, "most": most, "came": value}


def note_places(source: Source, stops: Sequence[FleetStopRequest]) -> None:
    """Note stops whose places look mistaken."""
    places = np.array([stop["location"] for stop in stops])
    for doubt in doubtful_places([str(stop["id"]) for stop in stops], places):
        source.note(doubt.code, doubt.text)
