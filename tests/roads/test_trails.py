"""Trails go along every leg once, and are not longer than they may be."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from service.roads.streets import trails

LEGS = st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), max_size=40)


@given(legs=LEGS, most=st.integers(2, 9))
def test_trails_go_along_every_leg_once(legs: list[tuple[int, int]], most: int) -> None:
    found = trails(legs, most)
    assert sorted(leg for trail in found for leg in pairwise(trail)) == sorted(set(legs))
    assert all(2 <= len(trail) <= most for trail in found)


def test_a_tour_takes_as_few_questions_as_possible() -> None:
    tour = [*range(60), 0]
    assert len(trails(pairwise(tour), 20)) == 4  # of 19 legs each at most
