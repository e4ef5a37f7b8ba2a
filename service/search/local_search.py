"""Local search under one weighted sum: descent, and iterated local search."""

import numpy as np
from numpy.typing import NDArray

from service.jit import compiled, inlined, standalone
from service.search.archive.insertion import accepts, insert
from service.search.archive.layout import is_sorted
from service.search.candidates import Scalarization
from service.search.closing import is_kept, is_open
from service.search.costs import lengths, sum_lengths
from service.search.moves import apply_move, block_swap, length_change, or_opt, two_opt
from service.search.state import SearchState
from service.search.working_tour import (
    QueuedTour,
    WorkingTour,
    dequeue,
    enqueue,
    restore,
    save,
    wrap,
)

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

LONGEST_BLOCK = 50  # cities that a perturbation moves at once
KICKS_PER_END = 8  # one kick in eight of an open route is at an end of it
NO_END = 1 << 62  # cities: more than any descent takes from its queue
LEAST_GAIN = 2.0**-46  # as a share of the weighted length, above what rounding adds to a gain
LEAST_OF_LARGEST = 2.0**-48  # the same of the largest cost, which a tour may have in between
SPIKE = 16.0  # times a length: if it has been that long in between, it is summed afresh


@inlined
def random_below(state: NDArray[np.int64], count: int) -> int:
    """Draw a whole number from 0 to count - 1, count below 2**31, by xorshift (Marsaglia, 2003)."""
    x = state[0]
    x ^= x << 13
    x ^= (x >> 7) & ((1 << 57) - 1)  # a logical shift: the sign bit is masked out
    x ^= x << 17
    state[0] = x
    return int((x >> 33) & 0x7FFFFFFF) % count


@compiled
def least_gain(scalarization: Scalarization, value: float) -> float:
    """Return what a move must gain at least in a tour of this weighted length.

    What seems to gain less may be rounding, and the search could go round in circles.
    """
    largest = scalarization.costs.largest
    most = scalarization.w0 * largest[0] + scalarization.w1 * largest[1]
    return LEAST_GAIN * value + LEAST_OF_LARGEST * most


@inlined
def improve_at(
    working: WorkingTour, scalarization: Scalarization, city: int, threshold: float
) -> bool:
    """Make the best move at a city if it gains more than a threshold; return whether one did."""
    if scalarization.costs.symmetric:
        move = or_opt(working, scalarization, city, threshold)
        other = two_opt(working, scalarization, city, move[0])
        if other[2]:
            move = other
    else:
        move, _ = block_swap(working, scalarization, city, threshold)
    if move[2] == 0:
        return False
    make_move(working, scalarization, move[1], move[2], move[3], move[4])
    enqueue(working, city)
    return True


@inlined
def make_move(
    working: WorkingTour, scalarization: Scalarization, start: int, a: int, b: int, flip: bool
) -> None:
    """Make a move and update both lengths."""
    delta = length_change(working, scalarization, start, a, b, flip)
    apply_move(working, start, a, b, flip)
    working.length[0] += delta[0]
    working.length[1] += delta[1]


@inlined
def removes_kept_step(working: QueuedTour, closing: Array, start: int, a: int, b: int) -> bool:
    """Return whether a swap of two blocks removes a step that has to stay in the tour."""
    tour, n = working.tour, len(working.tour)
    return (
        is_kept(closing, tour[wrap(start - 1, n)], tour[start])
        or is_kept(closing, tour[wrap(start + a - 1, n)], tour[wrap(start + a, n)])
        or is_kept(closing, tour[wrap(start + a + b - 1, n)], tour[wrap(start + a + b, n)])
    )


@inlined
def often_at_an_end(working: QueuedTour, random: NDArray[np.int64], start: int, size: int) -> int:
    """Return a position in a route for `size` cities: `start`, or often that beside an end.

    Which cities are the best ends is found late where they change as seldom as any other step.
    """
    if random_below(random, KICKS_PER_END) > 0:
        return start
    place = working.position[0]  # of the invented city, after a route's last city
    beside = place + 1 if random_below(random, 2) else place - size
    return wrap(beside, len(working.tour))


