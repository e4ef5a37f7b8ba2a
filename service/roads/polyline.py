"""Decode polylines: lines of places as text (Google, Encoded Polyline Algorithm Format)."""

import numpy as np
from numpy.typing import NDArray

from service.roads.router import Line, Unintelligible

_BITS = 5  # of a number in each character
_MORE = 32  # set in all characters of a number but its last
_FIRST = 63  # the character of zero
_MOST_CHARACTERS = 7  # of a number: 360 degrees in 10^-6 have 29 bits, and one for the sign


def decode_polyline(text: str, precision: int) -> Line:
    """Return the places of a line, shape (m, 2), longitude first. O(characters), in numpy.

    Args:
        text: The encoded line: latitude first, each place relative to the one before.
        precision: The decimals of a degree.

    Raises:
        Unintelligible: The text is not an encoded line, or a place is not on the Earth.

    >>> decode_polyline("_p~iF~ps|U_ulLnnqC", 5).tolist()
    [[-120.2, 38.5], [-120.95, 40.7]]
    """
    numbers = _numbers(np.frombuffer(text.encode(), np.uint8).astype(np.int64) - _FIRST)
    if len(numbers) % 2:
        raise Unintelligible("a line must be of whole places")
    places = numbers.reshape(-1, 2)[:, ::-1].cumsum(axis=0) / 10**precision
    if (np.abs(places) > (180.0, 90.0)).any():
        raise Unintelligible("a line must lie on the Earth")
    return places


def _numbers(bits: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the numbers of a text, which has five bits of a number in each character."""
    if ((bits < 0) | (bits >= 2 * _MORE)).any():
        raise Unintelligible("a line must be an encoded polyline")
    (ends,) = np.nonzero(bits < _MORE)
    if len(bits) and bits[-1] >= _MORE:
        raise Unintelligible("a line must end with a whole number")
    lengths = np.diff(ends, prepend=-1)
    if (lengths > _MOST_CHARACTERS).any():
        raise Unintelligible("a line must be of small numbers")
    begins = ends + 1 - lengths
    places = np.arange(len(bits)) - begins.repeat(lengths)
    shifted = (bits & (_MORE - 1)) << (_BITS * places)
    numbers = np.add.reduceat(shifted, begins) if len(begins) else shifted
    return np.where(numbers & 1, ~(numbers >> 1), numbers >> 1)
