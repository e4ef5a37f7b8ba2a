"""Maps in a PGM file, the format of netpbm in which robots save them: binary (P5) or plain (P2)."""

import re

import numpy as np
from numpy.typing import NDArray

from service.errors import Refusal, invalid
from service.requests.arrays import check_size

SIGNATURES = (b"P5", b"P2")
_LONGEST_HEADER = 4096  # bytes, with its comments
_GAP = rb"(?:\s|#[^\n]*\n)+"
_HEADER = re.compile(rb"P[25]" + 3 * (_GAP + rb"(\d{1,10})") + rb"\s")
_MOST_SHADE = 255  # one byte a cell
_MOST_BYTES = 8  # of a cell in a plain file: three digits and some white space


def read_pgm(content: bytes, most_cells: int) -> NDArray[np.uint8]:
    """Return the shades in a PGM file, black 0 to white 255, shape (rows, columns).

    Raises:
        Refusal: The file is not PGM with a byte for each cell, or has too many cells.
    """
    header = _HEADER.match(content[:_LONGEST_HEADER])
    if header is None:
        raise _malformed(f"a header of width, height and white within {_LONGEST_HEADER} bytes")
    columns, rows, white = map(int, header.groups())
    check_size(columns, rows, most_cells)
    if not 0 < white <= _MOST_SHADE:
        raise _malformed(f"white as 1 to {_MOST_SHADE}, got {white}")
    raster = content[header.end() :]
    read = _read_binary if content.startswith(b"P5") else _read_plain
    shades = read(raster, rows * columns).reshape(rows, columns)
    if shades.max() > white:
        raise _malformed(f"no shade over white, which is {white}, got {shades.max()}")
    if white == _MOST_SHADE:
        return shades
    return np.rint(shades / white * _MOST_SHADE).astype(np.uint8)


def _read_binary(raster: bytes, cells: int) -> NDArray[np.uint8]:
    if len(raster) != cells:
        raise _malformed(f"{cells} bytes after its header, got {len(raster)}")
    return np.frombuffer(raster, np.uint8)


def _read_plain(raster: bytes, cells: int) -> NDArray[np.uint8]:
    most = _LONGEST_HEADER + _MOST_BYTES * cells
    if len(raster) > most:
        raise _malformed(f"at most {most} bytes after its header, got {len(raster)}")
    numbers = raster.split(None, cells)  # no more of them than needed: each takes 40 bytes
    if len(numbers) != cells:
        came = "more" if len(numbers) > cells else len(numbers)
        raise _malformed(f"{cells} numbers after its header, got {came}")
    if not all(len(number) <= 3 and number.isdigit() for number in numbers):
        raise _malformed("numbers of at most three digits after its header")
    shades = np.array([int(number) for number in numbers], np.int64)
    if shades.max() > _MOST_SHADE:
        raise _malformed(f"no shade over {_MOST_SHADE}, got {shades.max()}")
    return shades.astype(np.uint8)


def _malformed(demand: str) -> Refusal:
    return invalid("grid", f"must be a PGM file with {demand}")
