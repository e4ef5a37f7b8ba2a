"""Search of one weighted sum over the day from several tours, and from what they have in common.

Each of a few parents is a local optimum. A child has a part of one of them, and the other cities in
the order of another (order crossover: Davis, 1985). It is improved, and takes the place of the
worst parent. With few stops this finds the best tour sooner than changes of a single one.
"""

from service.jit import compiled
from service.over_the_day.descent import WeightedSearch, descend_fully, iterate, keep, save
from service.over_the_day.moves import load
from service.search.local_search import random_below

CHANGES = 20  # of each child
_PATIENCE = 100  # children in a row that are no better than the worst parent
_SAME = 1e-9  # relative difference of the values of tours that count as the same


@compiled
def breed(search: WeightedSearch, children: int) -> None:
    """Try a number of children, or of tours to begin with."""
    for _ in range(children):
        admit(search)
        if search.bred[0] < len(search.parents):
            shuffle(search)
        else:
            cross(search)
        load(search.walk, search.traffic, search.weights, search.kept, search.saved_value[1])
        search.dirty[:] = True
        descend_fully(search)
        if search.walk.value[0] < search.saved_value[0]:
            save(search)
        else:
            keep(search)
        iterate(search, CHANGES)


@compiled
def admit(search: WeightedSearch) -> None:
    """Let the tour that is kept be a parent, if it is better than the worst one and new.

    After many that are not, there are no parents any more.
    """
    value, count, worst = search.kept_value[0], search.bred[0], 0
    refused = False
    for parent in range(count):
        refused |= abs(search.parent_values[parent] - value) <= _SAME * value
        if search.parent_values[parent] > search.parent_values[worst]:
            worst = parent
    if count < len(search.parents):
        worst = count
    else:
        refused |= value > search.parent_values[worst]
    if refused:
        search.bred[1] += 1
        if search.bred[1] > _PATIENCE:
            search.bred[:] = 0
        return
    search.bred[0], search.bred[1] = max(count, worst + 1), 0
    search.parent_values[worst] = value
    for place in range(len(search.kept)):
        search.parents[worst, place] = search.kept[place]


@compiled
def shuffle(search: WeightedSearch) -> None:
    """Put the cities of the kept tour that may change places in a random order."""
    lowest, highest = search.places
    for place in range(highest - 1, lowest, -1):
        other = lowest + random_below(search.random, place + 1 - lowest)
        city = search.kept[place]
        search.kept[place] = search.kept[other]
        search.kept[other] = city


@compiled
def cross(search: WeightedSearch) -> None:
    """Make the kept tour a child of two parents."""
    lowest, highest = search.places
    count = highest - lowest
    first = random_below(search.random, len(search.parents))
    second = random_below(search.random, len(search.parents) - 1)
    second += second >= first
    begin = random_below(search.random, count)
    end = begin + 1 + random_below(search.random, count - 1)
    search.dirty[:] = False  # here: whether a city stands in the child
    for step in range(begin, end):
        place = lowest + step % count
        search.kept[place] = search.parents[first, place]
        search.dirty[search.kept[place]] = True
    free = end
    for step in range(end, end + count):
        city = search.parents[second, lowest + step % count]
        if not search.dirty[city]:
            search.kept[lowest + free % count] = city
            free += 1
