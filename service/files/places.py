"""Check places on the earth: degrees out of range, and places that look mistaken."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.files.reading import Source, quoted
from service.roads.great_circle import great_circle_distances, great_circle_matrix

Array = NDArray[np.float64]
_FAR = 1_000_000.0  # metres: farther than a van drives
_NEAR = 300_000.0
_MOST_NAMED = 3
_APART = 100_000.0  # metres from the nearest other stop, at least, of a stop that may be mistaken
_TIMES_APART = 20  # more than the median distance from the middle
_LEAST_STOPS, _SHARE = 6, 20  # stops; one in 20 may be mistaken, or one in all
_MOST_COMPARED = 50


def weighted(places: Array, weights: Array) -> list[list[float]]:
    """Return the metres between all places, times the mean of the weights of both ends."""
    costs = great_circle_matrix(places) * (weights[:, np.newaxis] + weights) / 2
    return [[float(f"{cost:.7g}") for cost in row] for row in costs.tolist()]


def check_range(source: Source, place: Sequence[float], where: str) -> None:
    """Raise UnreadableFile if a longitude or a latitude is out of range."""
    for _, demand in out_of_range(place):
        raise source.refusal(f"{where} {demand}")


def out_of_range(place: Sequence[float]) -> Iterator[tuple[int, str]]:
    """Yield each axis on which a place is not on the earth, and what is demanded of it."""
    for axis, (name, most) in enumerate((("longitude", 180), ("latitude", 90))):
        value = place[axis]
        if not -most <= value <= most:
            hint = ""
            if name == "latitude" and abs(value) <= 180 and abs(place[0]) <= 90:
                hint = "; latitude and longitude look swapped"
            elif max(abs(place[0]), abs(place[1])) > 180:
                hint = "; places must be in degrees (WGS84, EPSG:4326): convert them from metres"
            yield axis, f"must have a {name} of -{most} to {most}, got {value:g}{hint}"


def note_places(source: Source, stops: Sequence[dict[str, Any]]) -> None:
    """Note stops that lie at (0, 0), or so far from the rest that they look swapped."""
    places = np.array([stop["location"] for stop in stops])
    ids = [stop["id"] for stop in stops]
    nowhere: NDArray[np.bool_] = np.all(places == 0, axis=1)
    if nowhere.any() and not nowhere.all():
        text = f"{_named(ids, nowhere)} at longitude 0 and latitude 0: was the address not found?"
        source.note("place", text)
    if len(places) < 2:
        return
    swapped = places[:, ::-1]
    possible = np.abs(places[:, 0]) <= 90
    middle = np.median(places, axis=0)
    for anchor, whose in ((middle, "most others"), (places[0], "the first stop")):
        far = great_circle_distances(places, anchor) > _FAR
        on_earth = np.where(possible[:, np.newaxis], swapped, places)
        near = great_circle_distances(on_earth, anchor) < _NEAR
        mistaken = far & near & possible
        if mistaken.any():
            text = f"{_named(ids, mistaken)} far from {whose}, and near with latitude and longitude"
            source.note("swapped", f"{text} swapped: compare them on the map.")
            return
    far = ~nowhere & (great_circle_distances(places, middle) > _FAR)
    if far.any():
        text = f"{_named(ids, far)} more than 1000 km from the middle of all: are latitude and"
        source.note("far", f"{text} longitude in the right order?")
    _note_outliers(source, ids, places, ~nowhere & ~far)


def _note_outliers(
    source: Source, ids: list[str], places: Array, located: NDArray[np.bool_]
) -> None:
    """Note stops so far from every other one that a digit of their place may be mistaken.

    A stop is so far if its nearest other stop is more than 100 km away, and more than 20 times
    the median distance from the middle. Files with many stops that far from the middle have none.
    """
    at = np.flatnonzero(located)
    if len(at) < _LEAST_STOPS:
        return
    kept = places[at]
    off = great_circle_distances(kept, np.median(kept, axis=0))
    median = float(np.median(off))
    least = max(_APART, _TIMES_APART * median)
    candidates = np.flatnonzero(off > least - median)
    if len(candidates) > min(max(1, len(at) // _SHARE), _MOST_COMPARED):
        return
    nearest = {each: _nearest(kept, each) for each in candidates.tolist()}
    alone = [(each, metres) for each, metres in nearest.items() if metres > least]
    for each, metres in alone[:_MOST_NAMED]:
        text = f"{quoted(ids[at[each]])} is {metres / 1000:.0f} km from the nearest other stop"
        source.note("outlier", f"{text}: check its place.")


def _nearest(places: Array, at: int) -> float:
    """Return the metres from one place to the nearest other one."""
    return float(np.delete(great_circle_distances(places, places[at]), at).min())


def _named(ids: Sequence[str], which: NDArray[np.bool_]) -> str:
    """Return the subject and verb of a sentence about the stops that a mask selects."""
    picked = [ids[at] for at in np.flatnonzero(which).tolist()]
    shown = ", ".join(quoted(each) for each in picked[:_MOST_NAMED])
    more = f" and {len(picked) - _MOST_NAMED} more" if len(picked) > _MOST_NAMED else ""
    return f"Stop {shown} lies" if len(picked) == 1 else f"Stops {shown}{more} lie"
