"""Read files of TSPLIB (Reinelt, 1991) and CVRPLIB: keywords, sections and distances."""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.files.reading import Source

Array = NDArray[np.float64]
_KEYWORD = re.compile(r"([A-Za-z][A-Za-z0-9_]*)[ \t]*(?::(.*))?")
_LAYOUTS = {
    "FULL_MATRIX": "full",
    "UPPER_ROW": "upper",
    "LOWER_COL": "upper",
    "LOWER_ROW": "lower",
    "UPPER_COL": "lower",
    "UPPER_DIAG_ROW": "upper diagonal",
    "LOWER_DIAG_COL": "upper diagonal",
    "LOWER_DIAG_ROW": "lower diagonal",
    "UPPER_DIAG_COL": "lower diagonal",
}
# The axes of places, by the kind of distance between them.
_AXES = {
    **dict.fromkeys(("EUC_2D", "CEIL_2D", "MAN_2D", "MAX_2D", "GEO", "ATT"), 2),
    **dict.fromkeys(("EUC_3D", "MAN_3D", "MAX_3D"), 3),
}
_PI = 3.141592  # as TSPLIB defines it
_EARTH = 6378.388  # kilometres, as TSPLIB defines it
_LARGEST = 1e150  # its square is still a float
_TELLING = ("EDGE_WEIGHT_TYPE", "NODE_COORD_SECTION", "EDGE_WEIGHT_SECTION", "EDGE_DATA_FORMAT")
_NOT_PLANNED = {"SOP": "an order of cities", "HCP": "no costs", "TOUR": "a tour, and no costs"}


@dataclass(frozen=True)
class TsplibFile:
    """The keywords of a file, and the words of each section."""

    source: Source
    header: dict[str, str] = field(default_factory=dict)
    sections: dict[str, list[str]] = field(default_factory=dict)

    @property
    def kind(self) -> str:
        """The kind of its distances."""
        return self.word("EDGE_WEIGHT_TYPE").upper()

    def word(self, keyword: str) -> str:
        """Return the first word of a keyword's value; comments may follow it."""
        return (self.header.get(keyword, "").split() or ["nothing"])[0]

    @property
    def dimension(self) -> int:
        """The number of cities.

        Raises:
            UnreadableFile: It is missing, or over the bounds.
        """
        value = self.word("DIMENSION")
        if not re.fullmatch("[1-9][0-9]{0,8}", value):
            raise self.source.refusal("DIMENSION must be a whole number", value)
        self.source.check_count("cities", self.source.bounds.cities, int(value))
        return int(value)

    def numbers(self, section: str, rows: int, columns: int) -> Array:
        """Return the numbers of a section in rows and columns."""
        words = self.sections.get(section, [])
        if len(words) != rows * columns:
            demand = f"{rows} rows of {columns} numbers, as DIMENSION says"
            raise self.source.refusal(f"{section} must have {demand}, got {len(words)} numbers")
        return self.parsed(section, words).reshape(rows, columns)

    def parsed(self, section: str, words: list[str]) -> Array:
        """Return words as numbers."""
        try:
            numbers = np.array(words, dtype=np.float64)
        except ValueError as error:
            raise self.source.refusal(f"{section} must hold numbers: {str(error)[:100]}") from None
        if np.isnan(numbers).any():
            raise self.source.refusal(f"{section} must hold numbers, got nan")
        return numbers


def is_tsplib(text: str) -> bool:
    """Return whether a line of a text begins with a keyword of TSPLIB."""
    return any(re.search(rf"^[ \t]*{word}\b", text, re.MULTILINE) for word in _TELLING)


def split_tsplib(source: Source, text: str) -> TsplibFile:
    """Return the keywords and sections of a text. A section ends at the next keyword."""
    file = TsplibFile(source)
    _fill(file, text)
    kind = file.word("TYPE").upper()
    if kind in _NOT_PLANNED:
        raise source.refusal(f"TYPE must be TSP, ATSP or CVRP, got {kind}: {_NOT_PLANNED[kind]}")
    if file.sections.get("FIXED_EDGES_SECTION", ["-1"]) != ["-1"]:
        source.note("left-out", "FIXED_EDGES_SECTION was not used: tours may do without its edges.")
    return file


def _fill(file: TsplibFile, text: str) -> None:
    """Read the lines of a text into the keywords and sections of a file."""
    words: list[str] | None = None  # the words of the current section
    for line in text.splitlines():
        keyword = _KEYWORD.fullmatch(line.strip())
        if keyword is None or keyword[1].casefold() in ("inf", "infinity", "nan"):
            if words is not None:
                words.extend(line.split())
            continue
        name = keyword[1].upper()
        if name == "EOF":
            break
        words = file.sections.setdefault(name, []) if name.endswith("_SECTION") else None
        if words is None:
            file.header.setdefault(name, (keyword[2] or "").strip())
        elif keyword[2]:
            words.extend(keyword[2].split())


