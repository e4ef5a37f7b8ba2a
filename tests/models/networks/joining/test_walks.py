"""Walks, against the same walks taken step by step."""

import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import Generator, Tensor

from models.networks.joining.fragments import Fragments
from models.networks.joining.walks import begun_at, doubled, end_out_of_sight, walked


def path_through(cities: list[int], swapped: list[bool]) -> Fragments:
    """One path of all cities, in this order; where swapped, a city's links are the other way."""
    n = len(cities)
    links = torch.full((1, 2 * n + 1), -1)
    for place, city in enumerate(cities):
        near = [cities[other] for other in (place - 1, place + 1) if 0 <= other < n]
        for side, neighbour in enumerate(reversed(near) if swapped[place] else near):
            links[0, city + side * n] = neighbour
    ends = torch.tensor([[cities[0], cities[-1]]])
    partners, open_ = torch.tensor([[1, 0]]), torch.ones(1, 2, dtype=torch.bool)
    return Fragments(ends, partners, open_, links, torch.ones(1, dtype=torch.long))


@given(n=st.integers(2, 70), seed=st.integers(0, 1000), last_first=st.booleans())
def test_walks_go_along_the_path_from_the_end_that_is_asked_for(
    n: int, seed: int, last_first: bool
) -> None:
    generator = Generator().manual_seed(seed)
    cities = torch.randperm(n, generator=generator).tolist()
    swapped = (torch.rand(n, generator=generator) < 0.5).tolist()
    walks = begun_at(path_through(cities, swapped), torch.tensor([[int(last_first)]]))
    passes = 0
    while end_out_of_sight(walks):
        walks, passes = doubled(walks), passes + 1
    tour: Tensor = walked(walks)[0]
    assert tour.tolist() == (cities[::-1] if last_first else cities)
    assert passes <= n.bit_length()  # not one for each city
