"""Repair problems: tours from which cities are cut out, and which are joined again."""

import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Generator, Tensor

from models.data.instances import uniform_cities
from models.data.preferences import fan_of_preferences, weights
from models.networks.joining.candidates import joined_at_cost, single_cities
from models.networks.joining.closing import joined_to_one
from models.networks.joining.costs import Planes, Problem, padded_matrices
from models.networks.joining.fragments import first_open, joined
from models.networks.joining.repairs import cut, laid_out, repair_problem
from models.networks.joining.walks import tours_from
from models.networks.pa_one import OneActor
from tests.helpers.small_actors import CPU, small_actor


def steps_of(tour: Tensor) -> set[frozenset[int]]:
    return {frozenset(pair) for pair in zip(tour.tolist(), tour.roll(1).tolist(), strict=True)}


def rejoined(tours: Tensor, cities: Tensor, planes: Planes) -> Tensor:
    """The tours after a repair that cuts out the cities, by a small actor."""
    actor = small_actor("pa-one")
    assert isinstance(actor, OneActor)
    cuts = cut(tours, cities)
    problem = Problem(planes, weights(fan_of_preferences(3, CPU)))
    costs, fragments = repair_problem(problem, cuts)
    return laid_out(cuts, actor.joined_to_one(costs, fragments, actor.repair_joinings))


@given(seed=st.integers(0, 1000), n=st.integers(3, 30), m=st.integers(1, 21))
@settings(max_examples=20)
def test_a_repaired_tour_has_every_city_once_and_all_edges_that_were_not_cut(
    seed: int, n: int, m: int
) -> None:
    generator = Generator().manual_seed(seed)
    planes = Planes(uniform_cities(1, n, generator, CPU)[0])
    tours = torch.stack([torch.randperm(n, generator=generator) for _ in range(3)])
    cities = torch.stack([torch.randperm(n, generator=generator)[:m] for _ in range(3)])
    new = rejoined(tours, cities, planes)
    for row in range(3):
        uncut = {edge for edge in steps_of(tours[row]) if not edge & set(cities[row].tolist())}
        assert uncut <= steps_of(new[row])
        assert sorted(new[row].tolist()) == list(range(n))


def test_two_fragments_are_joined_the_cheaper_way() -> None:
    # Two sides of a square, 0-2 and 1-3: the diagonals would be longer than the other sides.
    plane = torch.tensor([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
    costs = Problem(Planes(plane.repeat(1, 2)), torch.tensor([[0.5, 0.5]])).tables
    sides = joined(single_cities(costs), torch.tensor([[2, 3, 0, 1]]))
    whole = joined_to_one(costs, sides)
    tour = tours_from(whole, first_open(whole))[0]
    assert steps_of(tour) == {frozenset(e) for e in ((0, 1), (1, 3), (3, 2), (2, 0))}


def test_rounding_does_not_choose_where_a_tour_starts() -> None:
    # City 0 and the path 1-2: joining 0 to either end first gives the same tour.
    matrix = torch.tensor([[0.0, 1.0, 2.0], [4.0, 0.0, 3.0], [2.0, 5.0, 0.0]])
    costs = padded_matrices(matrix[None]).tables
    pair = joined_at_cost(costs, single_cities(costs), torch.tensor([[-1, 2, 1]]))
    assert pair.leans is not None
    last_ends = set()
    for error in (-1e-6, 1e-6):
        whole = joined_to_one(costs, pair._replace(leans=pair.leans + torch.tensor([0, error, 0])))
        last_ends.add(tuple(whole.open[0].tolist()))
    assert last_ends == {(True, False, True)}
