"""Without the stops that are blamed, there is a way between all that remain."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from service.roads.reachability import missing_ways


@given(n=st.integers(1, 12), share=st.floats(0, 0.3), seed=st.integers(0, 2**32 - 1))
def test_without_the_blamed_there_is_a_way_between_all(n: int, share: float, seed: int) -> None:
    missing = np.random.default_rng(seed).random((n, n)) < share
    np.fill_diagonal(missing, False)
    ways = missing_ways(missing)
    left = np.setdiff1d(np.arange(n), [way.blamed for way in ways])
    assert not missing[np.ix_(left, left)].any()
    for way in ways:
        assert missing[way.origin, way.destination]
        assert way.blamed in (way.origin, way.destination)


def test_a_stop_that_cannot_be_left_is_blamed_and_not_those_that_it_leads_to() -> None:
    missing = np.zeros((9, 9), dtype=np.bool_)
    missing[4] = np.arange(9) != 4
    assert [way.blamed for way in missing_ways(missing)] == [4]
