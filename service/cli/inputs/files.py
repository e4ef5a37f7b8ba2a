"""Read the files that cities and maps come in, as members of a request."""

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from paretour import read_ros_map

from service.cli.errors import UnreadableFile
from service.cli.inputs.csv_tables import Ids, Table, parse_table
from service.cli.inputs.geojson import is_collection, read_stops
from service.cli.inputs.tsplib import parse_coordinates, parse_matrix

Array = NDArray[np.float64]
Request = dict[str, Any]
T = TypeVar("T")
STANDARD_INPUT = Path("-")
_TSPLIB = (".tsp", ".atsp")
_PNG = b"\x89PNG"
_PGM = (b"P5", b"P2")
_PICTURES = (".png", ".pgm")
_JSON = (".json", ".geojson")
_YAML = (".yaml", ".yml")


@dataclass(frozen=True)
class _Content:
    """What a file holds, and the suffix that says of which format it is."""

    suffix: str
    data: bytes

    @property
    def text(self) -> str:
        return self.data.decode()


def read_request(files: Sequence[Path], *, unrounded: bool = False) -> tuple[Request, Ids | None]:
    """Return the request in one file, or in two, with one objective each; and the cities' ids.

    One file is JSON, a request or its coordinates alone, or CSV, with four numbers for each city;
    or GeoJSON, a FeatureCollection of points, which are stops.
    Two files are CSV, with two columns for cities in a plane or else a matrix of costs; or they
    are TSPLIB's, which become matrices, or coordinates if `unrounded`. A file named - is standard
    input, JSON or CSV. Ids come from a column of CSV, and are None where there is none.

    Raises:
        UnreadableFile: A file is none of these; the message names it.
        OSError: There is no such file.
    """
    if len(files) == 1:
        return _read(files[0], _read_cities)
    if files[0] == files[1] == STANDARD_INPUT:
        raise UnreadableFile("standard input can be one of both files, not both")
    tables = [_read(file, lambda content: _read_objective(content, unrounded)) for file in files]
    first, second = (table.numbers for table in tables)
    if first.shape != second.shape:
        sizes = " and ".join("x".join(map(str, array.shape)) for array in (first, second))
        raise UnreadableFile(f"both files must have as many numbers, got {sizes}")
    if first.shape[1] == 2:
        return {"coordinates": np.concatenate((first, second), axis=1).tolist()}, _ids_of(*tables)
    return {"matrices": np.stack((first, second))}, _ids_of(*tables)


def read_map(path: Path) -> tuple[Request, bytes | None]:
    """Return the request in a JSON file, or what goes beside a picture, and the picture.

    A picture is a PNG or PGM file, or that of a map.yaml of ROS, which says how to read it. JSON
    may be a message nav_msgs/OccupancyGrid as well. Standard input, a file named -, is a picture or
    JSON.

    Raises:
        UnreadableFile: The file is none of these; the message names it.
        OSError: There is no such file.
    """
    if path.suffix in _YAML:
        return _read_yaml(path)
    content = _content(path)
    if content.suffix in _PICTURES:
        return {}, content.data
    request = _parsed(path, content, lambda content: _parse_json(content.text))
    if {"info", "data"} <= request.keys():
        return {"occupancy_grid": request}, None
    return request, None


def _read_yaml(path: Path) -> tuple[Request, bytes]:
    try:
        request, picture = read_ros_map(path)
    except ValueError as error:
        raise UnreadableFile(f"{path}: {error}") from None
    return {**request}, picture


def read_object(path: Path) -> Request:
    """Return the members of a request in a JSON file, or in standard input for a file named -.

    Raises:
        UnreadableFile: The file is no JSON object; the message names it.
        OSError: There is no such file.
    """
    return _read(path, lambda content: _parse_json(content.text))


def read_layer(path: Path) -> Array:
    """Return the costs on a map in a CSV file, a row for each row of its cells.

    Raises:
        UnreadableFile: The file is no table of numbers; the message names it.
        OSError: There is no such file.
    """
    return _read(path, _read_layer)


def _content(path: Path) -> _Content:
    """Return what a file holds, or standard input, whose format is told by its first bytes."""
    if path != STANDARD_INPUT:
        return _Content(path.suffix, path.read_bytes())
    data = sys.stdin.buffer.read()
    if data.startswith((_PNG, *_PGM)):
        return _Content(".png" if data.startswith(_PNG) else ".pgm", data)
    return _Content(".json" if data.lstrip()[:1] in (b"{", b"[") else ".csv", data)


def _read(path: Path, read: Callable[[_Content], T]) -> T:
    """Return what a function reads from a file, with the file's name in its errors."""
    return _parsed(path, _content(path), read)


def _parsed(path: Path, content: _Content, parse: Callable[[_Content], T]) -> T:
    """Return what a function parses from the content of a file, with its name in the errors."""
    try:
        return parse(content)
    except (UnreadableFile, UnicodeDecodeError) as error:
        name = "standard input" if path == STANDARD_INPUT else path
        raise UnreadableFile(f"{name}: {error}") from None


def _read_cities(content: _Content) -> tuple[Request, Ids | None]:
    """Return the request in a file that holds both objectives, and the cities' ids."""
    if content.suffix in _TSPLIB:
        raise UnreadableFile("a file of TSPLIB is one objective: name another for the other one")
    if content.suffix in _JSON:
        request = _parse_json(content.text)
        return read_stops(request) if is_collection(request) else (request, None)
    table = parse_table(content.text)
    columns = table.numbers.shape[1]
    if columns != 4:
        raise UnreadableFile(f"must have 4 columns, x and y in either plane, got {columns}")
    return {"coordinates": table.numbers.tolist()}, table.ids


def _parse_json(text: str) -> Request:
    """Return the request that a text is, or whose coordinates it is."""
    try:
        value = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise UnreadableFile(f"must be JSON: {error}") from None
    if isinstance(value, list):
        return {"coordinates": value}
    if isinstance(value, dict):
        return value
    raise UnreadableFile("must be a request, an object, or its coordinates, a list")


def _read_objective(content: _Content, unrounded: bool) -> Table:
    """Return the cities in a plane, shape (n, 2), or the costs between them, shape (n, n)."""
    if content.suffix in _TSPLIB:
        return Table((parse_coordinates if unrounded else parse_matrix)(content.text))
    table = parse_table(content.text)
    rows, columns = table.numbers.shape
    if columns not in (2, rows):
        demand = "must have 2 columns, x and y, or as many as rows"
        raise UnreadableFile(f"{demand}, got {rows} rows of {columns}")
    return table


def _read_layer(content: _Content) -> Array:
    table = parse_table(content.text)
    if table.ids is not None:
        raise UnreadableFile("must hold numbers alone, got a column of ids")
    return table.numbers


def _ids_of(first: Table, second: Table) -> Ids | None:
    """Return the ids of the cities in two tables.

    Raises:
        UnreadableFile: Both have ids, and not the same ones.
    """
    if first.ids and second.ids and first.ids != second.ids:
        raise UnreadableFile("both files must have the same ids, in the same order")
    return first.ids or second.ids
