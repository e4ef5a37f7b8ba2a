"""Read maps in PNG files: check a file chunk by chunk, then decode the chunks of the picture.

The decoder gets these chunks alone, with one header: a second header, which some decoders obey, is
refused. So is a size over the limit, before a pixel is unpacked.
"""

import struct
from collections.abc import Iterator
from io import BytesIO

import numpy as np
from numpy.typing import NDArray

from service.errors import Refusal, invalid
from service.errors.faults import shorten
from service.requests.arrays import check_size

SIGNATURE = b"\x89PNG\r\n\x1a\n"
_LENGTH = struct.Struct(">I")
_SIZE = struct.Struct(">II")
_HEADER_LENGTH = 13
_BESIDE_CONTENT = 12  # bytes of a chunk: its length, its kind and its checksum
_PICTURE = (b"IHDR", b"PLTE", b"IDAT", b"IEND")
_MOST_CHUNKS = 20_000  # a large map has some thousand
_DEEP_GREY = "I;16"  # Pillow's mode of 16 bits a pixel
# Pillow's other modes, and that in which their channels are a byte each.
_MODES = {"1": "L", "L": "L", "LA": "LA", "P": "RGB", "RGB": "RGB", "RGBA": "RGBA"}


def read_png(content: bytes, most_cells: int) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """Return the channels of a picture, shape (rows, columns, channels).

    They are grey, grey and alpha, three colours, or three colours and alpha, of 8 bits; grey alone
    may have 16 bits. The transparency of a palette is not read.

    Args:
        content: The file, which begins with the signature of PNG.
        most_cells: The most pixels.

    Raises:
        Refusal: The file cannot be read as PNG, or has too many cells.
    """
    chunks = [(kind, whole) for kind, whole in _chunks(content) if kind in _PICTURE]
    _check_header([whole for kind, whole in chunks if kind == b"IHDR"], chunks, most_cells)
    picture = SIGNATURE + b"".join(whole for _, whole in chunks)
    try:
        return _decode(picture, most_cells)
    except (Refusal, MemoryError):
        raise
    # The decoder is not ours, and raises a dozen kinds of exceptions over broken files.
    except Exception as error:
        said, *_ = str(error).partition(" <")  # some name our stream, with its address
        reason = shorten(said or type(error).__name__)
        raise invalid("grid", "png-unreadable", given=reason) from None


def _decode(picture: bytes, most_cells: int) -> NDArray[np.uint8] | NDArray[np.uint16]:
    from PIL import Image  # imported late: few requests have a map

    with Image.open(BytesIO(picture), formats=["PNG"]) as image:
        check_size(*image.size, most_cells)  # what the decoder is going to unpack
        if image.mode not in (*_MODES, _DEEP_GREY):
            raise invalid("grid", "png-colours", given=image.mode)
        size = image.size
        image.load()
        if image.size != size:
            raise invalid("grid", "png-sizes", given=f"{size} and {image.size}")
        if image.mode == _DEEP_GREY:
            return np.asarray(image, np.uint16)[:, :, np.newaxis]
        channels = np.asarray(image.convert(_MODES[image.mode]))
    return channels if channels.ndim == 3 else channels[:, :, np.newaxis]


def _check_header(headers: list[bytes], chunks: list[tuple[bytes, bytes]], most: int) -> None:
    """Raise a refusal unless the file begins with its only header, and it has few enough cells."""
    if len(headers) != 1 or chunks[0][1] is not headers[0]:
        raise invalid("grid", "png-headers", came=len(headers))
    if len(headers[0]) != _HEADER_LENGTH + _BESIDE_CONTENT:
        raise invalid("grid", "png-header-length", bytes=_HEADER_LENGTH)
    width, height = _SIZE.unpack_from(headers[0], 8)
    check_size(width, height, most)


def _chunks(content: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Yield the kind of each chunk and all of its bytes, up to IEND or where the file is cut."""
    at = len(SIGNATURE)
    for _ in range(_MOST_CHUNKS):
        if at + _BESIDE_CONTENT > len(content):
            return
        end = at + _BESIDE_CONTENT + _LENGTH.unpack_from(content, at)[0]
        kind = content[at + 4 : at + 8]
        yield kind, content[at:end]
        if kind == b"IEND":
            return
        at = end
    raise invalid("grid", "png-chunks", limit=_MOST_CHUNKS)
