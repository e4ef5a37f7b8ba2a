"""Parse files of TSPLIB (Reinelt, 1991): the costs of one objective from city to city.

Two of its kinds of distances are supported: EUC_2D, Euclidean and by definition rounded to the
nearest whole number, and EXPLICIT as a FULL_MATRIX.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.cli.errors import UnreadableFile

Array = NDArray[np.float64]
_SECTIONS = ("NODE_COORD_SECTION", "EDGE_WEIGHT_SECTION", "DISPLAY_DATA_SECTION", "EOF")


@dataclass(frozen=True)
class _TsplibFile:
    """The header of a file, and the words of each section."""

    header: dict[str, str]
    sections: dict[str, list[str]]

    @property
    def kind(self) -> str:
        return self.header.get("EDGE_WEIGHT_TYPE", "nothing")

    @property
    def dimension(self) -> int:
        value = self.header.get("DIMENSION", "nothing")
        if not value.isdecimal():
            raise UnreadableFile(f"DIMENSION must be a whole number, got {value}")
        return int(value)


def parse_coordinates(text: str) -> Array:
    """Return the coordinates of the cities in an EUC_2D file, shape (n, 2).

    Raises:
        UnreadableFile: It is no such file.
    """
    file = _split(text)
    if file.kind != "EUC_2D":
        raise UnreadableFile(f"EDGE_WEIGHT_TYPE must be EUC_2D, got {file.kind}")
    return _numbers(file, "NODE_COORD_SECTION", (file.dimension, 3))[:, 1:]


def parse_matrix(text: str) -> Array:
    """Return the costs from each city to each other one, shape (n, n).

    Raises:
        UnreadableFile: It is no file of a supported kind.
    """
    file = _split(text)
    if file.kind == "EUC_2D":
        cities = parse_coordinates(text)
        distances = np.linalg.norm(cities[:, np.newaxis] - cities, axis=-1)
        return np.floor(distances + 0.5)
    layout = file.header.get("EDGE_WEIGHT_FORMAT", "nothing")
    if (file.kind, layout) != ("EXPLICIT", "FULL_MATRIX"):
        raise UnreadableFile(
            "EDGE_WEIGHT_TYPE must be EUC_2D, or EXPLICIT with EDGE_WEIGHT_FORMAT FULL_MATRIX,"
            f" got {file.kind} with {layout}"
        )
    return _numbers(file, "EDGE_WEIGHT_SECTION", (file.dimension, file.dimension))


def _split(text: str) -> _TsplibFile:
    header: dict[str, str] = {}
    sections: dict[str, list[str]] = {}
    words: list[str] | None = None  # of the section that a line is in
    for line in text.splitlines():
        if line.strip() in _SECTIONS:
            words = sections.setdefault(line.strip(), [])
        elif words is not None:
            words.extend(line.split())
        elif ":" in line:
            name, _, value = line.partition(":")
            header[name.strip()] = value.strip()
    return _TsplibFile(header, sections)


def _numbers(file: _TsplibFile, section: str, shape: tuple[int, int]) -> Array:
    """Return the numbers of a section in rows and columns."""
    words = file.sections.get(section, [])
    if len(words) != shape[0] * shape[1]:
        demand = f"{shape[0]} rows of {shape[1]} numbers, as DIMENSION says"
        raise UnreadableFile(f"{section} must have {demand}, got {len(words)} numbers")
    try:
        return np.array(words, dtype=np.float64).reshape(shape)
    except ValueError as error:
        raise UnreadableFile(f"{section} must hold numbers: {error}") from None
