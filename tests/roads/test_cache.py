"""The cache of matrices holds no more than it may, and nothing that is too old."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from service.roads.cache import BYTES_OF_ENTRY, ArrayCache


def test_what_is_too_old_is_not_returned() -> None:
    now = [0.0]
    cache = ArrayCache(10_000, 60.0, lambda: now[0])
    cache.put(b"a", np.ones(3))
    now[0] = 60.0
    assert cache.get(b"a") is not None
    now[0] = 60.1
    assert cache.get(b"a") is None


@given(steps=st.lists(st.tuples(st.booleans(), st.integers(0, 5), st.integers(0, 30)), max_size=40))
def test_the_arrays_used_last_stay(steps: list[tuple[bool, int, int]]) -> None:
    cache, most = ArrayCache(4 * BYTES_OF_ENTRY, 60.0), 4 * BYTES_OF_ENTRY
    expected: dict[bytes, int] = {}  # sizes in the order of their last use
    for putting, name, size in steps:
        key = bytes([name])
        if putting:
            cache.put(key, np.zeros(size))
            expected.pop(key, None)
            expected[key] = 8 * size
            while sum(expected.values()) + len(expected) * BYTES_OF_ENTRY > most:
                del expected[next(iter(expected))]
        elif cache.get(key) is not None:
            expected[key] = expected.pop(key)
    kept = {key: cache.get(key) for key in map(bytes, ([i] for i in range(6)))}
    assert {key: array.nbytes for key, array in kept.items() if array is not None} == expected
