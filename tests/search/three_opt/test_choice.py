"""Three-opt is for many cities, and for costs that differ by direction."""

import numpy as np

from service.instance import Instance
from service.search.schedule import Search
from service.search.sizes import LARGE, MENDING, THREE_OPT
from service.search.three_opt.choice import ThreeOptSearch, TwoOptSearch, choose_local_searches

FEW = Instance(coordinates=np.random.default_rng(0).random((12, 4)))


def test_three_opt_is_for_many_cities_and_for_asymmetric_costs() -> None:
    state = Search(FEW, 0, np.full(2, 12.0)).state

    def chosen(n: int, symmetric: bool = True, mending: bool = False) -> tuple[type, type]:
        costs = state.costs._replace(cities=np.zeros((n, 4)), symmetric=symmetric)
        descent, iterations = choose_local_searches(state._replace(costs=costs), mending)
        return type(descent), type(iterations)

    assert chosen(THREE_OPT - 1) == (TwoOptSearch, TwoOptSearch)
    assert chosen(THREE_OPT) == (TwoOptSearch, ThreeOptSearch)
    assert chosen(MENDING - 1, mending=True) == (TwoOptSearch, TwoOptSearch)
    assert chosen(MENDING, mending=True) == (TwoOptSearch, ThreeOptSearch)
    assert chosen(LARGE) == (ThreeOptSearch, ThreeOptSearch)
    assert chosen(10, symmetric=False) == (TwoOptSearch, ThreeOptSearch)
    assert chosen(10, symmetric=False, mending=True) == (TwoOptSearch, ThreeOptSearch)
    assert chosen(LARGE, symmetric=False) == (ThreeOptSearch, ThreeOptSearch)
