"""`python -m tests.helpers.world FOLDER`: write the map of the world that the page draws.

Coasts, lakes, borders and towns are those of Natural Earth at 1:10 million (naturalearthdata.com),
which is in the public domain. The folder holds its `ne_10m_land.shp`, `ne_10m_lakes.shp` and
`ne_10m_admin_0_boundary_lines_land.shp`, and `towns.csv`: name, longitude and latitude of its
`ne_10m_populated_places_simple`, the largest first.

Corners that hardly change a line are left out (Visvalingam and Whyatt, 1993), but fewer of them
near large towns, where most stops are.
"""

import argparse
import csv
import heapq
import struct
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

WORLD = Path(__file__).parents[2] / "service/page/map/world.bin"
MOST_BYTES = 300_000
STEP = 1 / 1000  # degrees: some hundred metres
LAYERS = ("ne_10m_land.shp", "ne_10m_lakes.shp", "ne_10m_admin_0_boundary_lines_land.shp")
CLOSED = (True, True, False)
TOWNS = 4500  # of 7,342, which have their names on the map
LARGE = 1500  # towns with many corners around them
NEAR = 25.0  # km from a large town, within which a corner counts as much as it can
FAR = 20.0  # the most times that a corner elsewhere must be as long
KM = 111.2  # in a degree of latitude

Line = NDArray[np.float64]  # of shape (n, 2): longitude and latitude


def lines_of(path: Path) -> Iterator[Line]:
    """Read the rings or lines of a shapefile (ESRI's description of July 1998)."""
    data, at = path.read_bytes(), 100
    while at < len(data):
        (words,) = struct.unpack_from(">i", data, at + 4)
        content, at = at + 8, at + 8 + 2 * words
        parts, points = struct.unpack_from("<2i", data, content + 36)
        starts = struct.unpack_from(f"<{parts}i", data, content + 44)
        places = np.frombuffer(data, "<f8", 2 * points, content + 44 + 4 * parts).reshape(-1, 2)
        yield from np.split(places, starts[1:])


def joined(lines: list[Line]) -> list[Line]:
    """Return lines that continue each other as one."""
    at_end = defaultdict(set)
    for number, line in enumerate(lines):
        for end in (line[0], line[-1]):
            at_end[tuple(end)].add(number)
    found, left = [], dict(enumerate(lines))
    while left:
        _, line = left.popitem()
        for _ in range(2):  # on from its end, and then from its start
            while following := sorted(at_end[tuple(line[-1])] & left.keys()):
                part = left.pop(following[0])
                turned = part if (part[0] == line[-1]).all() else part[::-1]
                line = np.concatenate([line, turned[1:]])
            line = line[::-1]
        found.append(line)
    return found


def weights_of(line: Line, towns: cKDTree) -> NDArray[np.float64]:
    """Return what each corner counts: 1 near a town, and less the farther it is."""
    far, _ = towns.query(on_sphere(line))
    return np.clip(NEAR / np.maximum(6371 * far, NEAR), 1 / FAR, 1) ** 2


def on_sphere(places: Line) -> NDArray[np.float64]:
    """Return the places on the sphere of radius 1, of shape (n, 3)."""
    east, north = np.radians(places).T
    return np.stack([np.cos(north) * np.cos(east), np.cos(north) * np.sin(east), np.sin(north)], 1)