@inlined
def draw_swap(
    working: QueuedTour, scalarization: Scalarization, random: NDArray[np.int64]
) -> tuple[int, int, int]:
    """Draw a swap of two adjacent blocks of random sizes, at a random place or an end of a route.

    Returns the position of the first block, and the sizes of both.
    """
    n = len(working.tour)
    longest = min(LONGEST_BLOCK, n // 3)
    start = random_below(random, n)
    a, b = 1 + random_below(random, longest), 1 + random_below(random, longest)
    closing = scalarization.costs.closing
    if is_open(closing):
        start = often_at_an_end(working, random, start, a + b)
        while removes_kept_step(working, closing, start, a, b):
            start = random_below(random, n)
    return start, a, b


@inlined
def perturb(working: WorkingTour, scalarization: Scalarization, random: NDArray[np.int64]) -> None:
    """Swap two adjacent blocks of random sizes at a random place, or at an end of a route."""
    start, a, b = draw_swap(working, scalarization, random)
    make_move(working, scalarization, start, a, b, False)


@compiled
def offer(state: SearchState, working: QueuedTour) -> bool:
    """Offer a tour to the archive, and return whether it was inserted.

    Its lengths are summed afresh, as updates gather rounding errors. Of two objectives they are
    known, but for that: there they are summed only where they would be accepted.
    """
    archive = state.archive
    if is_sorted(archive) and not accepts(archive, working.length):
        return False
    sum_lengths(state.costs, working.tour, archive.lengths)
    if is_sorted(archive):
        working.length[0], working.length[1] = archive.lengths[0], archive.lengths[1]
    return insert(archive, archive.lengths, working.tour)


@inlined
def spiked(working: QueuedTour, first: float, second: float) -> bool:
    """Return whether a length is so far above one before that its rounding error would be too."""
    return working.length[0] > SPIKE * first or working.length[1] > SPIKE * second


@compiled
def sum_afresh(working: QueuedTour, scalarization: Scalarization) -> None:
    """Sum both lengths afresh. O(n)."""
    working.length[0], working.length[1] = lengths(scalarization.costs, working.tour)


@inlined
def descend(
    state: SearchState,
    scalarization: Scalarization,
    threshold: float,
    budget: int,
    offer_all: bool,
) -> int:
    """Make improving moves at queued cities until the queue or `budget`, in cities, is used up.

    With `offer_all` the archive is offered the tours on the way. Returns what is left of the
    budget.
    """
    working = state.working
    while working.ring[1] > 0 and budget > 0:
        if improve_at(working, scalarization, dequeue(working), threshold) and offer_all:
            offer(state, working)
        budget -= 1
    return budget


@standalone
def iterated_local_search(
    state: SearchState,
    scalarization: Scalarization,
    steps: int,
    budget: int,
    offer_all: bool,
) -> int:
    """Descend, then perturb and descend `steps` times, returning wherever the tour was better.

    Every local optimum is offered to the archive; with `offer_all`, so is every tour on the way.
    With no steps it is a descent, and nothing is offered: to compile one function for both takes
    half the time.

    Returns what is left of the budget, in cities of the queue: 0 if the last descent may not have
    ended.
    """
    working, w0, w1 = state.working, scalarization.w0, scalarization.w1
    value = w0 * working.length[0] + w1 * working.length[1]
    threshold = least_gain(scalarization, value)
    rounded = False
    for step in range(steps + 1):
        if step > 0:
            perturb(working, scalarization, state.random)
            rounded = spiked(working, working.saved_length[0], working.saved_length[1])
        budget = descend(state, scalarization, threshold, budget, offer_all)
        if steps == 0:
            break
        if rounded:
            sum_afresh(working, scalarization)
        if is_sorted(state.archive) or not offer_all:  # else it would be offered again, at O(n m)
            offer(state, working)
        reached = w0 * working.length[0] + w1 * working.length[1]
        if reached <= value + threshold:
            value = reached
            save(working)
        else:
            restore(working)
    return budget
