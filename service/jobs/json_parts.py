"""JSON written from parts: objects that get a member more, and paths, which are long."""

from collections.abc import Iterable
from typing import Any

from numpy.typing import NDArray
from pydantic_core import to_json

from service.coverage.survey import CoveragePath

PATH_PART = 2**14  # cells of a path that are written at once


def with_member(encoded: bytes, name: bytes, value: bytes) -> bytes:
    """Return the JSON of an object, not an empty one, with one member more, last."""
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
