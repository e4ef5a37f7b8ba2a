"""Read maps of the MovingAI benchmarks: `type octile`, and a character for each cell.

Sturtevant, "Benchmarks for Grid-Based Pathfinding" (2012), https://movingai.com/benchmarks/formats.
Cells `.`, `G` and `S` are free. Trees, walls and what is out of bounds are obstacles, and so is
water: no step leads from land into it.
"""

import re

import numpy as np

from service.files.reading import FileTooLarge, Source
from service.files.texts import text_of

_HEADER = re.compile(
    r"\s*type\s+octile\s+height\s+(\d{1,9})\s+width\s+(\d{1,9})\s+map[^\S\n]*\r?\n", re.ASCII
)
_LONGEST_HEADER = 200  # characters
_FREE, _BLOCKED = ".GS", "@OTW"


def is_octile(data: bytes) -> bool:
    """Return whether a file begins as a map of MovingAI does."""
    return _HEADER.match(data[:_LONGEST_HEADER].decode("latin-1")) is not None


def read_octile(source: Source) -> list[list[int]]:
    """Return the grid of a map of MovingAI: 0 where it is free, 1 an obstacle.

    Raises:
        UnreadableFile: It has too many cells, rows of another number or length than its header
            says, or other characters.
    """
    text = text_of(source)
    source.spend_on_lines(text, 1)
    header = _HEADER.match(text[:_LONGEST_HEADER])
    assert header is not None
    height, width = int(header[1]), int(header[2])
    most = source.bounds.cells
    if not 0 < height * width <= most:
        came = f"{height} x {width}"
        raise FileTooLarge(source.fault("number-of-cells", most=most, given=came))
    rows = text[header.end() :].split("\n")
    while rows and not rows[-1].strip():
        rows.pop()
    if len(rows) != height:
        raise source.refusal("other-rows", rows=height, came=len(rows))
    for number, row in enumerate(rows, 1):
        if len(row) != width:
            raise source.refusal("other-cells", row=number, cells=width, came=len(row))
        if wrong := set(row) - {*_FREE, *_BLOCKED}:
            known = f"{_FREE}{_BLOCKED}"
            raise source.refusal("unknown-cell", row=number, known=known, came=min(wrong))
    cells = np.array([list(row) for row in rows])
    return np.isin(cells, list(_BLOCKED)).astype(int).tolist()