def places(file: TsplibFile) -> Array:
    """Return the places of the cities, shape (n, 2 or 3), in the order of the file."""
    axes = _AXES.get(file.kind, 2)
    return file.numbers("NODE_COORD_SECTION", file.dimension, 1 + axes)[:, 1:]


def costs(file: TsplibFile) -> Array:
    """Return the costs from each city to each, shape (n, n), as TSPLIB defines them.

    Raises:
        UnreadableFile: Their kind is not supported, or there are too many.
    """
    limit = file.source.bounds.matrix_cities
    file.source.check_count("cities whose costs are written out", limit, file.dimension)
    if file.kind in _AXES:
        found = places(file)
        if not (np.abs(found) <= _LARGEST).all():
            raise file.source.refusal(f"NODE_COORD_SECTION must hold numbers up to {_LARGEST:g}")
        return _distances(file.kind, found)
    if file.kind != "EXPLICIT":
        known = ", ".join(("EXPLICIT", *_AXES))
        raise file.source.refusal(f"EDGE_WEIGHT_TYPE must be one of {known}", file.kind)
    return _explicit(file)


def _explicit(file: TsplibFile) -> Array:
    named = file.word("EDGE_WEIGHT_FORMAT").upper()
    if named == "NOTHING":
        named = "FULL_MATRIX"
    layout = _LAYOUTS.get(named)
    if layout is None:
        known = ", ".join(_LAYOUTS)
        raise file.source.refusal(f"EDGE_WEIGHT_FORMAT must be one of {known}", named)
    n, section = file.dimension, "EDGE_WEIGHT_SECTION"
    if layout == "full":
        return file.numbers(section, n, n)
    half, _, diagonal = layout.partition(" ")
    shift = 0 if diagonal else 1
    at = np.triu_indices(n, shift) if half == "upper" else np.tril_indices(n, -shift)
    words = file.sections.get(section, [])
    if len(words) != len(at[0]):
        demand = f"{section} must have {len(at[0])} numbers, as {named} of DIMENSION {n}"
        raise file.source.refusal(f"{demand}, got {len(words)}")
    matrix = np.zeros((n, n))
    matrix[at] = file.parsed(section, words)
    matrix[at[1], at[0]] = matrix[at]
    return matrix


def plain(costs: Array) -> list[list[Any]]:
    """Return costs as rows for JSON: whole numbers as integers, None where there is no way."""
    if np.isfinite(costs).all():
        whole = (costs == np.rint(costs)).all() and (np.abs(costs) < 2**53).all()
        rows: list[list[Any]] = (costs.astype(np.int64) if whole else costs).tolist()
        return rows
    return [[cost if np.isfinite(cost) else None for cost in row] for row in costs.tolist()]


def _distances(kind: str, places: Array) -> Array:
    """Return the distance from each place to each, shape (n, n)."""
    if kind == "GEO":
        return _geo(places)
    apart = np.abs(places[:, np.newaxis] - places)
    return _PLANAR[kind.partition("_")[0]](apart)


def _nearest(lengths: Array) -> Array:
    return np.floor(lengths + 0.5)


def _euclidean(apart: Array) -> Array:
    return np.sqrt((apart**2).sum(axis=-1))


def _att(apart: Array) -> Array:
    """Return pseudo-Euclidean distances, which are never rounded down."""
    lengths = np.sqrt((apart**2).sum(axis=-1) / 10)
    rounded = _nearest(lengths)
    return rounded + (rounded < lengths)


_PLANAR: dict[str, Callable[[Array], Array]] = {
    "EUC": lambda apart: _nearest(_euclidean(apart)),
    "CEIL": lambda apart: np.ceil(_euclidean(apart)),
    "MAN": lambda apart: _nearest(apart.sum(axis=-1)),
    "MAX": lambda apart: _nearest(apart).max(axis=-1),
    "ATT": _att,
}


def _geo(places: Array) -> Array:
    """Return distances in whole kilometres on the earth, of latitudes and longitudes as DDD.MM."""
    degrees = np.trunc(places)  # TSPLIB says rounded, but the known optima are for this
    latitude, longitude = (_PI * (degrees + 5 * (places - degrees) / 3) / 180).T
    q1 = np.cos(longitude[:, np.newaxis] - longitude)
    q2 = np.cos(latitude[:, np.newaxis] - latitude)
    q3 = np.cos(latitude[:, np.newaxis] + latitude)
    cosine = np.clip(0.5 * ((1 + q1) * q2 - (1 - q1) * q3), -1, 1)
    lengths = np.floor(_EARTH * np.arccos(cosine) + 1)
    np.fill_diagonal(lengths, 0)
    return lengths
