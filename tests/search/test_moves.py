"""A move changes the lengths of a tour by what is computed beforehand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.search.costs import lengths
from service.search.moves import apply_move as apply_move_kernel
from service.search.moves import length_change as length_change_kernel
from service.search.moves import two_opt as two_opt_kernel
from service.search.working_tour import make_working_tour
from tests.helpers.instances import opened, random_matrices, scalarization_of
from tests.helpers.kernels import for_python
from tests.helpers.sampled import third

apply_move = for_python(apply_move_kernel)
length_change = for_python(length_change_kernel)
two_opt = for_python(two_opt_kernel)


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


@pytest.mark.parametrize("seed", range(third(20)))
def test_a_free_end_of_a_route_is_exchanged_for_the_best_other(seed: int) -> None:
    scalarization = scalarization_of(opened(random_matrices(8, seed, symmetric=True), "no"))
    working = make_working_tour(9)  # from the invented city through 1 to 8
    cost = scalarization.costs.matrix.sum(axis=2) / 2
    gains = [  # of turning round the beginning of the route, up to the city before k
        cost[k - 1, k] - cost[1, k] for k in range(3, 9)
    ]
    gains += [  # of turning round what follows the first city, up to k
        cost[1, 2] - cost[1, k] + (cost[k, k + 1] - cost[2, k + 1] if k < 8 else 0.0)
        for k in range(3, 9)
        if cost[1, k] < cost[1, 2]
    ]
    assert two_opt(working, scalarization, 1, 0.0)[0] == pytest.approx(max(0.0, *gains))
