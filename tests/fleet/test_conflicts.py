"""Fleets without a plan: the refusal names stops without which there is one."""

import re
from dataclasses import replace
from math import inf

import numpy as np
import pytest

from service.errors import NoTour
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.planner import plan_fleet
from service.fleet.rules import Rules
from service.fleet.vehicles import VehicleType, Visit

SOON = Visit(windows=((5.0, 5.0),))


def on_a_line(visits: list[Visit], vehicles: int) -> Fleet:
    """Return a fleet of stops on a line, at 0 to 5, and vehicles that start and end at 0."""
    n = len(visits) + 1
    places = np.arange(float(n)) % 6
    line = np.abs(np.subtract.outer(places, places))
    vehicle = VehicleType(start=0, end=0, count=vehicles)
    rules = Rules(visits=(Visit(), *visits), vehicles=(vehicle,), clock=0)
    return Fleet(rules=rules, costs=np.stack([line, line]))


def named(fleet: Fleet, seconds: float) -> list[int]:
    """Return the stops without which the refusal of a fleet says that there is a plan."""
    with pytest.raises(NoTour) as refused:
        plan_fleet(fleet, FleetOptions(time_limit=seconds))
    assert refused.value.code == "no-plan"
    assert str(refused.value).endswith("there is one")
    (obstacle,) = refused.value.obstacles
    assert all(str(stop) in re.findall(r"\d+", str(refused.value)) for stop in obstacle.cities)
    return list(obstacle.cities)


def without(fleet: Fleet, stops: list[int]) -> Fleet:
    visits = fleet.rules.visits
    some = [replace(v, prize=0.0) if i in stops else v for i, v in enumerate(visits)]
    return Fleet(rules=replace(fleet.rules, visits=tuple(some)), costs=fleet.costs)


def test_of_few_stops_the_fewest_are_named() -> None:
    """Stops 3 and 5 are open at one time, and one vehicle cannot be at both."""
    fleet = on_a_line([Visit(), Visit(), SOON, Visit(), SOON], vehicles=1)
    stops = named(fleet, inf)
    assert stops in ([3], [5])
    assert plan_fleet(without(fleet, stops), FleetOptions(time_limit=inf)).plans


def test_of_some_stops_those_are_named_that_fit_nowhere() -> None:
    visits = [SOON if i % 4 == 0 else Visit() for i in range(1, 13)]
    fleet = on_a_line(visits, vehicles=2)
    stops = named(fleet, 0.1)
    assert plan_fleet(without(fleet, stops), FleetOptions(time_limit=0.5)).plans


@pytest.mark.parametrize("place", [0, 1, 2])
def test_objectives_of_nine_days_in_ten_are_not_in_the_way(place: int) -> None:
    fleet = on_a_line([Visit(), Visit(), SOON, Visit(), SOON], vehicles=1)
    percents = tuple(90 if index == place else None for index in range(3))
    over = ("sum", "max", "sum")
    rules = replace(fleet.rules, over=over, layers=(0, 0, 0), spread=0.1, percents=percents)
    assert named(Fleet(rules=rules, costs=fleet.costs), inf) in ([3], [5])
