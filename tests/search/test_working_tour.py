"""Blocks are reversed and swapped as in lists, and a city is queued once."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from service.search.working_tour import (
    dequeue as dequeue_kernel,
)
from service.search.working_tour import (
    enqueue as enqueue_kernel,
)
from service.search.working_tour import (
    enqueue_cities,
    make_working_tour,
)
from service.search.working_tour import (
    reverse_block as reverse_block_kernel,
)
from service.search.working_tour import (
    swap_blocks as swap_blocks_kernel,
)
from tests.helpers.kernels import for_python

dequeue = for_python(dequeue_kernel)
enqueue = for_python(enqueue_kernel)
reverse_block = for_python(reverse_block_kernel)
swap_blocks = for_python(swap_blocks_kernel)


def from_city_0(tour: NDArray[np.int32]) -> list[int]:
    """The tour read from city 0 on."""
    return np.roll(tour, -int(np.argmin(tour))).tolist()


@given(n=st.integers(8, 20), start=st.integers(0, 19), a=st.integers(1, 19), b=st.integers(1, 19))
def test_swapping_blocks_equals_cutting_and_joining_lists(
    n: int, start: int, a: int, b: int
) -> None:
    start, a = start % n, 1 + a % (n - 2)
    b = 1 + b % (n - a - 1)
    working = make_working_tour(n)
    swap_blocks(working, start, a, b)
    turned = np.roll(np.arange(n), -start)
    expected = np.concatenate((turned[a : a + b], turned[:a], turned[a + b :]))
    assert from_city_0(working.tour) == from_city_0(expected)
    assert np.array_equal(working.tour[working.position], np.arange(n))


@given(n=st.integers(8, 20), start=st.integers(0, 19), size=st.integers(1, 19))
def test_reversing_equals_reversing_a_list_up_to_direction(n: int, start: int, size: int) -> None:
    start, size = start % n, 1 + size % (n - 1)
    working = make_working_tour(n)
    reverse_block(working, start, size)
    turned = np.roll(np.arange(n), -start)
    turned[:size] = turned[:size][::-1].copy()
    assert from_city_0(working.tour) in (from_city_0(turned), from_city_0(turned[::-1]))
    assert np.array_equal(working.tour[working.position], np.arange(n))


def test_a_city_is_queued_only_once() -> None:
    working = make_working_tour(9)
    enqueue_cities(working, working.tour)
    enqueue(working, 4)
    assert [dequeue(working) for _ in range(int(working.ring[1]))] == list(range(9))
