"""Encoded polylines: lines of places as text (Google, Encoded Polyline Algorithm Format)."""

from collections.abc import Iterator

from service.roads.router import Line, Unintelligible

_BITS = 5  # of a number in each character
_MORE = 32  # set in all characters of a number but its last
_FIRST = 63  # the character of zero
_MOST_BITS = 32  # of a number: 360 degrees in 10^-6 have 29, and one for the sign


def decode_polyline(text: str, precision: int) -> Line:
    """Return the places of a line, longitude first.

    Args:
        text: The encoded line: latitude first, each place relative to the one before.
        precision: The decimals of a degree.

    Raises:
        Unintelligible: It is not such a text, or leaves the Earth.

    >>> decode_polyline("_p~iF~ps|U_ulLnnqC", 5)
    [(-120.2, 38.5), (-120.95, 40.7)]
    """
    line: Line = []
    latitude = longitude = 0
    numbers = _numbers(text)
    for step in numbers:
        latitude += step
        longitude += next(numbers, _MORE**_MOST_BITS)
        place = (longitude / 10**precision, latitude / 10**precision)
        if abs(place[0]) > 180 or abs(place[1]) > 90:
            raise Unintelligible("a line must be of whole places on the Earth")
        line.append(place)
    return line


def _numbers(text: str) -> Iterator[int]:
    """Yield the numbers: of each the sign in the lowest bit, then its bits five at a time."""
    number = shift = 0
    for character in text.encode():
        bits = character - _FIRST
        if not 0 <= bits < 2 * _MORE or shift > _MOST_BITS:
            raise Unintelligible("a line must be an encoded polyline")
        number |= (bits & (_MORE - 1)) << shift
        shift += _BITS
        if bits < _MORE:
            yield ~(number >> 1) if number & 1 else number >> 1
            number = shift = 0
    if shift:
        raise Unintelligible("a line must end with a whole number")
