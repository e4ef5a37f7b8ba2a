"""Three-opt is for many cities and symmetric costs, and finds tours of them."""

import numpy as np

from service.instance import Instance
from service.search.schedule import Search
from service.search.three_opt.choice import (
    THREE_OPT,
    ThreeOptSearch,
    TwoOptSearch,
    choose_local_search,
)

FEW = Instance(coordinates=np.random.default_rng(0).random((12, 4)))


def test_three_opt_is_for_many_cities_and_symmetric_costs() -> None:
    state = Search(FEW, 0, np.full(2, 12.0)).state
    many = state.costs._replace(cities=np.zeros((THREE_OPT, 4)))
    assert isinstance(choose_local_search(state), TwoOptSearch)
    assert isinstance(choose_local_search(state._replace(costs=many)), ThreeOptSearch)
    asymmetric = many._replace(symmetric=False)
    assert isinstance(choose_local_search(state._replace(costs=asymmetric)), TwoOptSearch)
