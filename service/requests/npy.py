"""Read matrices from a .npy file: parse the header by a small grammar, check it, read the data.

numpy's own reader hands the header to Python's parser, which is not made for untrusted text.
"""

import re
from math import prod
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.errors import invalid
from service.errors.faults import shorten
from service.objectives import MOST_OBJECTIVES, OBJECTIVES
from service.requests.validation import too_many_cities

_MAGIC = b"\x93NUMPY"
_LENGTH_BYTES = {b"\1\0": 2, b"\2\0": 4}  # of the header's length, by the file's version
_LONGEST_HEADER = 10_000  # bytes, as numpy has it; numpy.save writes 118
_ENTRY = (
    r"'descr'\s*+:\s*+'(?P<descr{0}>[!-&(-~]{{1,16}}+)'"
    r"|'fortran_order'\s*+:\s*+(?P<order{0}>True|False)"
    r"|'shape'\s*+:\s*+\((?P<shape{0}>(?:\s*+[0-9]{{1,10}}+L?\s*+,?){{0,32}}+\s*+)\)"
)
# Three entries in any order. No quantifier that could match in two ways: the time is linear.
_HEADER = re.compile(
    r"\s*+\{\s*+"
    + r"\s*+,\s*+".join(f"(?:{_ENTRY.format(number)})" for number in range(3))
    + r"\s*+,?\s*+\}\s*+"
)
_REAL_NUMBERS = re.compile(r"[<>=|]?(?:f[248]|[iu][1248])")


class _Header(NamedTuple):
    descr: str
    by_columns: bool
    shape: tuple[int, ...]


def read_npy(content: bytes, most_cities: int) -> NDArray[np.float64]:
    """Return the matrices, shape (m, n, n), in a file as numpy.save writes it.

    Raises:
        Refusal: The file is not .npy or is cut short, does not hold two to four square matrices of
            numbers, or its header declares too many cities.
    """
    text, offset = _header_text(content)
    header = _parse_header(text)
    _check_header(header, most_cities)
    dtype = np.dtype(header.descr)
    demanded, came = prod(header.shape) * dtype.itemsize, len(content) - offset
    if came != demanded:
        raise invalid("matrices", "npy-bytes", bytes=demanded, came=came)
    numbers = np.frombuffer(content, dtype, offset=offset)
    with np.errstate(all="ignore"):  # a signalling NaN is refused with all that is not finite
        return numbers.reshape(header.shape, order="F" if header.by_columns else "C").astype(
            np.float64
        )


def _header_text(content: bytes) -> tuple[str, int]:
    """Return the text of the header, and where the numbers begin."""
    start = len(_MAGIC) + 2
    size = _LENGTH_BYTES.get(content[len(_MAGIC) : start])
    if not content.startswith(_MAGIC) or size is None:
        raise invalid("matrices", "npy-version")
    offset = start + size + int.from_bytes(content[start : start + size], "little")
    if offset > min(len(content), start + size + _LONGEST_HEADER):
        raise invalid("matrices", "npy-header-length", limit=_LONGEST_HEADER)
    return content[start + size : offset].decode("latin-1"), offset


def _parse_header(text: str) -> _Header:
    match = _HEADER.fullmatch(text)
    found = {
        name.rstrip("012"): value
        for name, value in (match.groupdict() if match else {}).items()
        if value is not None
    }
    if len(found) < len(_Header._fields):
        raise invalid("matrices", "npy-header", given=shorten(repr(text.strip())))
    shape = tuple(map(int, re.findall(r"[0-9]+", found["shape"])))
    return _Header(found["descr"], found["order"] == "True", shape)


def _check_header(header: _Header, most_cities: int) -> None:
    if not _REAL_NUMBERS.fullmatch(header.descr):
        raise invalid("matrices", "npy-numbers", given=repr(header.descr))
    shape = header.shape
    enough = len(shape) == 3 and OBJECTIVES <= shape[0] <= MOST_OBJECTIVES
    if not enough or shape[1] != shape[2] or shape[1] < 1:
        values = {"least": OBJECTIVES, "most": MOST_OBJECTIVES, "given": shorten(str(shape))}
        raise invalid("matrices", "npy-shape", **values)
    if shape[1] > most_cities:
        raise too_many_cities("matrices", most_cities, shape[1])
