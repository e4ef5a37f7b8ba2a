"""The occupancy of the cells of a map, from the shades of its picture.

The modes trinary, scale and raw are those of the map_server of ROS, as wiki.ros.org/map_server
documents them. Two things are safer here: grey 205, which its map_saver writes for unknown cells,
is never free, though the free_thresh of 0.25 that Nav2 writes beside it would make it so; and a
transparent pixel is unknown in mode trinary, too.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from service.errors import invalid
from service.requests.maps.pgm import SIGNATURES as PGM_SIGNATURES
from service.requests.maps.pgm import read_pgm
from service.requests.maps.png import SIGNATURE as PNG_SIGNATURE
from service.requests.maps.png import read_png

Mode = Literal["trinary", "scale", "raw"]
Channels = NDArray[np.uint8]  # (rows, columns, channels)
Shades = NDArray[np.float64]  # (rows, columns), black 0 to white 255
Occupancy = NDArray[np.int8]  # (rows, columns), free 0 to occupied 100

UNKNOWN = -1
_OCCUPIED = 100
_WHITE = 255
_DEEP_WHITE = 65_535  # of pictures with 16 bits a pixel
_UNKNOWN_GREY = 205
_SCALE = 99  # occupancy in mode scale goes from 0 up to this, between the thresholds
_LUMA = (19595, 38470, 7471)  # weights of red, green and blue (ITU-R BT.601), of 2 ** 16


@dataclass(frozen=True, kw_only=True)
class Interpretation:
    """Which shades are free, occupied or unknown.

    The darkness of a pixel is 0 where it is white and 1 where it is black; `negate` swaps the two.

    Args:
        mode: A mode of map_server. Without one every shade that is not occupied is free, except
            grey 205; a colour is as bright as it looks, and transparency is ignored.
        negate: Whether black is free and white is occupied.
        occupied_thresh: A darker pixel is occupied.
        free_thresh: A lighter pixel is free. It is ignored without a mode.
    """

    mode: Mode | None = None
    negate: bool = False
    occupied_thresh: float = 0.5
    free_thresh: float = 0.5


def read_picture(content: bytes, most_cells: int) -> Channels:
    """Return the channels of a PNG or PGM file: grey or colours, and maybe alpha.

    Of a picture with 16 bits a pixel, they are scaled to 8.

    Raises:
        Refusal: The file is neither, cannot be read, or has too many cells.
    """
    return _of_bytes(_read(content, most_cells))


def read_darkness(content: bytes, most_cells: int) -> tuple[Shades, int]:
    """Return how dark each pixel of a PNG or PGM file looks, and its bits for each channel.

    White is 0 and black is 1; transparency is ignored.

    Raises:
        Refusal: The file is neither, cannot be read, or has too many cells.
    """
    channels = _read(content, most_cells)
    if channels.dtype == np.uint16:
        return (_DEEP_WHITE - channels[:, :, 0].astype(np.float64)) / _DEEP_WHITE, 16
    return (_WHITE - _luma(_of_bytes(channels))) / _WHITE, 8


def _of_bytes(channels: Channels | NDArray[np.uint16]) -> Channels:
    """Return channels of 8 bits; those of 16 are scaled."""
    if channels.dtype == np.uint8:
        return channels.astype(np.uint8, copy=False)
    return np.rint(channels / _DEEP_WHITE * _WHITE).astype(np.uint8)


def _read(content: bytes, most_cells: int) -> Channels | NDArray[np.uint16]:
    if content.startswith(PNG_SIGNATURE):
        return read_png(content, most_cells)
    if content.startswith(PGM_SIGNATURES):
        return read_pgm(content, most_cells)[:, :, np.newaxis]
    raise invalid("grid", "not-a-picture")


def occupancy(channels: Channels, how: Interpretation) -> Occupancy:
    """Return the occupancy of each cell, 0 to 100, or UNKNOWN, of a picture with these channels."""
    if how.mode is None:
        shades = _luma(channels)
        return _trinary(shades, how, free_thresh=np.inf)
    colours, alpha = _split(channels)
    shades = colours.mean(axis=2)
    if how.mode == "raw":
        return np.where(shades <= _OCCUPIED, shades.round(), UNKNOWN).astype(np.int8)
    values = _trinary(shades, how, how.free_thresh)
    if how.mode == "scale":
        values = _scale(shades, how)
    values[alpha < _WHITE] = UNKNOWN
    return values


def _split(channels: Channels) -> tuple[Channels, Channels]:
    """Return the grey or the colours, and the alpha, shape (rows, columns), of a picture."""
    count = channels.shape[2]
    if count in (2, 4):
        return channels[:, :, :-1], channels[:, :, -1]
    return channels, np.full(channels.shape[:2], _WHITE, np.uint8)


def _luma(channels: Channels) -> Shades:
    """Return how bright pixels look, in whole numbers."""
    colours, _ = _split(channels)
    if colours.shape[2] == 1:
        return colours[:, :, 0].astype(np.float64)
    return (colours @ np.array(_LUMA, np.uint32) + 2**15 >> 16).astype(np.float64)


def _darkness(shades: Shades, how: Interpretation) -> Shades:
    return (shades if how.negate else _WHITE - shades) / _WHITE


def _trinary(shades: Shades, how: Interpretation, free_thresh: float) -> Occupancy:
    darkness = _darkness(shades, how)
    free = (darkness < free_thresh) & (shades != _UNKNOWN_GREY)
    values = np.where(free, 0, UNKNOWN).astype(np.int8)
    values[darkness > how.occupied_thresh] = _OCCUPIED
    return values


def _scale(shades: Shades, how: Interpretation) -> Occupancy:
    darkness = _darkness(shades, how)
    between = (darkness - how.free_thresh) / (how.occupied_thresh - how.free_thresh)
    values = np.rint(_SCALE * between.clip(0, 1)).astype(np.int8)
    values[darkness > how.occupied_thresh] = _OCCUPIED
    return values
