"""k-d trees that find the cities nearest by a weighted sum of the distances in two planes or more.

That sum is a norm of the difference of all coordinates. So the same sum of the distances to a box
in each plane is a lower bound for all cities in it, and a search that leaves out boxes by it is
exact (Bentley, 1975). For each weight there is a tree, whose boxes are cut in two where they are
widest under it. All trees are balanced alike: node i has the children 2 i + 1 and 2 i + 2, and the
nodes of the last level are leaves.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, by_reference, compiled, inlined
from service.search.costs import SIDES, Costs, step_costs
from service.search.selection import select

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

LEAF = 8  # cities, at most, of a leaf
WAITING = 64  # nodes that may wait while a tree is searched: one a level, and one more


@by_reference
class KdTrees(NamedTuple):
    """Trees of the same m cities, one for each of k weights."""

    weights: Array  # (k, 2)
    cities: Cities  # (k, m), leaf by leaf
    begins: Cities  # (leaves + 1,): leaf i has the cities begins[i] to begins[i + 1] - 1 of those
    boxes: Array  # (k, nodes, 2, sides): least and greatest coordinates of a node's cities


class Nearest(NamedTuple):
    """The result of a search for the nearest cities, and scratch space of it."""

    cities: Cities  # (count,)
    costs: Array  # (count,), the weighted costs, ascending
    nodes: Cities  # (WAITING,)
    bounds: Array  # (WAITING,)


class Scratch(NamedTuple):
    """Scratch space to fill a tree of m cities."""

    cities: Cities  # (m,)
    keys: Array  # (m,)
    selected: Array  # (m,)


def make_kd_trees(weights: Array, cities: Cities, sides: int) -> KdTrees:
    """Return trees, still to be filled, of cities, shape (m,), under weights (k, 2).

    `sides` is the number of coordinates of a city.
    """
    m, k = len(cities), len(weights)
    leaves = 1
    while m > LEAF * leaves:
        leaves *= 2
    begins = np.arange(leaves + 1) * m // leaves
    return KdTrees(
        weights,
        np.tile(cities, (k, 1)),
        begins.astype(np.int32),
        np.empty((k, 2 * leaves - 1, 2, sides)),
    )


@allocating
def make_nearest(count: int) -> Nearest:
    """Return room for the `count` nearest cities."""
    return Nearest(
        np.empty(count, np.int32), np.empty(count), np.empty(WAITING, np.int32), np.empty(WAITING)
    )


@allocating
def fill_kd_tree(trees: KdTrees, costs: Costs, k: int) -> None:
    """Put the cities into the tree of weight k, level by level. O(m log m)."""
    order, boxes = trees.cities[k], trees.boxes[k]
    scratch = Scratch(np.empty_like(order), np.empty(len(order)), np.empty(len(order)))
    leaves = len(trees.begins) - 1
    width = leaves  # of a node, in leaves
    node = 0
    while width > 0:
        for leaf in range(0, leaves, width):
            begin, end = trees.begins[leaf], trees.begins[leaf + width]
            part = order[begin:end]
            side = fill_box(boxes[node], costs.cities, part, trees.weights[k])
            if width > 1:
                middle = trees.begins[leaf + width // 2]
                split(part, costs.cities[:, side], middle - begin, scratch)
            node += 1
        width //= 2


@compiled
def split(cities: Cities, coordinates: Array, count: int, scratch: Scratch) -> None:
    """Put the `count` cities with the least coordinates first, and else keep their order. O(m)."""
    m = len(cities)
    for place in range(m):
        city = cities[place]
        scratch.cities[place] = city
        scratch.keys[place] = scratch.selected[place] = coordinates[city]
    middle = select(scratch.selected[:m], count)
    below, equal = 0, 0
    for place in range(m):
        below += scratch.keys[place] < middle
        equal += scratch.keys[place] == middle
    first, second, third = 0, below, below + equal
    for place in range(m):
        city, key = scratch.cities[place], scratch.keys[place]
        if key < middle:
            cities[first] = city
            first += 1
        elif key == middle:
            cities[second] = city
            second += 1
        else:
            cities[third] = city
            third += 1


@compiled
def fill_box(box: Array, coordinates: Array, cities: Cities, weights: Array) -> int:
    """Fill in the box of some cities, and return the side on which it is widest under weights."""
    side, widest = 0, -1.0
    for d in range(coordinates.shape[1]):
        least = greatest = coordinates[cities[0], d]
        for city in cities:
            least = min(least, coordinates[city, d])
            greatest = max(greatest, coordinates[city, d])
        box[0, d], box[1, d] = least, greatest
        width = weights[d // 2 if d < SIDES else 0] * (greatest - least)
        if width > widest:
            side, widest = d, width
    return side


@inlined
def cost_to_box(box: Array, city: Array, w0: float, w1: float) -> float:
    """Return the weighted cost of going to the nearest place of a box."""
    x = max(box[0, 0] - city[0], 0.0, city[0] - box[1, 0])
    y = max(box[0, 1] - city[1], 0.0, city[1] - box[1, 1])
    u = max(box[0, 2] - city[2], 0.0, city[2] - box[1, 2])
    v = max(box[0, 3] - city[3], 0.0, city[3] - box[1, 3])
    first, second = np.sqrt(x * x + y * y), np.sqrt(u * u + v * v)
    if len(city) > SIDES:
        first += distances_to_box_beyond(box, city)
    return w0 * first + w1 * second


@compiled
def distances_to_box_beyond(box: Array, city: Array) -> float:
    """Return the sum of the distances to a box in all planes beyond the second."""
    total = 0.0
    for d in range(SIDES, len(city), 2):
        x = max(box[0, d] - city[d], 0.0, city[d] - box[1, d])
        y = max(box[0, d + 1] - city[d + 1], 0.0, city[d + 1] - box[1, d + 1])
        total += np.sqrt(x * x + y * y)
    return total


@inlined
def insert_smallest(chosen: Cities, chosen_keys: Array, index: int, key: float) -> None:
    """Insert an index into a list of those with the smallest keys, ascending, after equal ones."""
    place = len(chosen) - 1
    if key >= chosen_keys[place]:
        return
    while place > 0 and chosen_keys[place - 1] > key:
        chosen_keys[place] = chosen_keys[place - 1]
        chosen[place] = chosen[place - 1]
        place -= 1
    chosen_keys[place] = key
    chosen[place] = index


@compiled
def find_nearest(trees: KdTrees, costs: Costs, k: int, city: int, found: Nearest) -> None:
    """Find the other cities nearest to a city under weight k; of equally near ones any."""
    w0, w1 = trees.weights[k, 0], trees.weights[k, 1]
    inner = len(trees.begins) - 2  # nodes that are not leaves
    found.costs[:] = np.inf
    found.nodes[0], found.bounds[0], waiting = 0, 0.0, 1
    while waiting > 0:
        waiting -= 1
        node = found.nodes[waiting]
        if found.bounds[waiting] >= found.costs[-1]:
            continue
        if node >= inner:
            for place in range(trees.begins[node - inner], trees.begins[node - inner + 1]):
                other = trees.cities[k, place]
                if other != city:
                    first, second = step_costs(costs, city, other)
                    insert_smallest(found.cities, found.costs, other, w0 * first + w1 * second)
            continue
        near, far = 2 * node + 1, 2 * node + 2
        near_bound = cost_to_box(trees.boxes[k, near], costs.cities[city], w0, w1)
        far_bound = cost_to_box(trees.boxes[k, far], costs.cities[city], w0, w1)
        if far_bound < near_bound:
            near, far, near_bound, far_bound = far, near, far_bound, near_bound
        found.nodes[waiting], found.bounds[waiting] = far, far_bound
        found.nodes[waiting + 1], found.bounds[waiting + 1] = near, near_bound
        waiting += 2
