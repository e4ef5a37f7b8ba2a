"""Read maps as requests: a picture, maybe with its map.yaml of ROS, or MovingAI; cost layers."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import PurePath
from typing import Any, NamedTuple, cast

import numpy as np
from paretour.member_parts import LayerRequest
from paretour.members import CoverageRequest
from pydantic_core import to_json

from service.errors import Fault, Refusal
from service.files.maps.layers import Rows, check_size_of_layer, costs_of_cells, names_of_layers
from service.files.maps.octile import is_octile, read_octile
from service.files.reading import FileTooLarge, Reading, Source, UnreadableFile, quoted
from service.files.tables import Table
from service.objectives import MOST_OBJECTIVES
from service.requests.maps.fields import MapRequest
from service.requests.maps.pictures import UNKNOWN, read_darkness
from service.requests.validation import parse_json

_CELL = 0.05  # metres: the usual cell size of robots' maps
_OCTILE_CELL = 1.0  # metres: maps of games have no size
_MOST_LAYERS = MOST_OBJECTIVES - 1
_OF_MESSAGE = ("occupancy_grid", "obstacle_from", "unknown")
_OTHER_PICTURES = {b"\xff\xd8\xff": "JPEG", b"GIF8": "GIF", b"RIFF": "WebP", b"BM": "BMP"}
_BITS = 8  # of most pictures' pixels
_DIGITS, _DEEP_DIGITS = 3, 5  # of a cost that is the shade of a pixel of 8 or 16 bits


class _Map(NamedTuple):
    """The grid of a map, the members of a request, and unknown cells, if there are any."""

    grid: Rows
    request: CoverageRequest
    unknown: list[list[int]] | None


def read_map(sources: Sequence[Source], tables: Sequence[tuple[Source, Table]] = ()) -> Reading:
    """Return the request for the grid in a picture, maybe with its map.yaml, or of MovingAI.

    Tables are cost layers, and so are all further pictures: each is an objective, which is named
    after its file.

    Args:
        sources: Pictures, and a map.yaml or none; or a map of MovingAI, and pictures.
        tables: The costs of cells, row by row, with the files that they come from.

    Raises:
        UnreadableFile: There is not exactly one map, a file cannot be read, or a cost layer is not
            as large as the map.
    """
    grids = [source for source in sources if is_octile(source.file.data)]
    pictures = [each for each in sources if not each.file.is_yaml and each not in grids]
    _refuse_other_pictures(pictures)
    if grids:
        main, found = _octile_map(grids, sources)
    else:
        main, picture, found = _pictured_map(pictures, sources)
        pictures = [each for each in pictures if each is not picture]
    grid = found.grid
    layers = [(source, costs_of_cells(source, table, grid)) for source, table in tables]
    layers += [(each, _shades(each)) for each in pictures]
    everything = [*sources, *(source for source, _ in tables)]
    if named := _layers(layers, grid):
        found.request["cost_layers"] = named
    return Reading(
        "coverage",
        found.request,
        main.name,
        tuple(note for source in everything for note in source.notes),
        unknown_cells=found.unknown,
    )


def _octile_map(grids: Sequence[Source], sources: Sequence[Source]) -> tuple[Source, _Map]:
    """Return the map of MovingAI, and its file."""
    others = [source for source in sources if source.file.is_yaml]
    if len(grids) > 1 or others:
        names = " and as ".join(each.name for each in [*grids, *others])
        raise sources[0].refusal("grid-twice", "a map", given=names)
    [source] = grids
    source.note("cell-size", f"A cell is taken to be {_OCTILE_CELL:g} m wide; water is blocked.")
    grid = read_octile(source)
    return source, _Map(grid, {"grid": grid, "cell_size": _OCTILE_CELL}, None)


def _pictured_map(
    pictures: Sequence[Source], sources: Sequence[Source]
) -> tuple[Source, Source, _Map]:
    """Return the map in a picture after the file that it is named after, and the picture."""
    said = [source for source in sources if source.file.is_yaml]
    if len(said) > 1:
        raise _second_yaml(said)
    how, named = {"cell_size": _CELL}, pictures
    if said:
        how, image = _interpretation(said[0])
        named = [each for each in pictures if each.file.name == image] or pictures
    if len(named) != 1:
        raise sources[0].refusal("no-map", "a map", came=len(sources))
    [picture] = named
    if not said:
        picture.note("cell-size", f"A cell is taken to be {_CELL} m wide, and dark to be blocked.")
    elif picture.file.name != image:
        picture.note("picture", f"It is taken for the map, which map.yaml calls {quoted(image)}.")
    found = _map(picture.name, how, picture.file.data, picture.bounds.cells)
    return (said or [picture])[0], picture, found


def _second_yaml(said: Sequence[Source]) -> UnreadableFile:
    """Return the exception for a second map.yaml, such as that of a mask of Nav2.

    What a mask means, and so whether its cells are costs, is said by the filter that uses it.
    """
    read = [(*_interpretation(each), each) for each in said]
    # Of Nav2's own files the map is in mode trinary, and masks are in mode scale or raw.
    (_, map_image, main), (_, image, other), *_ = sorted(
        read, key=lambda each: each[0]["mode"] != "trinary"
    )
    named = {"given": main.name, "mask": image, "name": other.name, "map": map_image}
    return other.refusal("second-map", "a map", **named)


def with_grid(reading: Reading, cells: int) -> Reading:
    """Return the reading with a grid in place of a message of ROS.

    Raises:
        UnreadableFile: The message is wrong or too large; the error names the file.
    """
    request: Mapping[str, Any] = reading.request
    if "occupancy_grid" not in request:
        return reading
    said = {member: request[member] for member in _OF_MESSAGE if member in request}
    rest = {member: value for member, value in request.items() if member not in said}
    found = _map(reading.name, said, None, cells)
    whole = cast(CoverageRequest, {**rest, **found.request})
    return replace(reading, request=whole, unknown_cells=found.unknown)


def _map(name: str, how: dict[str, Any], picture: bytes | None, cells: int) -> _Map:
    """Return the grid, cell size and origin of a map, and its unknown cells."""
    try:
        read, occupancy = parse_json(MapRequest, to_json(how)).with_occupancy(picture, cells)
    except Refusal as refusal:
        raise _unreadable(name, refusal) from None
    grid: Rows = (read.grid > 0).astype(int).tolist()
    request: CoverageRequest = {"grid": grid, "cell_size": read.cell_size}
    if read.origin:
        request["origin"] = read.origin
    unknown = None if occupancy is None else occupancy == UNKNOWN
    return _Map(grid, request, None if unknown is None or not unknown.any() else _rows(unknown))


def _rows(mask: np.ndarray[Any, np.dtype[np.bool_]]) -> list[list[int]]:
    return mask.astype(int).tolist()


def _unreadable(name: str, refusal: Refusal) -> UnreadableFile:
    """Return the exception for a file, given the refusal of the request made from it."""
    kind = FileTooLarge if refusal.status == 413 else UnreadableFile
    return kind(*(_of_file(name, fault) for fault in refusal.errors))


def _of_file(name: str, fault: Fault) -> Fault:
    """Return a fault of a request as that of the file which is its grid."""
    part = f"{name}:" if fault.part == "grid" else f"{name}: {fault.part}"
    return replace(fault, part=part, pointer=None, values={"file": name, **fault.values})


def _refuse_other_pictures(pictures: Sequence[Source]) -> None:
    for picture in pictures:
        for begin, named in _OTHER_PICTURES.items():
            if picture.file.data.startswith(begin):
                given = f"{named}: save it as PNG, without loss"
                raise picture.refusal("another-format", wanted="PNG or PGM", given=given)


def _shades(source: Source) -> Rows:
    """Return the costs in a picture, 0 where it is white to 1 where it is black."""
    try:
        shades, bits = read_darkness(source.file.data, source.bounds.cells)
    except Refusal as refusal:
        raise _unreadable(source.name, refusal) from None
    deep = "" if bits == _BITS else f" Of {bits} bits, white is {2**bits - 1} and black 0."
    sentence = f"Costs are read from its shades: white 0, black 1 for each metre.{deep}"
    source.note("cost-layer", sentence)
    return shades.round(_DIGITS if bits == _BITS else _DEEP_DIGITS).tolist()


def _layers(layers: Sequence[tuple[Source, Rows]], grid: Rows) -> list[LayerRequest]:
    """Return these cost layers, each with its name."""
    if len(layers) > _MOST_LAYERS:
        counts = {"limit": _MOST_LAYERS, "actual": len(layers)}
        raise layers[-1][0].refusal("too-many", "a map", noun="cost layers", **counts)
    for source, layer in layers:
        check_size_of_layer(source, layer, grid)
    names = names_of_layers([PurePath(source.name).stem for source, _ in layers])
    named = zip(names, layers, strict=True)
    return [{"name": name, "layer": layer} for name, (_, layer) in named]


def _interpretation(source: Source) -> tuple[dict[str, Any], str]:
    """Return what a map.yaml says about its picture, and the name of the picture."""
    from paretour.ros.maps import parse_ros_map

    try:
        members, image = parse_ros_map(source.file.data)  # the file that it names is not read
    except ValueError as error:
        came = " ".join(str(error).split())[:200]
        raise source.refusal("no-map-yaml", reason=came) from None
    return {**members}, PurePath(image).name
