"""Build JSON from parts: tours, objects with one more member, and long paths."""

from array import array
from collections.abc import Iterable
from itertools import accumulate, islice
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from service.coverage.frame import CoveragePath

PATH_PART = 2**14  # cells of a path that are written at once


def encode_tours(rows: list[dict[str, Any]]) -> tuple[bytes, bytes]:
    """Encode all tours at once; return their JSON, and the byte where each tour ends.

    This is faster than one by one. All members must be numbers, so that each brace ends a tour.
    """
    encoded = to_json(rows)[1:-1]
    ends = np.flatnonzero(np.frombuffer(encoded, np.uint8) == ord("}")) + 1
    return encoded, ends.astype(np.int64).tobytes()


def joined(tours: Iterable[bytes]) -> tuple[bytes, bytes]:
    """Join the JSON of tours; return it and where each tour ends in it."""
    each = list(tours)
    ends = accumulate(each, lambda end, tour: end + 1 + len(tour), initial=-1)
    return b",".join(each), array("q", islice(ends, 1, None)).tobytes()


def split(tours: bytes, ends: bytes) -> list[bytes]:
    """Split joined JSON at these ends into the JSON of each tour."""
    lasts = np.frombuffer(ends, np.int64).tolist()
    begins = [0, *(last + 1 for last in lasts)]
    return [tours[begin:last] for begin, last in zip(begins, lasts, strict=False)]


def with_member(encoded: bytes, name: bytes, value: bytes) -> bytes:
    """Return the JSON of an object that is not empty, with one more member at its end."""
    return b"".join((encoded[:-1], b',"', name, b'":', value, b"}"))


def encode_path(path: CoveragePath) -> bytes:
    """Return a path as JSON, written in parts: a list takes ten times the memory of its text."""
    parts = [path.cells[i : i + PATH_PART] for i in range(0, len(path.cells), PATH_PART)]
    members = [b'"cells":', *_encode_rows(parts), b',"metres":', to_json(path.metres)]
    if path.frame is not None:
        members += [b',"points":', *_encode_rows(map(path.frame.points, parts))]
    return b"".join((b"{", *members, b"}"))


def _encode_rows(parts: Iterable[NDArray[Any]]) -> tuple[bytes, bytes, bytes]:
    """Return a list of rows of numbers as JSON, from parts of them."""
    return b"[", b",".join(to_json(part.tolist())[1:-1] for part in parts), b"]"