def worth_of(line: Line, closed: bool, weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return for each corner the area in km2, times its weight, below which it is left out.

    A corner is never worth less than one that is left out before it. Both ends of an open line
    stay, and a ring is as large as its last triangle.
    """
    shrunk = np.maximum(np.cos(np.radians(line[:, 1])), 0.1)  # Antarctica ends in the pole
    x, y = line[:, 0] * shrunk * KM, line[:, 1] * KM
    n = len(line)
    before, after = list(range(-1, n - 1)), list(range(1, n + 1))
    if closed:
        before[0], after[-1] = n - 1, 0
    worth = np.full(n, np.inf)

    def area(at: int) -> float:
        left, right = before[at], after[at]
        twice = (x[left] - x[at]) * (y[right] - y[at]) - (x[right] - x[at]) * (y[left] - y[at])
        return abs(float(twice)) / 2 * float(weights[at])

    queue = [(area(at), at) for at in range(n) if before[at] >= 0 and after[at] < n]
    current = {at: value for value, at in queue}
    heapq.heapify(queue)
    least, left_over = 0.0, n
    while queue and left_over > (2 if closed else 0):
        value, at = heapq.heappop(queue)
        if current.get(at) != value:
            continue
        least = max(least, value)
        worth[at] = least
        del current[at]
        left_over -= 1
        left, right = before[at], after[at]
        after[left], before[right] = right, left
        for beside in (left, right):
            if beside in current:
                current[beside] = area(beside)
                heapq.heappush(queue, (current[beside], beside))
    return worth


def varints(values: NDArray[np.int64]) -> bytes:
    """Encode signed integers as LEB128 of their zigzag code."""
    written = bytearray()
    for value in values.tolist():
        rest = value << 1 if value >= 0 else ~value << 1 | 1
        while rest > 127:
            written.append(rest & 127 | 128)
            rest >>= 7
        written.append(rest)
    return bytes(written)


def encoded(lines: list[Line]) -> bytes:
    """Encode lines: their number, and for each the number of corners and the steps between them."""
    parts = [varints(np.array([len(lines)]))]
    at = np.zeros(2, int)
    for line in lines:
        steps = np.rint(line / STEP).astype(int)
        parts.append(varints(np.array([len(steps)])))
        parts.append(varints(np.diff(steps, axis=0, prepend=at[None]).ravel()))
        at = steps[-1]
    return b"".join(parts)


def thinned(
    lines: list[Line], worths: list[NDArray[np.float64]], least: float, closed: bool
) -> list[Line]:
    """Return the lines without the corners that are worth less, and without the smallest rings."""
    kept = [line[worth >= least] for line, worth in zip(lines, worths, strict=True)]
    return [line for line in kept if len(line) > (2 if closed else 1)]


def towns_of(folder: Path) -> tuple[list[str], Line]:
    """Read the names and places of the towns, the largest first."""
    with (folder / "towns.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    places = [[float(row["longitude"]), float(row["latitude"])] for row in rows]
    return [row["name"] for row in rows], np.array(places)


def encoded_towns(names: list[str], places: Line) -> bytes:
    """Encode towns: their number, and for each the steps from the one before, and its name."""
    steps = np.diff(np.rint(places / STEP).astype(int), axis=0, prepend=[[0, 0]])
    parts = [varints(np.array([len(names)]))]
    for name, step in zip(names, steps, strict=True):
        said = name.encode()
        parts.append(varints(np.array([*step, len(said)])) + said)
    return b"".join(parts)


def world(folder: Path) -> bytes:
    """Return the map, with as many corners as fit."""
    names, places = towns_of(folder)
    towns = cKDTree(on_sphere(places[:LARGE]))
    layers = [list(lines_of(folder / name)) for name in LAYERS]
    layers = [
        [line[:-1] for line in lines] if closed else joined(lines)
        for lines, closed in zip(layers, CLOSED, strict=True)
    ]
    worths = [
        [worth_of(line, closed, weights_of(line, towns)) for line in lines]
        for lines, closed in zip(layers, CLOSED, strict=True)
    ]
    last = encoded_towns(names[:TOWNS], places[:TOWNS])

    def written(least: float) -> bytes:
        drawn = zip(layers, worths, CLOSED, strict=True)
        return (
            b"".join(encoded(thinned(lines, worth, least, c)) for lines, worth, c in drawn) + last
        )

    low, high = 1e-4, 1e3  # km2
    while high / low > 1.01:
        middle = (low * high) ** 0.5
        low, high = (middle, high) if len(written(middle)) > MOST_BYTES else (low, middle)
    print(f"corners below {high:.2f} km2 are left out")
    return written(high)


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser("python -m tests.helpers.world", description=__doc__)
    parser.add_argument("folder", type=Path, help="of the files of Natural Earth")
    data = world(parser.parse_args().folder)
    WORLD.write_bytes(data)


if __name__ == "__main__":
    main()
