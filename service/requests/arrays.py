"""Arrays in requests: matrices from JSON or a .npy file, maps from PNG, and their checks.

Every function raises a refusal that points at the row, the number or the file at fault. A file's
header is checked before its content is unpacked.
"""

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

from service.instance import OBJECTIVES
from service.requests.validation import invalid, too_many_cells, too_many_cities

Array = NDArray[np.float64]
Rows = list[list[float]]


def stack_matrices(matrices: list[Rows]) -> Array:
    """Return one matrix for each objective as an array, shape (2, n, n).

    Raises:
        Refusal: A matrix is not square, or they differ in size.
    """
    arrays = [square_array(rows, f"matrices/{m}") for m, rows in enumerate(matrices)]
    n = len(arrays[0])
    for m, array in enumerate(arrays):
        if len(array) != n:
            demand = f"must have {n} rows, as many as matrices/0, got {len(array)}"
            raise invalid(f"matrices/{m}", demand)
    return np.stack(arrays)


def square_array(rows: Rows, name: str) -> Array:
    """Return the rows of a matrix as an array, shape (n, n).

    Raises:
        Refusal: A row is not as long as there are rows.
    """
    matrix = rectangular_array(rows, name)
    n, width = matrix.shape
    if n != width:
        raise invalid(name, f"must be square, got {n} rows of {width} numbers")
    return matrix


def rectangular_array(rows: Rows, name: str) -> Array:
    """Return rows of numbers as an array, shape (rows, columns).

    Raises:
        Refusal: There is no number, or the rows differ in length.
    """
    if not rows or not rows[0]:
        raise invalid(name, "must have a row of numbers or more, got none")
    width = len(rows[0])
    for i, row in enumerate(rows):
        if len(row) != width:
            raise invalid(f"{name}/{i}", f"must have {width} numbers, as the first, got {len(row)}")
    return np.array(rows, dtype=np.float64)


def check_costs(matrix: Array, name: str, largest: float) -> None:
    """Raise a refusal unless all entries of a matrix, shape (n, n), off its diagonal are costs.

    Raises:
        Refusal: An entry is not finite, negative or too large.
    """
    # A comparison with NaN is false, so what is not a number is found as well.
    is_cost = (matrix >= 0) & (matrix <= largest) | np.eye(len(matrix), dtype=np.bool_)
    if is_cost.all():
        return
    i, j = np.unravel_index(is_cost.argmin(), is_cost.shape)
    entry = float(matrix[i, j])
    if not np.isfinite(entry):
        demand = "must be a finite number"
    else:
        demand = "must not be negative" if entry < 0 else f"must be at most {largest:g}"
    shown = to_json(entry, inf_nan_mode="constants").decode()
    raise invalid(f"{name}/{i}/{j}", f"{demand}, got {shown}")


def read_npy(content: bytes, most_cities: int) -> Array:
    """Return the matrices, shape (2, n, n), in a file as numpy.save writes it.

    Nothing is unpickled.

    Raises:
        Refusal: The file is not .npy, cut short, not of two square matrices of numbers, or its
            header declares too many cities.
    """
    stream = BytesIO(content)
    try:
        read_header = _NPY_HEADERS[read_magic(stream)]
        shape, by_columns, dtype = read_header(stream)
    except (KeyError, ValueError, EOFError):
        raise invalid("matrices", "must be a .npy file of version 1 or 2") from None
    _check_npy_header(shape, dtype, most_cities)
    demanded, came = prod(shape) * dtype.itemsize, len(content) - stream.tell()
    if came != demanded:
        raise invalid("matrices", f"must have {demanded} bytes after its header, got {came}")
    numbers = np.frombuffer(content, dtype, offset=stream.tell())
    return numbers.reshape(shape, order="F" if by_columns else "C").astype(np.float64)


_NpyHeader = Callable[[BytesIO], tuple[tuple[int, ...], bool, np.dtype[Any]]]
_NPY_HEADERS: Mapping[tuple[int, int], _NpyHeader] = {
    (1, 0): read_array_header_1_0,
    (2, 0): read_array_header_2_0,
}


def _check_npy_header(shape: tuple[int, ...], dtype: np.dtype[Any], most_cities: int) -> None:
    if dtype.kind not in "fiu" or dtype.itemsize > 8:
        raise invalid("matrices", f"must be of real numbers of at most 8 bytes, got {dtype}")
    if len(shape) != 3 or shape[0] != OBJECTIVES or shape[1] != shape[2] or shape[1] < 1:
        demand = f"must have shape ({OBJECTIVES}, n, n) with n at least 1"
        raise invalid("matrices", f"{demand}, got {shape}")
    if shape[1] > most_cities:
        raise too_many_cities("matrices", most_cities, shape[1])


_PNG_START = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR"
_PNG_SIZE = struct.Struct(">II")
_PNG_MODES = ("1", "L", "LA", "P", "RGB", "RGBA")
_LIGHT = 128  # of 256 shades: a cell darker than this is an obstacle


def read_png(content: bytes, most_cells: int) -> Array:
    """Return the map in an image, shape (rows, columns): 0 where it is light, 1 where it is dark.

    Raises:
        Refusal: The file cannot be read as PNG, or its header declares too many cells.
    """
    if not content.startswith(_PNG_START) or len(content) < len(_PNG_START) + _PNG_SIZE.size:
        raise invalid("grid", "must be a PNG file")
    width, height = _PNG_SIZE.unpack_from(content, len(_PNG_START))
    if width * height > most_cells:
        raise too_many_cells(most_cells, width * height, f"{height} x {width}")
    try:
        with Image.open(BytesIO(content), formats=["PNG"]) as image:
            if image.mode not in _PNG_MODES:
                raise invalid("grid", f"must have 8 bits a channel or fewer, got {image.mode}")
            shades = np.asarray(image.convert("L"))
    except (OSError, SyntaxError, ValueError, UnidentifiedImageError) as error:
        raise invalid("grid", f"must be a PNG file that can be read: {error}") from None
    return (shades < _LIGHT).astype(np.float64)
