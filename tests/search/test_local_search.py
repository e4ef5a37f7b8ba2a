"""Moves gain what is said."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from service.search.costs import lengths
from service.search.local_search import improve_at as improve_at_kernel
from service.search.working_tour import dequeue as dequeue_kernel
from service.search.working_tour import enqueue_cities, load, make_working_tour
from tests.helpers.instances import random_matrices, scalarization_of
from tests.helpers.kernels import for_python
from tests.helpers.sampled import third

improve_at = for_python(improve_at_kernel)
dequeue = for_python(dequeue_kernel)


@settings(max_examples=third(30))
@given(seed=st.integers(0, 10**6), symmetric=st.booleans(), n=st.integers(8, 40))
def test_every_improving_move_gains_what_it_says(seed: int, symmetric: bool, n: int) -> None:
    scalarization = scalarization_of(random_matrices(n, seed, symmetric))
    working = make_working_tour(n)
    load(working, working.tour.copy(), *lengths(scalarization.costs, working.tour))
    enqueue_cities(working, working.tour)
    while working.ring[1] > 0:
        before = working.length.sum()
        if improve_at(working, scalarization, dequeue(working), 1e-9):
            assert working.length.sum() < before
            assert lengths(scalarization.costs, working.tour) == pytest.approx(
                tuple(working.length)
            )
    assert np.array_equal(np.sort(working.tour), np.arange(n))
