"""Overlap sorts plans as a dispatcher would who looks at the map."""

from math import dist

import numpy as np
import pytest

from service.fleet.evaluation import plan_lengths
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route
from service.fleet.rules import Rules
from service.fleet.vehicles import VehicleType, Visit

# Maps of the same stops, in a plan that is tidier and in one that is less. A letter is a stop, and
# the van that visits it.
MAPS = {
    "two vans share a street, in turn": ("aaabbb", "ababab"),
    "two streets": ("aaaaa/...../bbbbb", "ababa/...../babab"),
    "two villages": ("aaa......bbb/aaa......bbb", "aab......bba/baa......abb"),
    "a stop in the middle of others": ("aaa....bbb/aaa....bbb", "aba....abb/aaa....bbb"),
    "blocks are tidier than stripes": ("aabb/aabb/ccdd/ccdd", "aaaa/bbbb/cccc/dddd"),
    "stripes are tidier than a mix": ("aaaa/bbbb/cccc/dddd", "abcd/dabc/cdab/bcda"),
    "blocks are tidier than rings": ("aaabb/aaabb/aacbb/ccccc", "aaaaa/abbba/abcba/ccccc"),
    "loose stops are cut off, not dense ones": ("aaaa...b...b/aaaa", "aabb...b...b/aabb"),
    "who visits a farm hardly counts": ("aaabbb...........a/aaabbb", "aababb...........b/aaabbb"),
}


def overlap(picture: str) -> float:
    """Return the overlap of the plan of a map."""
    rows = picture.split("/")
    stops = [(c, r, van) for r, row in enumerate(rows) for c, van in enumerate(row) if van != "."]
    places = [(0, -5), *((c, r) for c, r, _ in stops)]
    costs = np.array([[dist(a, b) for b in places] for a in places])
    rules = Rules(
        visits=(Visit(),) * len(places),
        vehicles=(VehicleType(start=0, end=0, count=4),),
        over=("sum", "overlap"),
        layers=(0, 0),
    )
    routes = {van: [] for _, _, van in stops}
    for number, (_, _, van) in enumerate(stops, start=1):
        routes[van].append(number)
    plan = Plan(tuple(Route(0, tuple(route)) for route in routes.values()))
    return plan_lengths(Fleet(rules=rules, costs=np.array([costs, costs])), plan)[1]


@pytest.mark.parametrize("case", MAPS)
def test_a_tidier_plan_has_less_overlap(case: str) -> None:
    tidy, less = map(overlap, MAPS[case])
    assert 0 <= tidy < 0.95 * less <= 0.95


def test_one_van_overlaps_with_nobody_and_vans_of_one_stop_each_entirely() -> None:
    assert overlap("aaa/aaa") == 0
    assert overlap("ab/cd") == pytest.approx(1)
