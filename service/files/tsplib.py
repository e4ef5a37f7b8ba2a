"""Read files of TSPLIB (Reinelt, 1991) and CVRPLIB: keywords, sections and distances."""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain, takewhile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.files.reading import Source
from service.files.tables import number_in

Array = NDArray[np.float64]
_KEYWORD = re.compile(r"([A-Za-z][A-Za-z0-9_]*)[ \t]*(?:[:=](.*))?")
_IN_HEAD = re.compile(r"([A-Za-z][A-Za-z0-9_]*)(?:[ \t]*[:=]|[ \t])?(.*)")  # as LKH reads it
_COMMENT = re.compile(r"(^|[ \t]+)#.*")
_REPEATED = {"COMMENT"}  # in several lines
_KEYWORD_LINE = 8  # units of work
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
_PLANAR_KINDS = ("EUC", "CEIL", "FLOOR", "EXACT", "MAN", "MAX")
# The axes of places, by the kind of distance between them.
_AXES = {
    **dict.fromkeys((*(f"{each}_2D" for each in _PLANAR_KINDS), "GEO", "ATT"), 2),
    **dict.fromkeys((f"{each}_3D" for each in _PLANAR_KINDS), 3),
}
_PI = 3.141592  # as TSPLIB defines it
_EARTH = 6378.388  # kilometres, as TSPLIB defines it
_LARGEST = 1e150  # its square is still a float
_TELLING = ("EDGE_WEIGHT_TYPE", "NODE_COORD_SECTION", "EDGE_WEIGHT_SECTION", "EDGE_DATA_FORMAT")


@dataclass(frozen=True)
class TsplibFile:
    """The keywords of a file, and the words in each line of each section."""

    source: Source
    header: dict[str, str] = field(default_factory=dict)
    sections: dict[str, list[list[str]]] = field(default_factory=dict)

    @property
    def kind(self) -> str:
        """The kind of its distances."""
        return self.word("EDGE_WEIGHT_TYPE").upper()

    def word(self, keyword: str) -> str:
        """Return the first word of a keyword's value; comments may follow it."""
        return (self.header.get(keyword, "").split() or ["nothing"])[0]

    @cached_property
    def dimension(self) -> int:
        """The number of cities.

        Raises:
            UnreadableFile: It is missing, or over the bounds.
        """
        value = self.word("DIMENSION")
        if not re.fullmatch("[1-9][0-9]{0,8}", value):
            raise self.source.refusal("not-whole", "DIMENSION", came=value)
        self.source.check_count("cities", self.source.bounds.cities, int(value))
        return int(value)

    def words(self, section: str) -> list[str]:
        """Return the words of a section."""
        return list(chain.from_iterable(self.sections.get(section, ())))

    def listed(self, section: str) -> list[str]:
        """Return the words of a section that is a list, which -1 may end."""
        return list(takewhile(lambda word: word != "-1", self.words(section)))

    @cached_property
    def first_node(self) -> int:
        """The number of the first node: 1, or 0 where NODE_COORD_SECTION counts from 0."""
        numbers = self._nodes_of("NODE_COORD_SECTION")
        return 0 if numbers and set(numbers) == set(range(len(numbers))) else 1

    def _nodes_of(self, section: str) -> list[float | None]:
        """Return the numbers of nodes that begin the lines of a section."""
        return [number_in(line[0]) for line in self.sections.get(section, ()) if line]

    def of_nodes(self, section: str, columns: int) -> Array:
        """Return the numbers of each node in a section, by ascending numbers of the nodes.

        Raises:
            UnreadableFile: There is not one row for each node, with the number of the node first.
        """
        found = self.numbers(section, self.dimension, 1 + columns)
        order = self.order(found[:, 0])
        if order is None and self._nodes_of(section) == self._nodes_of("NODE_COORD_SECTION"):
            return found[:, 1:]  # of other numbers, which stand for their places in the file
        if order is None:
            first, last = self.first_node, self.first_node + self.dimension - 1
            raise self.source.refusal("row-each-node", section, first=first, last=last)
        return found[order, 1:]

    def order(self, nodes: Array) -> NDArray[np.intp] | None:
        """Return the order of rows by the numbers of their nodes; None if these do not count."""
        order = np.argsort(nodes, kind="stable")
        counted = np.arange(self.first_node, self.first_node + len(nodes))
        return order if np.array_equal(nodes[order], counted) else None

    def numbers(self, section: str, rows: int, columns: int) -> Array:
        """Return the numbers of a section in rows and columns."""
        words = self.words(section)
        if len(words) != rows * columns:
            demand = {"rows": rows, "columns": columns}
            raise self.source.refusal("numbers-of-rows", section, **demand, came=len(words))
        return self.parsed(section, words).reshape(rows, columns)

    def parsed(self, section: str, words: list[str]) -> Array:
        """Return words as numbers."""
        try:
            numbers = np.array(words, dtype=np.float64)
        except ValueError as error:
            raise self.source.refusal("no-numbers", section, reason=str(error)[:100]) from None
        if np.isnan(numbers).any():
            raise self.source.refusal("nan", section)
        return numbers


