"""Matrices in .npy files: every layout, every refusal, and headers that no numpy writes."""

import io

import numpy as np
import pytest

from service.errors import Refusal
from service.requests.npy import read_npy

COSTS = np.random.default_rng(6).random((2, 12, 12))
HEADER = "must be a .npy file whose header has descr, fortran_order and shape, once each"


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
        (declared(b"{'descr': f()}"), f"{HEADER}, got \"{{'descr': f()}}\""),
        (
            npy(np.array([[[None]], [[None]]], dtype=object)),
            "must be of real numbers of at most 8 bytes, got '|O'",
        ),
        (npy(COSTS * 1j), "must be of real numbers of at most 8 bytes, got '<c16'"),
        (npy(COSTS[0]), "must have shape (m, n, n) with m from 2 to 4, n at least 1, got (12, 12)"),
        (
            npy(COSTS[:, :3]),
            "must have shape (m, n, n) with m from 2 to 4, n at least 1, got (2, 3, 12)",
        ),
        (
            npy(COSTS[:, :0, :0]),
            "must have shape (m, n, n) with m from 2 to 4, n at least 1, got (2, 0, 0)",
        ),
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


SHAPE = b"'fortran_order': False, 'shape': (2, 12, 12)"


@pytest.mark.parametrize(
    "header",
    [
        b"{'descr': '<f8', " + SHAPE + b", }          \n",
        b"{ 'descr' : '<f8' , 'fortran_order' : False , 'shape' : ( 2 , 12 , 12 ) }",
        b"{'shape': (2, 12, 12), 'fortran_order': False, 'descr': '<f8'}",
        b"{'shape': (2L, 12L, 12L), 'descr': '<f8', 'fortran_order': False}",
    ],
)
def test_a_header_may_be_written_in_several_ways(header: bytes) -> None:
    np.testing.assert_array_equal(read_npy(declared(header) + COSTS.tobytes(), 12), COSTS)


@pytest.mark.parametrize(
    "header",
    [
        b"",
        b"{",
        b"{}",
        3 * b"'",
        b"{'descr': '<f8', " + SHAPE + b", 'shape': (2, 12, 12)}",
        b"{'descr': '<f8', 'descr': '<f8', 'shape': (2, 12, 12)}",
        b"{'descr': '<f8', 'fortran_order': 0, 'shape': (2, 12, 12)}",
        b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 0xff, 12)}",
        b"{'descr': '<f8', 'fortran_order': False, 'shape': (0x" + 5000 * b"f" + b",)}",
        b"{'descr': '<f8', 'fortran_order': False, 'shape': (" + 5000 * b"9" + b",)}",
        b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, -1, -1)}",
        b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, True, 12)}",
        b"{'descr': [('a', '<f8')], " + SHAPE + b"}",
        b"{'descr': ('<f8', (2,)), " + SHAPE + b"}",
        b"(" * 9000,
        b"-" * 9000,
        b"{" + 9000 * b" ",
        b"{'descr': '<f8'," + 9000 * b" " + b"x",
        b"\n\n  {\n" + b"\t" * 100,
        b"\\",
        b"\x00" * 100,
        b"\xff" * 100,
        b"{[]: 1}",
        b"{**1}",
    ],
)
def test_a_header_that_is_none_is_named(header: bytes) -> None:
    with pytest.raises(Refusal, match=r"matrices must be a \.npy file whose header has descr"):
        read_npy(declared(header) + COSTS.tobytes(), 12)


@pytest.mark.parametrize("descr", ["<f16", "|b1", "f1", "<M8[s]", "|S8", "|V8", "O", "a8", "<U2"])
def test_numbers_of_other_kinds_are_named(descr: str) -> None:
    header = b"{'descr': '%s', %s}" % (descr.encode(), SHAPE)
    with pytest.raises(Refusal) as refused:
        read_npy(declared(header), 12)
    sentence = f"matrices must be of real numbers of at most 8 bytes, got {descr!r}"
    assert refused.value.detail == sentence


@pytest.mark.parametrize("length", [b"\x02\x00\xff\xff\xff\xff", b"\x01\x00\xff\xff", b"\x02\x00"])
def test_a_header_longer_than_any_is_refused(length: bytes) -> None:
    with pytest.raises(Refusal, match="header of at most 10000 bytes, all of them there"):
        read_npy(b"\x93NUMPY" + length + 20_000 * b" ", 12)


def test_every_bit_pattern_is_read_without_a_warning() -> None:
    numbers = np.full((2, 12, 12), 0x7F800001, np.uint32).view(np.float32)
    assert np.isnan(read_npy(npy(numbers), 12)).all()
