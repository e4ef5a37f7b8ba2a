"""Maps as PNG files. The size that a file declares is checked before anything is decoded."""

import struct
from io import BytesIO

import numpy as np
from PIL import Image, UnidentifiedImageError

from service.errors import Fault, Refusal
from service.requests.arrays import Array, invalid

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
        sentence = f"grid must have at most {most} cells, got {height} x {width}"
        fault = Fault(pointer="/grid", detail=sentence)
        raise Refusal(
            413, "too-many-cells", sentence, errors=[fault], limit=most, actual=width * height
        )
    try:
        with Image.open(BytesIO(content), formats=["PNG"]) as image:
            if image.mode not in _MODES:
                raise invalid("grid", f"must have 8 bits a channel or fewer, got {image.mode}")
            shades = np.asarray(image.convert("L"))
    except (OSError, SyntaxError, ValueError, UnidentifiedImageError) as error:
        raise invalid("grid", f"must be a PNG file that can be read: {error}") from None
    return (shades < _DARK).astype(np.float64)
