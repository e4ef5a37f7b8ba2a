"""Hypervolumes of points of three or four objectives, in compiled code.

Lengths are shares of the reference point, so that this is 1 in each. By sweeps: of three objectives
along the third, over a staircase of the points so far (Fonseca, Paquete and López-Ibáñez, 2006);
of four along the fourth, by the volume of three at each step.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import compiled, inlined

Array = NDArray[np.float64]


class Sweep(NamedTuple):
    """Scratch space for the volume of k points."""

    points: Array  # (k, m), ascending by the last length
    stairs: Array  # (k + 1, 2), ascending by the first length, so descending by the second
    front: Array  # (k, 3): of four objectives, the points so far but for the last length


def make_sweep(size: int, objectives: int) -> Sweep:
    """Return scratch space for up to `size` points."""
    return Sweep(np.empty((size, objectives)), np.empty((size + 1, 2)), np.empty((size, 3)))


def volume(shares: Array) -> float:
    """Return the hypervolume of points, shape (k, m), in shares of the reference point, 0 to 1.

    O(k log k) of three objectives but for moving the stairs, O(k^2 log k) of four.
    """
    inside = shares[(shares < 1).all(axis=1)]
    sweep = make_sweep(len(inside), shares.shape[1])
    sweep.points[:] = inside[np.argsort(inside[:, -1], kind="stable")]
    return float(volume_of(sweep, len(inside)))


@compiled
def volume_of(sweep: Sweep, size: int) -> float:
    """Return the hypervolume of the first `size` points, all below 1."""
    if sweep.points.shape[1] == 3:
        return volume_of_three(sweep.points, sweep.stairs, size)
    return volume_of_four(sweep, size)


@compiled
def volume_of_three(points: Array, stairs: Array, size: int) -> float:
    """Return the hypervolume of points of three objectives, ascending by the third."""
    total, area, steps = 0.0, 0.0, 0
    for k in range(size):
        added, steps = add_step(stairs, steps, points[k, 0], points[k, 1])
        area += added
        above = points[k + 1, 2] if k + 1 < size else 1.0
        total += area * (above - points[k, 2])
    return total


@compiled
def add_step(stairs: Array, steps: int, x: float, y: float) -> tuple[float, int]:
    """Add a point to the stairs; return by how much the area above them grew, and their number."""
    begin = steps_left_of(stairs, steps, x)
    ceiling = stairs[begin - 1, 1] if begin > 0 else 1.0
    if ceiling <= y or (begin < steps and stairs[begin, 0] == x and stairs[begin, 1] <= y):
        return 0.0, steps
    added, left, end = 0.0, x, begin
    while end < steps and stairs[end, 1] >= y:
        added += (stairs[end, 0] - left) * (ceiling - y)
        left, ceiling = stairs[end, 0], stairs[end, 1]
        end += 1
    right = stairs[end, 0] if end < steps else 1.0
    added += (right - left) * (ceiling - y)
    move_steps(stairs, steps, end, begin + 1)
    stairs[begin, 0], stairs[begin, 1] = x, y
    return added, steps + begin + 1 - end


@inlined
def steps_left_of(stairs: Array, steps: int, x: float) -> int:
    """Return how many steps lie left of x."""
    low, high = 0, steps
    while low < high:
        middle = (low + high) >> 1
        if stairs[middle, 0] < x:
            low = middle + 1
        else:
            high = middle
    return low


@inlined
def move_steps(stairs: Array, steps: int, begin: int, target: int) -> None:
    """Move the steps from `begin` on to a place that is at most one further."""
    if target > begin:
        for k in range(steps - 1, begin - 1, -1):
            stairs[k + 1, 0], stairs[k + 1, 1] = stairs[k, 0], stairs[k, 1]
    elif target < begin:
        for k in range(begin, steps):
            to = k + target - begin
            stairs[to, 0], stairs[to, 1] = stairs[k, 0], stairs[k, 1]


@compiled
def volume_of_four(sweep: Sweep, size: int) -> float:
    """Return the hypervolume of points of four objectives, ascending by the fourth."""
    total, below, kept, changed = 0.0, 0.0, 0, False
    for k in range(size):
        grown = keep_sorted(sweep.front, kept, sweep.points, k)
        if grown >= 0:
            kept, changed = grown, True
        height = (sweep.points[k + 1, 3] if k + 1 < size else 1.0) - sweep.points[k, 3]
        if changed and height > 0.0:  # many have the same last length, if cut at that of a point
            below, changed = volume_of_three(sweep.front, sweep.stairs, kept), False
        total += below * height
    return total


@compiled
def keep_sorted(front: Array, kept: int, points: Array, k: int) -> int:
    """Add point k to a front of three lengths, sorted by the third, and drop what it dominates.

    Returns how many points the front has then; -1 where one of them dominates or equals point k.
    """
    x, y, z = points[k, 0], points[k, 1], points[k, 2]
    for j in range(kept):
        if front[j, 0] <= x and front[j, 1] <= y and front[j, 2] <= z:
            return -1
    left = 0
    for j in range(kept):
        if not (front[j, 0] >= x and front[j, 1] >= y and front[j, 2] >= z):
            for m in range(3):
                front[left, m] = front[j, m]
            left += 1
    place = left
    while place > 0 and front[place - 1, 2] > z:
        for m in range(3):
            front[place, m] = front[place - 1, m]
        place -= 1
    front[place, 0], front[place, 1], front[place, 2] = x, y, z
    return left + 1
