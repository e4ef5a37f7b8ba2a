"""Arrays in requests: matrices as JSON or .npy, maps as PNG, and every demand on them."""

import struct
from collections.abc import Callable, Mapping
from io import BytesIO
from math import prod
from typing import Any

import numpy as np
from numpy.lib.format import read_array_header_1_0, read_array_header_2_0, read_magic
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError
from pydantic_core import to_json

from service.requests.validation import invalid, too_many_cells, too_many_cities

Array = NDArray[np.float64]
Rows = list[list[float]]
Header = Callable[[BytesIO], tuple[tuple[int, ...], bool, np.dtype[Any]]]

_HEADERS: Mapping[tuple[int, int], Header] = {
    (1, 0): read_array_header_1_0,
    (2, 0): read_array_header_2_0,
}


def stacked(matrices: list[Rows]) -> Array:
    """Two matrices of numbers as an array, shape (2, n, n).

    Raises:
        Refusal: one is not square, or they differ in size.
    """
    first, second = (square(rows, f"matrices/{m}") for m, rows in enumerate(matrices))
    if len(first) != len(second):
        demand = f"must have {len(first)} rows, as many as matrices/0, got {len(second)}"
        raise invalid("matrices/1", demand)
    return np.stack((first, second))


def square(rows: Rows, name: str) -> Array:
    """A matrix of numbers as an array, shape (n, n).

    Raises:
        Refusal: a row is not as long as there are rows.
    """
    matrix = rectangular(rows, name)
    n, width = matrix.shape
    if n != width:
        raise invalid(name, f"must be square, got {n} rows of {width} numbers")
    return matrix


def rectangular(rows: Rows, name: str) -> Array:
    """Rows of numbers as an array, shape (rows, columns).

    Raises:
        Refusal: there is none, one is empty, or they differ in length.
    """
    if not rows or not rows[0]:
        raise invalid(name, "must have a row of numbers or more, got none")
    width = len(rows[0])
    for i, row in enumerate(rows):
        if len(row) != width:
            raise invalid(f"{name}/{i}", f"must have {width} numbers, as the first, got {len(row)}")
    return np.array(rows, dtype=np.float64)


def loaded(content: bytes, most: int) -> Array:
    """Two matrices from a file as numpy.save writes it. Its header is checked before all else.

    Raises:
        Refusal: it is no such file, not of numbers, not two square matrices, or too large.
    """
    stream = BytesIO(content)
    try:
        read_header = _HEADERS[read_magic(stream)]
        shape, by_columns, dtype = read_header(stream)
    except (KeyError, ValueError, EOFError):
        raise invalid("matrices", "must be a .npy file of version 1 or 2") from None
    _check_header(shape, dtype, most)
    demanded, came = prod(shape) * dtype.itemsize, len(content) - stream.tell()
    if came != demanded:
        raise invalid("matrices", f"must have {demanded} bytes after its header, got {came}")
    numbers = np.frombuffer(content, dtype, offset=stream.tell())
    return numbers.reshape(shape, order="F" if by_columns else "C").astype(np.float64)


def check_costs(matrix: Array, name: str, largest: float) -> None:
    """Nothing, if all that stands beside the diagonal, shape (n, n), is a cost.

    Raises:
        Refusal: something is not finite, negative or too large.
    """
    # A comparison with NaN is false, so what is not a number is found as well.
    costs = (matrix >= 0) & (matrix <= largest) | np.eye(len(matrix), dtype=np.bool_)
    if costs.all():
        return
    i, j = np.unravel_index(costs.argmin(), costs.shape)
    cost = float(matrix[i, j])
    shown = to_json(cost, inf_nan_mode="constants").decode()
    if not np.isfinite(cost):
        demand = "must be a finite number"
    else:
        demand = "must not be negative" if cost < 0 else f"must be at most {largest:g}"
    raise invalid(f"{name}/{i}/{j}", f"{demand}, got {shown}")


def _check_header(shape: tuple[int, ...], dtype: np.dtype[Any], most: int) -> None:
    if dtype.kind not in "fiu" or dtype.itemsize > 8:
        raise invalid("matrices", f"must be of real numbers of at most 8 bytes, got {dtype}")
    if len(shape) != 3 or shape[0] != 2 or shape[1] != shape[2] or shape[1] < 1:
        raise invalid("matrices", f"must have shape (2, n, n) with n at least 1, got {shape}")
    if shape[1] > most:
        raise too_many_cities("matrices", most, shape[1])


_START = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR"
_SIZE = struct.Struct(">II")
_MODES = ("1", "L", "LA", "P", "RGB", "RGBA")
_DARK = 128  # of 256 shades: what is darker is an obstacle


def read_grid(content: bytes, most: int) -> Array:
    """A grid of 0 where the image is light and 1 where it is dark, shape (rows, columns).

    Raises:
        Refusal: it is no PNG that can be read, or declares more cells than are allowed.
    """
    if not content.startswith(_START) or len(content) < len(_START) + _SIZE.size:
        raise invalid("grid", "must be a PNG file")
    width, height = _SIZE.unpack_from(content, len(_START))
    if width * height > most:
        raise too_many_cells(most, width * height, f"{height} x {width}")
    try:
        with Image.open(BytesIO(content), formats=["PNG"]) as image:
            if image.mode not in _MODES:
                raise invalid("grid", f"must have 8 bits a channel or fewer, got {image.mode}")
            shades = np.asarray(image.convert("L"))
    except (OSError, SyntaxError, ValueError, UnidentifiedImageError) as error:
        raise invalid("grid", f"must be a PNG file that can be read: {error}") from None
    return (shades < _DARK).astype(np.float64)
