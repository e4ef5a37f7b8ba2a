"""Arrays in requests: matrices from rows and .npy files, maps from PNG, every refusal of them."""

import io
import struct
import zlib
from typing import Any

import numpy as np
import pytest
from PIL import Image

from service.errors import Refusal
from service.requests.arrays import check_costs, read_npy, read_png, stack_matrices
from tests.helpers.serving import LIMITS

COSTS = np.random.default_rng(6).random((2, 12, 12))
SQUARE = [[0.0, 1, 2], [1, 0, 3], [2, 3, 0]]
GRID = [[0, 0, 0], [1, 1, 0], [0, 0, 0], [0, 1, 0]]


def test_matrices_are_stacked() -> None:
    np.testing.assert_array_equal(stack_matrices(COSTS.tolist()), COSTS)


@pytest.mark.parametrize(
    ("matrices", "sentence"),
    [
        ([[], []], "matrices/0 must have a row of numbers or more, got none"),
        ([SQUARE, [[], [], []]], "matrices/1 must have a row of numbers or more, got none"),
        ([SQUARE, [[0, 1], [1, 0]]], "matrices/1 must have 3 rows, as many as matrices/0, got 2"),
        ([[[0, 1], [1, 0], [2, 3]], SQUARE], "matrices/0 must be square, got 3 rows of 2 numbers"),
        (
            [SQUARE, [[0, 1, 2], [1, 0], [2, 3, 0]]],
            "matrices/1/1 must have 3 numbers, as the first, got 2",
        ),
    ],
)
def test_what_is_not_square_is_named(matrices: list[list[list[float]]], sentence: str) -> None:
    with pytest.raises(Refusal) as refused:
        stack_matrices(matrices)
    assert refused.value.detail == sentence
    assert refused.value.errors[0].pointer == f"/{sentence.partition(' ')[0]}"


@pytest.mark.parametrize(
    ("cost", "sentence"),
    [
        (-0.5, "must not be negative, got -0.5"),
        (np.nan, "must be a finite number, got NaN"),
        (np.inf, "must be a finite number, got Infinity"),
        (-np.inf, "must be a finite number, got -Infinity"),
        (1e200, "must be at most 1e+150, got 1e+200"),
    ],
)
def test_an_entry_that_is_no_cost_is_named(cost: float, sentence: str) -> None:
    matrix = np.array(SQUARE)
    np.fill_diagonal(matrix, np.nan)
    check_costs(matrix, "matrices/1", 1e150)
    matrix[1, 2] = cost
    with pytest.raises(Refusal) as refused:
        check_costs(matrix, "matrices/1", 1e150)
    assert refused.value.detail == f"matrices/1/1/2 {sentence}"


def npy(matrices: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, matrices)
    return stream.getvalue()


def declared(header: bytes) -> bytes:
    """A .npy file that ends with its header."""
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header


@pytest.mark.parametrize(
    "saved",
    [
        COSTS,
        np.asfortranarray(COSTS),
        COSTS.astype(">f8"),
        (100 * COSTS).astype(np.int32),
        COSTS.astype(np.float32),
    ],
)
def test_a_file_of_matrices_is_read_in_every_layout(saved: np.ndarray) -> None:
    np.testing.assert_array_equal(read_npy(npy(saved), 12), saved.astype(np.float64))


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"", "must be a .npy file of version 1 or 2"),
        (b"PK\x03\x04 a zip", "must be a .npy file of version 1 or 2"),
        (declared(b"{'descr': __import__('os')}"), "must be a .npy file of version 1 or 2"),
        (
            npy(np.array([[[None]], [[None]]], dtype=object)),
            "must be of real numbers of at most 8 bytes, got object",
        ),
        (npy(COSTS * 1j), "must be of real numbers of at most 8 bytes, got complex128"),
        (npy(COSTS[0]), "must have shape (2, n, n) with n at least 1, got (12, 12)"),
        (npy(COSTS[:, :3]), "must have shape (2, n, n) with n at least 1, got (2, 3, 12)"),
        (npy(COSTS[:, :0, :0]), "must have shape (2, n, n) with n at least 1, got (2, 0, 0)"),
        (npy(COSTS)[:-8], "must have 2304 bytes after its header, got 2296"),
    ],
)
def test_a_file_that_is_not_two_matrices_is_named(content: bytes, sentence: str) -> None:
    with pytest.raises(Refusal) as refused:
        read_npy(content, 50)
    assert refused.value.detail == f"matrices {sentence}"


def test_a_file_that_declares_too_many_cities_is_refused_by_its_header() -> None:
    huge = b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 1000000, 1000000)}"
    with pytest.raises(Refusal) as refused:
        read_npy(declared(huge), 50)
    assert refused.value.code == "too-many-cities"
    assert (refused.value.limit, refused.value.actual) == (50, 1_000_000)


def png(grid: Any, mode: str = "L") -> bytes:
    """A picture of a grid: black where it is 1, white where it is 0."""
    stream = io.BytesIO()
    shades = (255 * (1 - np.array(grid))).astype(np.uint8)
    Image.fromarray(shades).convert(mode).save(stream, "PNG")
    return stream.getvalue()


def chunk(kind: bytes, content: bytes) -> bytes:
    checksum = zlib.crc32(kind + content)
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", checksum)


def bomb(width: int, height: int, content: bytes) -> bytes:
    """A small file that declares a size, and unpacks to something else."""
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + content + chunk(b"IEND", b"")


ZEROS = zlib.compress(bytes(50_000_000), 9)


@pytest.mark.parametrize("mode", ["1", "L", "LA", "P", "RGB", "RGBA"])
def test_a_map_is_read_in_every_mode(mode: str) -> None:
    np.testing.assert_array_equal(read_png(png(GRID, mode), 12), GRID)


def test_a_png_that_declares_too_many_cells_is_refused_by_its_header() -> None:
    with pytest.raises(Refusal) as refused:
        read_png(bomb(50_000, 50_000, chunk(b"IDAT", ZEROS)), LIMITS.cells)
    assert refused.value.code == "too-many-cells"
    assert (refused.value.limit, refused.value.actual) == (LIMITS.cells, 50_000**2)
    assert refused.value.detail == "grid must have at most 900 cells, got 50000 x 50000"


def test_a_png_is_unpacked_no_further_than_it_declares() -> None:
    assert read_png(bomb(6, 5, chunk(b"IDAT", ZEROS)), LIMITS.cells).shape == (5, 6)
    text = chunk(b"zTXt", b"bomb\0\0" + ZEROS) + chunk(b"IDAT", zlib.compress(bytes(35)))
    with pytest.raises(Refusal, match="grid must be a PNG file that can be read"):
        read_png(bomb(6, 5, text), LIMITS.cells)


@pytest.mark.parametrize(
    ("image", "sentence"),
    [
        (b"", "grid must be a PNG file"),
        (b"GIF89a", "grid must be a PNG file"),
        (png(GRID)[:40], "grid must be a PNG file that can be read"),
        (png(GRID)[:50], "grid must be a PNG file that can be read"),
        (bomb(0, 5, b""), "grid must be a PNG file that can be read"),
        (png(GRID, "I;16"), "grid must have 8 bits a channel or fewer, got I;16"),
    ],
)
def test_an_image_that_is_no_map_is_named(image: bytes, sentence: str) -> None:
    with pytest.raises(Refusal) as refused:
        read_png(image, LIMITS.cells)
    assert refused.value.errors[0].pointer == "/grid"
    assert refused.value.detail.startswith(sentence)
