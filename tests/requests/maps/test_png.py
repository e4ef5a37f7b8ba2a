"""Maps in PNG files: every mode, every refusal, and files that declare other than they hold."""

import io
import struct
import zlib
from typing import Any

import numpy as np
import pytest
from PIL import Image

from service.errors import Refusal
from service.requests.maps.png import SIGNATURE, read_png
from tests.helpers.serving import LIMITS

GRID = [[0, 0, 0], [1, 1, 0], [0, 0, 0], [0, 1, 0]]


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
    return SIGNATURE + chunk(b"IHDR", header) + content + chunk(b"IEND", b"")


ZEROS = zlib.compress(bytes(5_000_000), 1)


@pytest.mark.parametrize("mode", ["1", "L", "LA", "P", "RGB", "RGBA"])
def test_a_map_is_read_in_every_mode(mode: str) -> None:
    channels = read_png(png(GRID, mode), 12)
    assert channels.shape[2] == {"LA": 2, "P": 3, "RGB": 3, "RGBA": 4}.get(mode, 1)
    np.testing.assert_array_equal(channels[:, :, 0], 255 * (1 - np.array(GRID)))


def test_a_png_of_an_unknown_depth_is_refused_without_an_address() -> None:
    header = struct.pack(">IIBBBBB", 2, 2, 3, 0, 0, 0, 0)
    picture = SIGNATURE + chunk(b"IHDR", header) + chunk(b"IEND", b"")
    with pytest.raises(Refusal, match=r"can be read: cannot identify image file$"):
        read_png(picture, 12)


def test_a_png_that_declares_too_many_cells_is_refused_by_its_header() -> None:
    with pytest.raises(Refusal) as refused:
        read_png(bomb(50_000, 50_000, chunk(b"IDAT", ZEROS)), LIMITS.cells)
    assert refused.value.code == "too-many-cells"
    assert (refused.value.limit, refused.value.actual) == (LIMITS.cells, 50_000**2)
    assert refused.value.detail == "grid must have at most 900 cells, got 50000 x 50000"


def test_a_png_is_unpacked_no_further_than_it_declares() -> None:
    assert read_png(bomb(6, 5, chunk(b"IDAT", ZEROS)), LIMITS.cells).shape == (5, 6, 1)


@pytest.mark.parametrize(
    "extra",
    [
        chunk(b"zTXt", b"bomb\0\0" + ZEROS),
        chunk(b"iCCP", b"bomb\0\0" + ZEROS),
        chunk(b"iTXt", b"bomb\0\1\0\0\0" + ZEROS),
        chunk(b"tRNS", b""),
        chunk(b"acTL", b"\0"),
        chunk(b"gAMA", b""),
        chunk(b"tEXt", b"x" * 100_000),
    ],
)
def test_what_stands_beside_a_picture_is_not_looked_at(extra: bytes) -> None:
    image = extra + chunk(b"IDAT", zlib.compress(bytes(35)))
    assert read_png(bomb(6, 5, image), LIMITS.cells).shape == (5, 6, 1)


@pytest.mark.parametrize(
    ("image", "sentence"),
    [
        (png(GRID)[:40], "grid must be a PNG file that can be read"),
        (png(GRID)[:50], "grid must be a PNG file that can be read"),
        (bomb(0, 5, b""), "grid must have a cell or more, got 5 x 0"),
    ],
)
def test_an_image_that_is_no_map_is_named(image: bytes, sentence: str) -> None:
    with pytest.raises(Refusal) as refused:
        read_png(image, LIMITS.cells)
    assert refused.value.errors[0].pointer == "/grid"
    assert refused.value.detail.startswith(sentence)


def header(width: int, height: int) -> bytes:
    return chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))


IMAGE = chunk(b"IDAT", zlib.compress(bytes(72)))


@pytest.mark.parametrize("first", [(8, 8), (13_300, 13_300)])
@pytest.mark.parametrize("second", [(8, 8), (13_300, 13_300), (2**31 - 1, 2**31 - 1)])
def test_a_second_header_is_refused(first: tuple[int, int], second: tuple[int, int]) -> None:
    for content in (header(*second) + IMAGE, IMAGE + header(*second)):
        with pytest.raises(Refusal) as refused:
            read_png(bomb(*first, content), LIMITS.cells)
        assert refused.value.detail == (
            "grid must be a PNG file with one header, at its beginning, got 2"
        )


@pytest.mark.parametrize("kind", [b"IDAT", b"tEXt", b"IHDR"])
def test_a_picture_of_countless_chunks_is_refused(kind: bytes) -> None:
    with pytest.raises(Refusal, match="must be a PNG file of at most 20000 chunks, got more"):
        read_png(bomb(8, 8, 100_000 * chunk(kind, b"")), LIMITS.cells)


@pytest.mark.parametrize("size", [(40_000, 40_000), (2**31 - 1, 2**31 - 1), (2**31, 1)])
def test_the_decoder_has_the_last_word_on_the_size(size: tuple[int, int]) -> None:
    with pytest.raises(Refusal) as refused:
        read_png(bomb(*size, IMAGE), 2**62)
    assert refused.value.code in ("invalid-request", "too-many-cells")
