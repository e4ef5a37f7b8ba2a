"""Read the files given to a command, and print what was assumed about them."""

import os
import stat
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray
from paretour import FrontOfAnyKind, UnexpectedAnswer, read_ros_map
from paretour.expect import parse_json
from paretour.kinds import parse_any

from service.cli.errors import UsageError
from service.cli.notes import print_file_notes
from service.files.json_files.reader import read_object as object_in
from service.files.reader import read_files, read_table
from service.files.reading import Bounds, Kind, NamedFile, Source, check_cells
from service.files.stop_tables import numbers_of

Array = NDArray[np.float64]
Ids = tuple[str, ...]
STANDARD_INPUT = Path("-")
_MOST_BYTES = 2**28  # in a file
_MATRIX_CITIES = 3000  # the most cities with a matrix here; the service may allow fewer


class FileRequest(NamedTuple):
    """The request in files.

    Attributes:
        request: Its members.
        ids: The ids of its stops; None if it has none.
        kind: The kind of plan that it asks for.
        picture: The picture of its map, PNG or PGM, if it has one.
    """

    request: dict[str, Any]
    ids: Ids | None
    kind: Kind
    picture: bytes | None = None


def read_request(
    paths: Sequence[Path | None], *kinds: Kind, unrounded: bool = False
) -> FileRequest:
    """Return the request in one file, in one for each objective, or in stops and vehicles.

    A map is a PNG or PGM file, or a map.yaml of ROS, which names its picture and says how to read
    it; or JSON, a request or a message nav_msgs/OccupancyGrid. Notes on what was assumed go to
    stderr. A file named - is standard input.

    Args:
        paths: The files; None is left out.
        kinds: The kinds of plan that they may ask for. JSON that does not show its kind is taken
            for the first of them.
        unrounded: Whether EUC_2D of TSPLIB means planes, not rounded distances.

    Raises:
        UnreadableFile: A file cannot be read; the message names it.
        UsageError: The file is for another command, or cannot be read in one pass.
        OSError: The file does not exist.
    """
    files = [path for path in paths if path is not None]
    check_inputs(*files)
    is_map = "coverage" in kinds and len(files) == 1
    if is_map and NamedFile(files[0].name, b"").is_yaml:
        try:
            members, picture = read_ros_map(files[0])
        except ValueError as error:
            raise UsageError(f"{files[0]}: {error}") from None
        return FileRequest({**members}, None, "coverage", picture)
    contents = [_content(path) for path in files]
    if is_map and contents[0].is_picture:
        return FileRequest({}, None, "coverage", contents[0].data)
    reading = read_files(contents, _bounds(), wanted=kinds[0], unrounded=unrounded)
    print_file_notes(reading.notes)
    if reading.kind not in kinds:
        noun = {"front": "one tour", "fleet": "vehicles", "coverage": "a map"}[reading.kind]
        raise UsageError(f"{reading.name} is about {noun}: `paretour {reading.kind}` plans that")
    request: dict[str, Any] = {**reading.request}
    if "matrices" in request:
        request["matrices"] = _as_arrays(request["matrices"])
    return FileRequest(request, ids_in(request.get("stops")), reading.kind)


def check_inputs(*files: Path | None) -> None:
    """Raise UsageError if several files are standard input, which can be read once."""
    if files.count(STANDARD_INPUT) > 1:
        raise UsageError("only one of the files can be standard input")


def ids_in(stops: object) -> Ids | None:
    """Return the id of each stop of a request or an answer; None if a stop has no id."""
    if not isinstance(stops, list):
        return None
    ids = [stop.get("id") if isinstance(stop, dict) else None for stop in stops]
    return tuple(map(str, ids)) if all(isinstance(each, str) for each in ids) else None


def read_object(path: Path) -> dict[str, Any]:
    """Return the members of a request in a JSON file, or in standard input for a file named -.

    Raises:
        UnreadableFile: The file is not a JSON object; the message names it.
        OSError: The file does not exist.
    """
    return object_in(Source(_content(path), _bounds()))


def read_front(path: Path) -> FrontOfAnyKind:
    """Return the front in a JSON file, or in standard input for a file named -.

    Raises:
        UsageError: The file is not an answer of the service; the message names it.
        OSError: The file does not exist.
    """
    content = _content(path)
    try:
        return parse_any(parse_json(content.data, content.name).document)
    except UnexpectedAnswer as error:
        demand = f"{content.name} must be a front, as `paretour front FILE --json` prints it"
        raise UsageError(f"{demand}: {error}") from None


def read_layer(path: Path) -> Array:
    """Return the costs on a map in a CSV file, a row for each row of its cells.

    Raises:
        UnreadableFile: The file is not a table of numbers; the message names it.
        OSError: The file does not exist.
    """
    source, table = read_table(_content(path), _bounds())
    costs = numbers_of(source, table)
    check_cells([source])
    return np.array(costs)


def _bounds() -> Bounds:
    from service.cli.configuration import load_settings

    limits = load_settings().limits
    return Bounds(matrix_cities=_MATRIX_CITIES, roads=limits.roads, profiles=limits.profiles)


def _content(path: Path) -> NamedFile:
    if path == STANDARD_INPUT:
        return NamedFile("standard input", _bounded(sys.stdin.buffer, "standard input"))
    with open(path, "rb", opener=_without_waiting) as file:
        piped = stat.S_ISFIFO(os.fstat(file.fileno()).st_mode)
        begin = file.raw.read(1) if piped else b""  # None if no program has written yet
        if piped and begin == b"":
            raise UsageError(f"{path}: must be a file, or a pipe that a program writes into")
        os.set_blocking(file.fileno(), True)
        return NamedFile(str(path), (begin or b"") + _bounded(file, str(path)))


def _without_waiting(path: str, flags: int) -> int:
    """Open a file; do not wait for a program to open the other end of a pipe."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def _bounded(file: BinaryIO, name: str) -> bytes:
    data = file.read(_MOST_BYTES + 1)
    if len(data) > _MOST_BYTES:
        raise UsageError(f"{name} must have at most {_MOST_BYTES} bytes, got more")
    return data


def _as_arrays(matrices: object) -> object:
    """Return matrices as an array, which is sent as a file, if it can hold all their costs."""
    try:
        array = np.array(matrices, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return matrices  # they have null in them, or values that the service refuses
    return array if array.ndim == 3 and np.isfinite(array).all() else matrices
