"""Notes on places on the earth that look mistaken."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.requests.notes.land import on_land
from service.requests.notes.note import listed
from service.roads.great_circle import great_circle_distances

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
_FAR = 1_000_000.0  # metres: farther than a van drives
_NEAR = 300_000.0
_APART = 100_000.0  # metres from the nearest other stop, at least, of a stop that may be mistaken
_TIMES_APART = 20  # more than the median distance from the middle
_LEAST_STOPS, _SHARE = 6, 20  # stops; one in 20 may be mistaken, or one in all
_MOST_COMPARED = 50
_MOST_OUTLIERS = 3


class Doubt(NamedTuple):
    """A note on some places: its code, its sentence, and the indexes of the places."""

    code: str
    text: str
    at: list[int]


def doubtful_places(names: Sequence[str], places: Array) -> Iterator[Doubt]:
    """Yield notes on stops that lie at (0, 0), at sea, or far from all others.

    Args:
        places: Longitude and latitude of each in degrees, shape (n, 2).
    """
    nowhere: Mask = np.all(places == 0, axis=1)
    if nowhere.any() and not nowhere.all():
        text = f"{_lie(names, nowhere)} at longitude 0 and latitude 0: was the address not found?"
        yield _doubt("place", text, nowhere)
    if len(places) < 2:
        return
    if (doubt := _swapped(names, places, nowhere)) is not None:
        yield doubt
        return
    middle = np.median(places, axis=0)
    far = ~nowhere & (great_circle_distances(places, middle) > _FAR)
    if far.any():
        text = f"{_lie(names, far)} more than 1000 km from the middle of all: are latitude and"
        yield _doubt("far", f"{text} longitude in the right order?", far)
    yield from _outliers(names, places, ~nowhere & ~far)


def _swapped(names: Sequence[str], places: Array, nowhere: Mask) -> Doubt | None:
    """Return a note on stops that look right with latitude and longitude swapped: all, or some."""
    swapped = places[:, ::-1]
    at_sea = ~nowhere & ~on_land(places)
    if 2 * at_sea.sum() > (~nowhere).sum() and on_land(swapped[~nowhere]).all():
        text = (
            f"{_lie(names, at_sea)} at sea or in Antarctica, and on land with latitude and"
            " longitude swapped: longitude comes first."
        )
        return _doubt("swapped", text, at_sea)
    possible = np.abs(places[:, 0]) <= 90
    on_earth = np.where(possible[:, np.newaxis], swapped, places)
    middle = np.median(places, axis=0)
    for anchor, whose in ((middle, "most others"), (places[0], "the first stop")):
        far = great_circle_distances(places, anchor) > _FAR
        near = great_circle_distances(on_earth, anchor) < _NEAR
        mistaken = far & near & possible
        if mistaken.any():
            text = f"{_lie(names, mistaken)} far from {whose}, and near with latitude and longitude"
            return _doubt("swapped", f"{text} swapped: compare them on the map.", mistaken)
    return None


def _outliers(names: Sequence[str], places: Array, located: Mask) -> Iterator[Doubt]:
    """Yield notes on stops so far from every other one that a digit of their place may be mistaken.

    A stop is so far if its nearest other stop is more than 100 km away, and more than 20 times
    the median distance from the middle. Where many stops are that far from the middle, none is
    noted.
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
    for each, metres in alone[:_MOST_OUTLIERS]:
        name = listed([names[at[each]]])
        text = f"{name} is {metres / 1000:.0f} km from the nearest other stop: check its place."
        yield Doubt("outlier", text, [int(at[each])])


def _nearest(places: Array, at: int) -> float:
    """Return the metres from one place to the nearest other one."""
    return float(np.delete(great_circle_distances(places, places[at]), at).min())


def _doubt(code: str, text: str, which: Mask) -> Doubt:
    return Doubt(code, text, np.flatnonzero(which).tolist())


def _lie(names: Sequence[str], which: Mask) -> str:
    """Return the subject and verb of a sentence about the stops that a mask selects."""
    picked = [names[at] for at in np.flatnonzero(which).tolist()]
    return f"Stop {listed(picked)} lies" if len(picked) == 1 else f"Stops {listed(picked)} lie"
