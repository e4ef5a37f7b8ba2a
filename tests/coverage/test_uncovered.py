"""What a tour over a map does not cover: rooms that no path leads to."""

from collections.abc import Iterator

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from paretour import UncoveredRegion

from service.coverage.grid import regions, uncovered

Cell = tuple[int, int]


def within_reach(free: np.ndarray, cell: Cell) -> set[Cell]:
    """All cells that are joined to a cell over sides, found one after the other."""
    found, left = {cell}, [cell]
    while left:
        row, column = left.pop()
        for near in ((row - 1, column), (row + 1, column), (row, column - 1), (row, column + 1)):
            inside = all(0 <= at < side for at, side in zip(near, free.shape, strict=True))
            if inside and free[near] and near not in found:
                found.add(near)
                left.append(near)
    return found


def rooms(free: np.ndarray, left: set[Cell]) -> Iterator[set[Cell]]:
    while left:
        room = within_reach(free, min(left))
        yield room
        left = left - room


@given(st.integers(0, 2**32), st.integers(1, 12), st.integers(1, 12))
def test_every_room_out_of_reach_is_described(seed: int, rows: int, columns: int) -> None:
    random = np.random.default_rng(seed)
    free = random.random((rows, columns)) < random.random()
    free[0, 0] = True
    left = {(int(r), int(c)) for r, c in np.argwhere(free)} - within_reach(free, (0, 0))
    found = uncovered(free, np.array([0, 0]), 0.5)
    expected = sorted(rooms(free, left), key=len, reverse=True)
    assert found.cells == len(left)
    assert found.square_metres == 0.25 * len(left)
    sizes = [region.cells for region in found.regions]
    assert sizes == [len(room) for room in expected][:20]
    by_cell = {cell: room for room in expected for cell in room}
    described = [by_cell[region.cell] for region in found.regions]
    assert len({min(room) for room in described}) == len(described)
    for region, room in zip(found.regions, described, strict=True):
        cells = np.array(sorted(room))
        assert region.cells == len(room)
        box = cells.min(axis=0).tolist(), cells.max(axis=0).tolist()
        assert region.box == tuple(map(tuple, box))


def test_of_very_many_regions_the_largest_are_described() -> None:
    free = np.indices((1000, 1000)).sum(axis=0) % 2 == 0
    free[500, 400:403] = True
    found = uncovered(free, np.array([0, 0]), 1.0)
    assert found.cells == free.sum() - 1
    assert len(found.regions) == 20
    first = found.regions[0]
    assert first.cells == max(np.bincount(regions(free).ravel())[1:])
    assert isinstance(first, UncoveredRegion)
    assert first.cell in {(500, 400), (500, 401), (500, 402), (499, 401), (501, 401)}
