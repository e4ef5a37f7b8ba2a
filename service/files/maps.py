"""Read maps of robots as requests: a picture, maybe with its map.yaml of ROS and cost layers."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import PurePath
from typing import Any, NamedTuple

import numpy as np
from pydantic_core import to_json

from service.errors import Refusal
from service.files.reading import FileTooLarge, Reading, Request, Source, UnreadableFile
from service.objectives import MOST_OBJECTIVES
from service.requests.maps.fields import MapRequest
from service.requests.maps.pictures import UNKNOWN, darkness, read_picture
from service.requests.validation import parse_json

_CELL = 0.05  # metres: the usual cell size of robots' maps
_MOST_LAYERS = MOST_OBJECTIVES - 1
_OF_MESSAGE = ("occupancy_grid", "obstacle_from", "unknown")
_OTHER_PICTURES = {b"\xff\xd8\xff": "JPEG", b"GIF8": "GIF", b"RIFF": "WebP", b"BM": "BMP"}
_DIGITS = 3  # of a cost that is the shade of a pixel

Rows = Sequence[Sequence[float]]


class _Map(NamedTuple):
    """The members of a request that a map makes, and its unknown cells, if there are any."""

    request: Request
    unknown: list[list[int]] | None


def read_map(sources: Sequence[Source], tables: Sequence[tuple[Source, Rows]] = ()) -> Reading:
    """Return the request for the grid in a picture, or in a picture with its map.yaml.

    Tables are cost layers, and so are the pictures that the map.yaml does not name: each is an
    objective, which is named after its file.

    Args:
        sources: Pictures, and a map.yaml or none.
        tables: The costs of cells, row by row, with the files that they come from.

    Raises:
        UnreadableFile: There is not exactly one map, a file cannot be read, or a cost layer is not
            as large as the map.
    """
    pictures = [source for source in sources if not source.file.is_yaml]
    said = [source for source in sources if source.file.is_yaml]
    _refuse_other_pictures(pictures)
    if said:
        how, image = _interpretation(said[0])
        named = [each for each in pictures if each.file.name == image] or pictures
    else:
        how, named = {"cell_size": _CELL}, pictures
    if len(named) != 1 or len(said) > 1:
        demand = "a map is a picture, or a map.yaml and its picture: open both together"
        raise UnreadableFile(f"{sources[0].name}: {demand}, got {len(sources)} files")
    [picture] = named
    if not said:
        picture.note("cell-size", f"A cell is taken to be {_CELL} m wide, and dark to be blocked.")
    found = _map(picture.name, how, picture.file.data, picture.bounds.cells)
    shades = [(each, _shades(each)) for each in pictures if each is not picture]
    layers = _layers([*tables, *shades], found.request["grid"])
    everything = [*sources, *(source for source, _ in tables)]
    return Reading(
        "coverage",
        {**found.request, **layers},
        (said or [picture])[0].name,
        tuple(note for source in everything for note in source.notes),
        unknown_cells=found.unknown,
    )


def with_grid(reading: Reading, cells: int) -> Reading:
    """Return the reading with a grid in place of a message of ROS.

    Raises:
        UnreadableFile: The message is wrong or too large; the error names the file.
    """
    request = reading.request
    if "occupancy_grid" not in request:
        return reading
    said = {member: request[member] for member in _OF_MESSAGE if member in request}
    rest = {member: value for member, value in request.items() if member not in said}
    found = _map(reading.name, said, None, cells)
    return replace(reading, request={**rest, **found.request}, unknown_cells=found.unknown)


def _map(name: str, how: dict[str, Any], picture: bytes | None, cells: int) -> _Map:
    """Return the grid, cell size and origin of a map, and its unknown cells."""
    try:
        read, occupancy = parse_json(MapRequest, to_json(how)).with_occupancy(picture, cells)
    except Refusal as refusal:
        raise _unreadable(name, refusal) from None
    request: Request = {"grid": (read.grid > 0).astype(int).tolist(), "cell_size": read.cell_size}
    if read.origin:
        request["origin"] = read.origin
    unknown = None if occupancy is None else occupancy == UNKNOWN
    return _Map(request, None if unknown is None or not unknown.any() else _rows(unknown))


def _rows(mask: np.ndarray[Any, np.dtype[np.bool_]]) -> list[list[int]]:
    rows: list[list[int]] = mask.astype(int).tolist()
    return rows


def _unreadable(name: str, refusal: Refusal) -> UnreadableFile:
    kind = FileTooLarge if refusal.status == 413 else UnreadableFile
    return kind(f"{name}: {refusal.detail}")


def _refuse_other_pictures(pictures: Sequence[Source]) -> None:
    for picture in pictures:
        for begin, named in _OTHER_PICTURES.items():
            if picture.file.data.startswith(begin):
                demand = f"must be PNG or PGM, got {named}: save it as PNG, without loss"
                raise picture.refusal(demand)


def _shades(source: Source) -> Rows:
    """Return the costs in a picture, 0 where it is white to 1 where it is black."""
    try:
        channels = read_picture(source.file.data, source.bounds.cells)
    except Refusal as refusal:
        raise _unreadable(source.name, refusal) from None
    source.note("cost-layer", "Costs are read from its shades: white 0, black 1 for each metre.")
    costs: list[list[float]] = darkness(channels).round(_DIGITS).tolist()
    return costs


def _layers(layers: Sequence[tuple[Source, Rows]], grid: Rows) -> Request:
    """Return the member of a request that has these cost layers; none without layers."""
    if len(layers) > _MOST_LAYERS:
        demand = f"a map must have at most {_MOST_LAYERS} cost layers, got {len(layers)}"
        raise UnreadableFile(f"{layers[-1][0].name}: {demand}")
    for source, layer in layers:
        if (len(layer), len(layer[0])) != (len(grid), len(grid[0])):
            demand = f"must have {_size(grid)} costs, one for each cell of the map"
            raise source.refusal(f"{demand}, got {_size(layer)}")
    items = [{"name": PurePath(source.name).stem, "layer": layer} for source, layer in layers]
    return {"cost_layers": items} if items else {}


def _size(rows: Rows) -> str:
    return f"{len(rows)} x {len(rows[0])}"


def _interpretation(source: Source) -> tuple[dict[str, Any], str]:
    """Return what a map.yaml says about its picture, and the name of the picture."""
    from paretour.ros.maps import parse_ros_map

    try:
        members, image = parse_ros_map(source.file.data)  # the file that it names is not read
    except ValueError as error:
        came = " ".join(str(error).split())[:200]
        raise source.refusal(f"must be a map.yaml of ROS: {came}") from None
    return {**members}, PurePath(image).name