def is_tsplib(text: str) -> bool:
    """Return whether a line of a text begins with a keyword of TSPLIB."""
    flags = re.MULTILINE | re.IGNORECASE
    return any(re.search(rf"^[ \t]*{word}\b", text, flags) for word in _TELLING)


def split_tsplib(source: Source, text: str) -> TsplibFile:
    """Return the keywords and sections of a text. A section ends at the next keyword."""
    file = TsplibFile(source)
    lines: list[list[str]] | None = None  # the words in each line of the current section
    for line in map(str.strip, text.split("\n")):
        line = _COMMENT.sub("", line)
        keyword = _KEYWORD.fullmatch(line)
        if lines is None and keyword is None:
            keyword = _IN_HEAD.fullmatch(line)
        if keyword is None or keyword[1].casefold() in ("inf", "infinity", "nan"):
            if lines is not None and line:
                lines.append(line.split())
            continue
        file.source.spend(_KEYWORD_LINE)
        name, value = keyword[1].upper(), (keyword[2] or "").strip()
        if name == "EOF":
            break
        lines = [] if name.endswith("_SECTION") else None
        if lines is None:
            _add(file, file.header, name, value)
        else:
            _add(file, file.sections, name, lines)
            lines.extend([value.split()] if value else [])
    return file


def _add(file: TsplibFile, found: dict[str, Any], name: str, value: Any) -> None:
    """Add what stands at a keyword."""
    if name in found and name not in _REPEATED and (found[name] != value or value == []):
        raise file.source.refusal("keyword-twice", name[:60])
    found.setdefault(name, value)


def places(file: TsplibFile) -> Array:
    """Return the places of the cities, shape (n, 2 or 3), by their numbers if these count."""
    axes = _AXES.get(file.kind, 2)
    found = file.numbers("NODE_COORD_SECTION", file.dimension, 1 + axes)
    order = file.order(found[:, 0])
    return found[:, 1:] if order is None else found[order, 1:]


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
            raise file.source.refusal("numbers-too-large", "NODE_COORD_SECTION", most=_LARGEST)
        scale = _scale(file)
        return _distances(file.kind, found * scale) / scale
    if file.kind != "EXPLICIT":
        known = ", ".join(("EXPLICIT", *_AXES))
        raise file.source.refusal("not-known", "EDGE_WEIGHT_TYPE", known=known, came=file.kind)
    return _explicit(file)


def note_rounded(file: TsplibFile) -> None:
    """Note how distances are rounded, if they are."""
    if file.kind not in ("EXPLICIT", "EXACT_2D", "EXACT_3D"):
        scale = _scale(file)
        what = "whole numbers" if scale == 1 else f"rounded to 1/{scale:g}"
        file.source.note("rounded", f"Distances are {what}, as TSPLIB defines {file.kind}.")


def _scale(file: TsplibFile) -> float:
    """Return by what LKH multiplies places before distances are rounded: 10 keeps a decimal."""
    if "SCALE" not in file.header:
        return 1
    scale = number_in(file.word("SCALE"))
    if scale is None or scale < 1 or (scale != 1 and file.kind in ("GEO", "ATT")):
        raise file.source.refusal("wrong-scale", "SCALE", kind=file.kind, came=file.word("SCALE"))
    return scale


def _explicit(file: TsplibFile) -> Array:
    named = file.word("EDGE_WEIGHT_FORMAT").upper()
    if named == "NOTHING":
        named = "FULL_MATRIX"
    layout = _LAYOUTS.get(named)
    if layout is None:
        known = ", ".join(_LAYOUTS)
        raise file.source.refusal("not-known", "EDGE_WEIGHT_FORMAT", known=known, came=named)
    n, section = file.dimension, "EDGE_WEIGHT_SECTION"
    if layout == "full":
        return file.numbers(section, n, n)
    half, _, diagonal = layout.partition(" ")
    shift = 0 if diagonal else 1
    at = np.triu_indices(n, shift) if half == "upper" else np.tril_indices(n, -shift)
    words = file.words(section)
    if len(words) != len(at[0]):
        demand = {"numbers": len(at[0]), "format": named, "n": n}
        raise file.source.refusal("numbers-of-format", section, **demand, came=len(words))
    matrix = np.zeros((n, n))
    matrix[at] = file.parsed(section, words)
    matrix[at[1], at[0]] = matrix[at]
    return matrix


def plain(costs: Array) -> list[list[Any]]:
    """Return costs as rows for JSON: whole numbers as integers, None for a forbidden leg."""
    if np.isfinite(costs).all():
        whole = (costs == np.rint(costs)).all() and (np.abs(costs) < 2**53).all()
        return (costs.astype(np.int64) if whole else costs).tolist()
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
    "FLOOR": lambda apart: np.floor(_euclidean(apart)),
    "EXACT": _euclidean,
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
