"""`python -m tests.benchmarks detours`: fronts over maps on which paths give up metres for cost.

The offices are our own: 20 x 20 metres in cells of 0.1 m, rooms of 4 x 4 m with doors of 0.9 m in
the middle of their walls, and two corridors of 4 m where people walk: there a metre costs twenty
and ten times as much as elsewhere. Places are drawn from the free cells. The warehouse is that of
the page's examples, with places every three metres or every metre.

Each task is planned by shortest paths alone and with detours, in one second each, by
`paretour.plan_coverage`. Prints the hypervolume of either front in the box that both fronts span,
by how much the least cost falls, how wide the fronts are in metres, and the seconds until all paths
between places are found. Every path is checked: its steps add up to the lengths of its tour.
"""

import argparse
from functools import partial
from typing import Any

import numpy as np
import paretour
from numpy.typing import NDArray

from service.coverage.grid import free_cells
from service.pareto import hypervolume
from tests.benchmarks.cells import of
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load
from tests.benchmarks.rows import resume
from tests.examples import warehouse

Array = NDArray[np.float64]
SECONDS = 1.0
SIDE, ROOM, CELL, RADIUS = 200, 40, 0.1, 0.2  # cells, cells, metres, metres
PLACES = (6, 12, 30, 100)
SPACINGS = (3.0, 1.0)  # metres
_MARGIN = 1e-9  # of a box: a point on its border counts


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks detours", description=__doc__)
    parser.add_argument("--count", type=int, default=10, help="offices of each number of places")
    options = parser.parse_args(arguments)
    compared(office(6, 0))  # compiled before it is timed
    for n in PLACES:
        tasks = [office(n, seed) for seed in range(options.count)]
        resume("detours", f"office, {n} places", "", tasks, compared)
    for spacing in SPACINGS:
        task = {**warehouse.cleaning(), "spacing": spacing}
        resume("detours", f"warehouse, every {spacing:g} m", "", [task], compared)
    print(table(*rows()))


def office(n: int, seed: int) -> dict[str, Any]:
    """The request of n places in the office, drawn with this seed."""
    grid = np.zeros((SIDE, SIDE), np.int64)
    walls = range(ROOM, SIDE, ROOM)
    grid[walls], grid[:, walls] = 1, 1
    for wall in walls:
        for middle in range(ROOM // 2, SIDE, ROOM):
            door = slice(middle - 4, middle + 5)
            grid[wall, door] = grid[door, wall] = 0
    people = np.full(grid.shape, 0.1)
    corridor = slice((SIDE - ROOM) // 2, (SIDE + ROOM) // 2)
    people[corridor] = 2.0
    people[:, corridor] = 1.0
    free = np.argwhere(free_cells(grid > 0, CELL, RADIUS))
    places = np.random.default_rng([n, seed]).choice(free, n, replace=False)
    return {
        "grid": grid.tolist(),
        "cell_size": CELL,
        "robot_radius": RADIUS,
        "places": places.tolist(),
        "cost_layer": people.tolist(),
    }


def compared(task: dict[str, Any]) -> dict[str, Any]:
    """Both fronts of a task: hypervolumes in their box, least costs, widths and seconds."""
    options = {**task, "paths": True, "time_limit": SECONDS, "seed": 1}
    fronts = [
        paretour.plan_coverage(**{**options, "detours": detours}) for detours in (False, True)
    ]
    for front in fronts:
        _check(front, task)
    points = [front.lengths for front in fronts]
    both = np.concatenate(points)
    least, span = both.min(axis=0), np.maximum(np.ptp(both, axis=0), _MARGIN * both.max(axis=0))
    box = np.full(2, 1 + _MARGIN)
    return {
        "hypervolume": [
            round(100 * hypervolume(np.maximum((each - least) / span, 0.0), box), 2)
            for each in points
        ],
        "tours": [len(each) for each in points],
        "less cost": round(100 * (1 - points[1][:, 1].min() / points[0][:, 1].min()), 2),
        "wider by metres": [
            round(100 * (each[:, 0].max() / each[:, 0].min() - 1), 2) for each in points
        ],
        "paths": [round(front.document["timings_ms"]["survey"] / 1000, 3) for front in fronts],
    }


def _check(front: paretour.Front, task: dict[str, Any]) -> None:
    """Raise an error where the steps of a path do not add up to the lengths of its tour."""
    layer = np.array(task["cost_layer"])
    assert front.paths is not None
    for path, lengths in zip(front.paths, front.lengths, strict=True):
        steps = task["cell_size"] * np.hypot(*np.diff(path.cells, axis=0).T)
        costs = layer[tuple(path.cells.T)]
        added = [steps.sum(), (steps * (costs[1:] + costs[:-1]) / 2).sum()]
        np.testing.assert_allclose(added, lengths, rtol=1e-9)


def rows() -> tuple[list[str], list[list[str]]]:
    """The table of what is stored."""
    head = ["map", "hypervolume by shortest paths, %", "with detours", "least cost lower by"]
    head += ["front as wide as, in metres", "with detours", "paths found in", "with detours"]
    return head, [
        [key, *_numbers(of(entry))] for key, entry in load("detours").items() if of(entry)
    ]


def _numbers(entries: list[dict[str, Any]]) -> list[str]:
    """The means of all instances."""
    mean = partial(np.mean, axis=0)
    shares, widths, seconds = (
        mean([each[name] for each in entries])
        for name in ("hypervolume", "wider by metres", "paths")
    )
    less = mean([each["less cost"] for each in entries])
    return [
        *(f"{share:.1f}" for share in shares),
        f"{less:.1f} %",
        *(f"{width:.1f} %" for width in widths),
        *(f"{each:.2f} s" for each in seconds),
    ]
