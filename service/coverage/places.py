"""The places of a coverage task: the caller's, or those that cover a region, and their checks."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from service.coverage.coverage import Coverage
from service.coverage.frame import Cells, Mask
from service.coverage.grid import covering_places, largest_region, region_of, regions
from service.errors import Fault, InvalidCoverage, TooManyPlaces, uncoverable
from service.instance import RouteEnds


@dataclass(frozen=True, eq=False)
class Places:
    """The places that tours go through.

    Attributes:
        cells: Rows and columns, shape (n, 2).
        start: The place at which reported tours begin.
        ends: Whether tours are closed, and the places at which open routes start and end.
        to_visit: The number of places that are the caller's, or that cover a region. They come
            first; the others are the places of poses.
        robots: The places at which each robot starts and ends, if several share the places.
    """

    cells: Cells
    start: int
    ends: RouteEnds
    to_visit: int
    robots: tuple[RouteEnds, ...] = ()


def find_places(coverage: Coverage, free: Mask, max_places: int) -> Places:
    """Return the caller's places, or those that cover a region; and one for a pose without one.

    Args:
        free: The cells free for the robot, shape (rows, columns).

    Raises:
        InvalidCoverage: A place or a pose is not free or cannot be reached, or the second objective
            has another number of places.
        TooManyPlaces: A spacing gives more than `max_places`.
    """
    poses = _pose_cells(coverage, free)
    cells = _given_or_laid_out(coverage, free, poses)
    to_visit = len(cells)
    names = [f"places/{i}" for i in range(to_visit)]
    found: dict[str, int] = {}
    for name, cell in poses.items():
        there = np.flatnonzero((cells == cell).all(axis=1))
        found[name] = int(there[0]) if len(there) else len(cells)
        if not len(there):
            if coverage.has_costs_of_places_alone:
                raise uncoverable(name, "no-costs-there")
            cells, names = np.vstack((cells, cell)), [*names, name]
    if coverage.spacing is not None and len(cells) > max_places:
        raise TooManyPlaces(max_places, len(cells))
    places = _with_ends(coverage, cells, to_visit, found)
    _raise_any(_misfits(coverage, places))
    _raise_any(_unreachable(places, names, free))
    return places


def _with_ends(coverage: Coverage, cells: Cells, to_visit: int, poses: Mapping[str, int]) -> Places:
    """Return the places with the ends of tours; `poses` are the places of the poses, by name."""
    if coverage.robots:
        robots = tuple(robot.ends(part, poses) for part, robot in coverage.robot_parts)
        return Places(cells, robots[0].start or 0, coverage.ends, to_visit, robots)
    start, ends = poses.get("start_pose", coverage.start), coverage.ends
    if not ends.closed:
        at_start, at_end = poses.get("start_pose", ends.start), poses.get("end_pose", ends.end)
        ends = RouteEnds(closed=False, start=at_start, end=at_end)
    return Places(cells, start, ends, to_visit)


def _given_or_laid_out(coverage: Coverage, free: Mask, poses: Mapping[str, Cells]) -> Cells:
    if coverage.places is not None:
        cells = enumerate(coverage.places.tolist())
        _raise_any(f for i, cell in cells for f in _misplaced(coverage, f"places/{i}", cell, free))
        return coverage.places
    assert coverage.spacing is not None
    pose = next(iter(poses.values()), None)
    region = largest_region(free) if pose is None else region_of(free, pose)
    return covering_places(region, coverage.spacing / coverage.cell_size)


def _pose_cells(coverage: Coverage, free: Mask) -> dict[str, Cells]:
    """Return the row and column, shape (2,), of the cell that each pose is in."""
    cells = {}
    for name, (x, y, *_) in coverage.poses.items():
        assert coverage.frame is not None
        cell = coverage.frame.cell(x, y)
        _raise_any(_misplaced(coverage, name, cell, free))
        cells[name] = np.array(cell, dtype=np.int64)
    return cells


def _misplaced(coverage: Coverage, part: str, cell: Sequence[int], free: Mask) -> Iterator[Fault]:
    """Yield the demand on places that a cell does not meet, if there is one."""
    row, column = cell
    shown = f"[{row:.6g}, {column:.6g}]"
    if not (0 <= row < free.shape[0] and 0 <= column < free.shape[1]):
        yield Fault.of(part, "outside-grid", size=coverage.size, given=shown)
    elif coverage.blocked[row, column]:
        yield Fault.of(part, "obstacle", given=shown)
    elif not free[row, column]:
        yield Fault.of(part, "too-close", far_enough=coverage.far_enough, given=shown)


def _misfits(coverage: Coverage, places: Places) -> Iterator[Fault]:
    """Yield the ends of tours that are not places, and sources of costs with wrong sizes."""
    n = len(places.cells)
    ends, most = {"start": places.start, "end": places.ends.end}, n
    if coverage.robots:
        ends, most = {}, places.to_visit
        for part, robot in coverage.robot_parts:
            ends |= {f"{part}/start": robot.start, f"{part}/end": robot.end}
    for name, place in ends.items():
        if place is not None and place >= most:
            yield Fault.of(name, "not-an-index", noun="a place", last=most - 1, came=place)
    _, start, end = places.ends
    if n > 1 and start == end is not None:
        name = "end" if coverage.end_pose is None else "end_pose"
        yield Fault.of(name, "end-place-is-start", came=end)
    for name in ("second_matrix", "second_coordinates"):
        rows = getattr(coverage, name)
        if rows is not None and len(rows) != n:
            yield Fault.of(name, "row-each-place", places=n, came=len(rows))


def _unreachable(places: Places, names: list[str], free: Mask) -> Iterator[Fault]:
    region = regions(free)[tuple(places.cells.T)]
    origin = names[places.start]
    for i in np.flatnonzero(region != region[places.start]):
        yield Fault.of(names[i], "unreachable", other=f"/{origin}")


def _raise_any(faults: Iterable[Fault]) -> None:
    if faults := tuple(faults):
        raise InvalidCoverage(*faults)
