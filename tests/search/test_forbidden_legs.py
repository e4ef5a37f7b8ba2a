"""Conditions of tours without forbidden legs, against all permutations of a few cities."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.errors import CityNames, NoTour
from service.instance import Instance, RouteEnds
from service.search.forbidden_legs import check_legs, check_ways, find_obstacles, tightest

ENDS = st.sampled_from(("closed", "free", "start", "end", "both"))


def route_ends(kind: str) -> RouteEnds:
    start = 0 if kind in ("start", "both") else None
    return RouteEnds(kind == "closed", start, 1 if kind in ("end", "both") else None)


def has_tour(forbidden: np.ndarray, ends: RouteEnds) -> bool:
    for tour in permutations(range(len(forbidden))):
        if ends.start not in (None, tour[0]) or ends.end not in (None, tour[-1]):
            continue
        legs = zip(tour, tour[1:] + tour[:1] if ends.closed else tour[1:], strict=False)
        if not any(forbidden[a, b] and a != b for a, b in legs):
            return True
    return False


def random_ways(n: int, share: float, both_ways: bool, seed: int) -> np.ndarray:
    forbidden = np.random.default_rng(seed).random((n, n)) < share
    return forbidden | forbidden.T if both_ways else forbidden


@given(
    kind=ENDS,
    n=st.integers(2, 6),
    share=st.floats(0.2, 0.9),
    both_ways=st.booleans(),
    seed=st.integers(0, 10**6),
)
def test_what_is_refused_has_no_tour(
    kind: str, n: int, share: float, both_ways: bool, seed: int
) -> None:
    forbidden = random_ways(n, share, both_ways, seed)
    ends = route_ends(kind)
    if has_tour(forbidden, ends):
        assert find_obstacles(forbidden, ends) == []


@pytest.mark.parametrize("kind", ["closed", "free", "start", "end", "both"])
@pytest.mark.parametrize("both_ways", [True, False])
def test_most_of_what_has_no_tour_is_refused(kind: str, both_ways: bool) -> None:
    ends, without, refused = route_ends(kind), 0, 0
    for seed in range(300):
        forbidden = random_ways(5, 0.3 if both_ways else 0.5, both_ways, seed)
        if not has_tour(forbidden, ends):
            without += 1
            refused += bool(find_obstacles(forbidden, ends))
    assert without >= 30
    assert refused >= 0.75 * without


def ways(n: int, *legs: tuple[int, int]) -> np.ndarray:
    """Return which legs of n cities are forbidden, where only these are allowed."""
    forbidden = np.ones((n, n), np.bool_)
    for origin, destination in legs:
        forbidden[origin, destination] = False
    return forbidden


def both(*legs: tuple[int, int]) -> list[tuple[int, int]]:
    return [*legs, *(leg[::-1] for leg in legs)]


ABCDE = CityNames("stop", ["a", "b", "c", "d", "e"], "stops")
ISLANDS = ways(5, *both((0, 1), (1, 2), (0, 2), (3, 4)))


@pytest.mark.parametrize(
    ("forbidden", "kind", "sentence", "pointer"),
    [
        (
            ways(3, (0, 1), (1, 0), (0, 2)),
            "closed",
            "a way must lead from stop 'c' to another stop, and none does",
            "/stops/2",
        ),
        (
            ways(3, (0, 1), (2, 1)),
            "both",
            "a way must lead to stop 'c' from another stop, and none does",
            "/stops/2",
        ),
        (
            ISLANDS,
            "closed",
            "a way must lead to stops 'd' and 'e' from stops 'a', 'b' and 'c', and none does",
            "/stops/3",
        ),
        (
            ISLANDS,
            "free",
            "a way must lead from stops 'd' and 'e' to stops 'a', 'b' and 'c', over others maybe,"
            " or back, and none does",
            "/stops/3",
        ),
        (
            ways(3, *both((0, 1), (0, 2))),
            "closed",
            "ways must lead to stop 'b' from one stop and on to another one, and there are ways to"
            " and from stop 'a' alone",
            "/stops/1",
        ),
        (
            ways(4, *both((0, 1), (0, 2), (0, 3))),
            "free",
            "each of stops 'b', 'c' and 'd' must have a stop of its own after it, but for one that"
            " may be the last, and ways lead from them to stop 'a' alone",
            "/stops/1",
        ),
    ],
)
def test_the_refusal_names_the_stops(
    forbidden: np.ndarray, kind: str, sentence: str, pointer: str
) -> None:
    with pytest.raises(NoTour) as refused:
        check_ways(forbidden, route_ends(kind), ABCDE)
    assert refused.value.code == "no-plan"
    assert refused.value.detail == sentence
    assert refused.value.errors[0].pointer == pointer


def test_every_city_without_a_way_is_named() -> None:
    costs = np.ones((2, 40, 40))
    costs[:, 10:] = np.inf
    with pytest.raises(NoTour) as refused:
        check_legs(Instance(matrices=costs))
    assert refused.value.detail == (
        "a way must lead from city 10 to another city, and none does (and 29 more)"
    )
    assert len(refused.value.errors) == 20
    assert refused.value.document("1")["errors"][1] == {
        "detail": "a way must lead from city 11 to another city, and none does",
        "code": "no-plan",
    }


def test_a_thousand_cities_in_a_ring_have_a_tour() -> None:
    ring = [(i, (i + 1) % 1000) for i in range(1000)]
    assert find_obstacles(ways(1000, *ring), RouteEnds()) == []
    assert find_obstacles(ways(1000, *ring[:-1]), RouteEnds(False)) == []
    [obstacle] = find_obstacles(ways(1000, *ring[:-1], (999, 1)), RouteEnds())
    assert obstacle.cities == (0,)


def test_the_tightest_cities_come_first() -> None:
    costs = np.ones((2, 5, 5))
    costs[:, 3, :3] = costs[:, 2, 4] = np.inf
    assert tightest(Instance(matrices=costs)) == (3, 0, 1)
