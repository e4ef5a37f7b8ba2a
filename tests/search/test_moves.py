"""A move changes the lengths of a tour by what is computed beforehand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.search.costs import lengths
from service.search.moves import apply_move, length_change
from service.search.working_tour import make_working_tour
from tests.helpers.instances import random_matrices, scalarization_of


@given(seed=st.integers(0, 10**6), flip=st.booleans(), data=st.data())
def test_a_move_changes_lengths_as_computed(seed: int, flip: bool, data: st.DataObject) -> None:
    n = 12
    instance = random_matrices(n, seed, symmetric=flip)
    scalarization = scalarization_of(instance)
    start, a = data.draw(st.integers(0, n - 1)), data.draw(st.integers(1, 3))
    b = data.draw(st.integers(0 if flip else 1, n - a - 1))
    working = make_working_tour(n)
    before = np.array(lengths(scalarization.costs, working.tour))
    expected = np.array(length_change(working, scalarization, start, a, b, flip))
    apply_move(working, start, a, b, flip)
    assert np.array(lengths(scalarization.costs, working.tour)) == pytest.approx(before + expected)
