"""Which stops are in each other's way: a few without which a fleet has a plan."""

from collections.abc import Callable
from dataclasses import replace

from service.errors import NoTour, Obstacle, Refusal
from service.fleet.enumeration import exact_plans, is_enumerable
from service.fleet.evaluation import unassigned, violations
from service.fleet.fleet import Fleet
from service.fleet.left_out import with_all_stops
from service.fleet.necessary import NAMES
from service.fleet.plans import Plan

FEW_STOPS = 25  # to insert all of them one by one takes less than a tenth of a second


def no_plan(fleet: Fleet, sentence: str, ended: Callable[[], bool]) -> Refusal:
    """Return the refusal of a fleet without a plan, which names stops that are in the way.

    For few stops these are the fewest, and for up to `FEW_STOPS` those that fit nowhere when all
    are inserted one after the other. They are not named for more stops, or if `ended` returns True
    too soon.

    Args:
        sentence: What is known without them, as "no plan keeps every rule".
        ended: Called every few milliseconds; once it returns True, stops are no longer looked for.
    """
    stops = _in_the_way(fleet, ended)
    if not stops:
        return Refusal("no-plan", reason=sentence)
    return NoTour([Obstacle("in-the-way", stops, values={"reason": sentence})], NAMES)


def _in_the_way(fleet: Fleet, ended: Callable[[], bool]) -> tuple[int, ...]:
    try:
        relaxed = _with_optional_stops(fleet)
    except Refusal:  # without a clock, `longest` needs the objective that is a maximum
        return ()
    if is_enumerable(fleet.rules):
        plans = exact_plans(relaxed, ended) or []
    elif any(vehicle.is_bounded_below for vehicle in fleet.rules.vehicles):
        plans = []  # no route can begin with a single stop
    elif len(fleet.rules.clients) <= FEW_STOPS:
        plan = with_all_stops(relaxed, Plan(()))
        plans = [] if violations(relaxed, plan) else [plan]
    else:
        plans = []
    required = [stop for stop, visit in enumerate(relaxed.rules.visits) if visit.prize]
    missing = [tuple(s for s in unassigned(relaxed.rules, p) if s in required) for p in plans]
    return min(missing, key=len, default=())


def _with_optional_stops(fleet: Fleet) -> Fleet:
    """Return a fleet that may leave out each stop: required ones at a price of 1, others at 0."""
    rules = fleet.rules
    deliveries = {each.delivery for each in rules.shipments}
    visits = tuple(
        visit
        if stop in rules.depots or stop in deliveries
        else replace(visit, prize=float(visit.prize is None))
        for stop, visit in enumerate(rules.visits)
    )
    relaxed = replace(rules, visits=visits, over=("sum", "unassigned"), layers=(0, 1), percents=())
    return fleet.under(relaxed)
