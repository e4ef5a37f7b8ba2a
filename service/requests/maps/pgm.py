"""Maps in a PGM file, the format of netpbm in which robots save them: binary (P5) or plain (P2)."""

import re

import numpy as np
from numpy.typing import NDArray

from service.errors import invalid
from service.requests.arrays import check_size

SIGNATURES = (b"P5", b"P2")
_LONGEST_HEADER = 4096  # bytes, with its comments
_GAP = rb"(?:\s|#[^\n]*\n)+"
_HEADER = re.compile(rb"P[25]" + 3 * (_GAP + rb"(\d{1,10})") + rb"\s")
_BYTE = 255  # the largest shade that is one byte in a binary file
_MOST_SHADE = 65_535  # two bytes
_MOST_DIGITS = len(str(_MOST_SHADE))
_MOST_BYTES = 8  # of a cell in a plain file: its digits and some white space

Shades = NDArray[np.uint8] | NDArray[np.uint16]


def read_pgm(content: bytes, most_cells: int) -> Shades:
    """Return the shades in a PGM file, shape (rows, columns).

    Black is 0. White is 255, or 65535 if the file has more than 256 shades.

    Raises:
        Refusal: The file is not PGM, or has too many cells.
    """
    header = _HEADER.match(content[:_LONGEST_HEADER])
    if header is None:
        raise invalid("grid", "pgm-header", limit=_LONGEST_HEADER)
    columns, rows, white = map(int, header.groups())
    check_size(columns, rows, most_cells)
    if not 0 < white <= _MOST_SHADE:
        raise invalid("grid", "pgm-white", limit=_MOST_SHADE, came=white)
    raster = content[header.end() :]
    depth = np.uint8 if white <= _BYTE else np.uint16
    cells = rows * columns
    binary = content.startswith(b"P5")
    read = _read_binary(raster, cells, depth) if binary else _read_plain(raster, cells)
    shades = read.reshape(rows, columns)
    if shades.max() > white:
        raise invalid("grid", "pgm-shade", limit=white, came=int(shades.max()))
    most = np.iinfo(depth).max
    scaled = shades if white == most else np.rint(shades / white * most)
    return scaled.astype(np.uint8) if depth is np.uint8 else scaled.astype(np.uint16)


def _read_binary(raster: bytes, cells: int, depth: type[np.uint8] | type[np.uint16]) -> Shades:
    size = np.dtype(depth).itemsize
    if len(raster) != size * cells:
        raise invalid("grid", "pgm-bytes", bytes=size * cells, came=len(raster))
    return np.frombuffer(raster, np.dtype(depth).newbyteorder(">"))


def _read_plain(raster: bytes, cells: int) -> NDArray[np.int64]:
    most = _LONGEST_HEADER + _MOST_BYTES * cells
    if len(raster) > most:
        raise invalid("grid", "pgm-too-long", bytes=most, came=len(raster))
    numbers = raster.split(None, cells)  # no more of them than needed: each takes 40 bytes
    if len(numbers) != cells:
        came = "more" if len(numbers) > cells else len(numbers)
        raise invalid("grid", "pgm-numbers", numbers=cells, given=came)
    if not all(len(number) <= _MOST_DIGITS and number.isdigit() for number in numbers):
        raise invalid("grid", "pgm-digits", limit=_MOST_DIGITS)
    return np.array([int(number) for number in numbers], np.int64)
