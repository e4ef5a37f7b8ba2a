"""Maps in PGM files: both forms of the format, beside Pillow, and every refusal."""

import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from service.errors import Refusal
from service.requests.maps.pgm import read_pgm
from tests.helpers.serving import LIMITS

SHADES = [[0, 205, 254], [7, 0, 255]]
COMMENT = b"# CREATOR: map_saver.cpp 0.050 m/pix\n"  # as map_saver writes it
BINARY = b"P5\n" + COMMENT + b"3 2\n255\n" + bytes(np.array(SHADES).ravel().tolist())
PLAIN = b"P2\n3 2\n# one\n255\n0 205\n254 7 0\t255\n"


@pytest.mark.parametrize("content", [BINARY, PLAIN])
def test_both_forms_hold_the_same_shades_from_the_top(content: bytes) -> None:
    np.testing.assert_array_equal(read_pgm(content, 6), SHADES)


@given(
    size=st.tuples(st.integers(1, 9), st.integers(1, 9)),
    white=st.sampled_from([1, 2, 99, 100, 254, 255]),
    plain=st.booleans(),
    seed=st.integers(0, 2**32 - 1),
)
def test_shades_are_those_that_pillow_reads(
    size: tuple[int, int], white: int, plain: bool, seed: int
) -> None:
    shades = np.random.default_rng(seed).integers(0, white + 1, size)
    numbers = shades.ravel().tolist()
    raster = " ".join(map(str, numbers)).encode() if plain else bytes(numbers)
    head = f"P{2 if plain else 5} {size[1]} {size[0]} {white}\n".encode()
    with Image.open(io.BytesIO(head + raster)) as image:
        expected = np.asarray(image.convert("L"))
    np.testing.assert_array_equal(read_pgm(head + raster, 81), expected)


@pytest.mark.parametrize(
    "content",
    [
        b"P5 3 1 65535\n\x00\x00\x01\x00\xff\xff",
        b"P2 3 1 65535\n0 256 65535",
    ],
)
def test_shades_of_two_bytes_are_read(content: bytes) -> None:
    assert read_pgm(content, 3).tolist() == [[0, 256, 65535]]
    assert read_pgm(b"P5 1 1 1000\n\x01\xf4", 1).tolist() == [[round(65535 / 2)]]


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"P5", "with a header of width, height and white within 4096 bytes"),
        (b"P5 3 2", "with a header of"),
        (b"P5 3 2 255", "with a header of"),
        (b"P5 -3 2 255\n", "with a header of"),
        (b"P5 3 2 255 " + b"9" * 5000, "6 bytes after its header, got 5000"),
        (b"P5 " + b"9" * 5000 + b" 2 255\n", "with a header of"),
        (b"P5 #" + b"x" * 5000 + b"\n3 2 255\n123456", "with a header of"),
        (b"P5\n3 2\n0\n123456", "white as 1 to 65535, got 0"),
        (b"P5\n3 2\n65536\n123456123456", "white as 1 to 65535, got 65536"),
        (b"P5\n3 2\n65535\n123456", "12 bytes after its header, got 6"),
        (b"P5\n3 2\n255\n12345", "6 bytes after its header, got 5"),
        (b"P5\n3 2\n255\r\n123456", "6 bytes after its header, got 7"),
        (b"P5\n3 2\n48\n123456", "no shade over white, which is 48, got 54"),
        (b"P2\n3 2\n255\n1 2 3 4 5", "6 numbers after its header, got 5"),
        (b"P2\n3 2\n255\n1 2 3 4 5 6 7", "6 numbers after its header, got more"),
        (b"P2\n3 2\n255\n1 2 3 4 5 -6", "numbers of at most 5 digits"),
        (b"P2\n3 2\n255\n1 2 3 4 5 1_6", "numbers of at most 5 digits"),
        (b"P2\n3 2\n255\n1 2 3 4 5 " + b"9" * 4000, "numbers of at most 5 digits"),
        (b"P2\n3 2\n255\n1 2 3 4 5 256", "no shade over white, which is 255, got 256"),
        (b"P2\n3 2\n255\n" + b" " * 4145, "at most 4144 bytes after its header, got 4145"),
    ],
)
def test_a_file_that_is_no_map_is_named(content: bytes, sentence: str) -> None:
    with pytest.raises(Refusal) as refused:
        read_pgm(content, LIMITS.cells)
    assert refused.value.errors[0].pointer == "/grid"
    assert refused.value.detail.startswith("grid must be a PGM file with ")
    assert sentence in refused.value.detail


def test_a_size_over_the_limit_is_refused_by_the_header() -> None:
    with pytest.raises(Refusal) as refused:
        read_pgm(b"P5 50000 50000 255\n", LIMITS.cells)
    assert refused.value.detail == "grid must have at most 900 cells, got 50000 x 50000"
    with pytest.raises(Refusal, match="must have a cell or more, got 2 x 0"):
        read_pgm(b"P5 0 2 255\n", LIMITS.cells)
