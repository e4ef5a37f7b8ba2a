"""Files of TSPLIB (Reinelt, 1991): what one objective costs, from one city to another.

Of its kinds of distances two are read: EUC_2D, Euclidean and by definition rounded to the nearest
whole number, and EXPLICIT as a FULL_MATRIX.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_HEADINGS = ("NODE_COORD_SECTION", "EDGE_WEIGHT_SECTION", "DISPLAY_DATA_SECTION", "EOF")


class UnreadableFile(ValueError):
    """What is no such file, or of a kind that is not read."""


@dataclass(frozen=True)
class _File:
    """What a file says before its sections, and the numbers of each section."""

    facts: dict[str, str]
    sections: dict[str, list[str]]

    @property
    def kind(self) -> str:
        return self.facts.get("EDGE_WEIGHT_TYPE", "nothing")

    @property
    def dimension(self) -> int:
        given = self.facts.get("DIMENSION", "nothing")
        if not given.isdecimal():
            raise UnreadableFile(f"DIMENSION must be a whole number, got {given}")
        return int(given)


def coordinates(text: str) -> Array:
    """Where the cities of an EUC_2D file lie, shape (n, 2)."""
    file = _parsed(text)
    if file.kind != "EUC_2D":
        raise UnreadableFile(f"EDGE_WEIGHT_TYPE must be EUC_2D, got {file.kind}")
    return _numbers(file, "NODE_COORD_SECTION", (file.dimension, 3))[:, 1:]


def matrix(text: str) -> Array:
    """What it costs to go from each city to each other, shape (n, n)."""
    file = _parsed(text)
    if file.kind == "EUC_2D":
        cities = coordinates(text)
        distances = np.linalg.norm(cities[:, np.newaxis] - cities, axis=-1)
        return np.floor(distances + 0.5)
    way = file.facts.get("EDGE_WEIGHT_FORMAT", "nothing")
    if (file.kind, way) != ("EXPLICIT", "FULL_MATRIX"):
        raise UnreadableFile(
            "EDGE_WEIGHT_TYPE must be EUC_2D, or EXPLICIT with EDGE_WEIGHT_FORMAT FULL_MATRIX,"
            f" got {file.kind} with {way}"
        )
    return _numbers(file, "EDGE_WEIGHT_SECTION", (file.dimension, file.dimension))


def _parsed(text: str) -> _File:
    facts: dict[str, str] = {}
    sections: dict[str, list[str]] = {}
    numbers: list[str] | None = None  # of the section that a line is in
    for line in text.splitlines():
        if line.strip() in _HEADINGS:
            numbers = sections.setdefault(line.strip(), [])
        elif numbers is not None:
            numbers.extend(line.split())
        elif ":" in line:
            name, _, value = line.partition(":")
            facts[name.strip()] = value.strip()
    return _File(facts, sections)


def _numbers(file: _File, section: str, shape: tuple[int, int]) -> Array:
    words = file.sections.get(section, [])
    if len(words) != shape[0] * shape[1]:
        demand = f"{shape[0]} rows of {shape[1]} numbers, as DIMENSION says"
        raise UnreadableFile(f"{section} must have {demand}, got {len(words)} numbers")
    try:
        return np.array(words, dtype=np.float64).reshape(shape)
    except ValueError as error:
        raise UnreadableFile(f"{section} must hold numbers: {error}") from None
