"""Read maps of robots as requests: a picture alone, or with its map.yaml of ROS."""

from collections.abc import Sequence
from typing import Any

from pydantic_core import to_json

from service.errors import Refusal
from service.files.reading import FileTooLarge, Reading, Request, Source, UnreadableFile
from service.requests.maps.fields import MapRequest
from service.requests.validation import parse_json

_CELL = 0.05  # metres: the usual cell size of robots' maps
_OF_MESSAGE = ("occupancy_grid", "obstacle_from", "unknown")
_OTHER_PICTURES = {b"\xff\xd8\xff": "JPEG", b"GIF8": "GIF", b"RIFF": "WebP", b"BM": "BMP"}


def read_map(sources: Sequence[Source]) -> Reading:
    """Return the request for the grid in a picture, or in a picture with its map.yaml.

    Raises:
        UnreadableFile: There is not exactly one picture, or a file cannot be read.
    """
    pictures = [source for source in sources if not source.file.is_yaml]
    said = [source for source in sources if source.file.is_yaml]
    if len(pictures) != 1 or len(said) > 1:
        demand = "a map is a picture, or a map.yaml and its picture: open both together"
        raise UnreadableFile(f"{sources[0].name}: {demand}, got {len(sources)} files")
    [picture] = pictures
    for begin, named in _OTHER_PICTURES.items():
        if picture.file.data.startswith(begin):
            raise picture.refusal(f"must be PNG or PGM, got {named}: save it as PNG, without loss")
    if said:
        how = _interpretation(said[0])
    else:
        how = {"cell_size": _CELL}
        picture.note("cell-size", f"A cell is taken to be {_CELL} m wide, and dark to be blocked.")
    request = _grid(picture.name, how, picture.file.data, picture.bounds.cells)
    notes = tuple(note for source in sources for note in source.notes)
    return Reading("coverage", request, (said or pictures)[0].name, notes)


def with_grid(name: str, request: Request, cells: int) -> Request:
    """Return the request with a grid in place of a message of ROS.

    Raises:
        UnreadableFile: The message is wrong or too large; the error names the file.
    """
    if "occupancy_grid" not in request:
        return request
    said = {member: request[member] for member in _OF_MESSAGE if member in request}
    rest = {member: value for member, value in request.items() if member not in said}
    return {**rest, **_grid(name, said, None, cells)}


def _grid(name: str, how: dict[str, Any], picture: bytes | None, cells: int) -> Request:
    """Return the grid, cell size and origin of a map."""
    try:
        read = parse_json(MapRequest, to_json(how)).with_map(picture, cells)
    except Refusal as refusal:
        kind = FileTooLarge if refusal.status == 413 else UnreadableFile
        raise kind(f"{name}: {refusal.detail}") from None
    request: Request = {"grid": (read.grid > 0).astype(int).tolist(), "cell_size": read.cell_size}
    if read.origin:
        request["origin"] = read.origin
    return request


def _interpretation(source: Source) -> dict[str, Any]:
    """Return what a map.yaml says about the picture that came with it."""
    from paretour.ros.maps import parse_ros_map

    try:
        members, _ = parse_ros_map(source.file.data)  # the file that it names is not read
    except ValueError as error:
        came = " ".join(str(error).split())[:200]
        raise source.refusal(f"must be a map.yaml of ROS: {came}") from None
    return {**members}
