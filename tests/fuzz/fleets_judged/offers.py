"""Compare the offers of an order with the order at every place of a plan, in every slot."""

import copy
import json
import random
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import permutations
from math import inf
from typing import Any

from service.errors import Refusal
from service.fleet.plans import Plan, Route
from service.kinds.parsing import parse_task
from service.offers.offers import MOST_CHOICES, Offer, find_offers
from service.requests.limits import Limits
from service.requests.task import TaskSource
from tests.fuzz.fleets_judged.all_plans import Point, undominated
from tests.fuzz.fleets_judged.judge import Judge, name_of
from tests.fuzz.fleets_judged.timeline import Json

Routes = list[tuple[Json, tuple[int, ...]]]
SLOTS = 3
_EQUAL = 1e-6


def orders_of(request: Json) -> list[int]:
    """Return the stops that could be an order which is asked for: they are in no group."""
    if request.get("clock") is None:
        return []
    grouped = {stop for each in request["shipments"] for stop in each.values()}
    for name in ("together", "apart", "before", "promised"):
        grouped |= {*_numbers(request.get(name, []))}
    return [stop for stop in Judge(request).clients if stop not in grouped]


def offers_faults(
    rng: random.Random, request: Json, plan: Json, limits: Limits
) -> Iterator[str] | None:
    """Return what is wrong with the offers of a stop of a plan.

    It is None where there is no such plan, or no such fleet, without the stop.

    Args:
        rng: It draws the stop and the slots.
        request: The request; some stop of it could be an order.
        plan: A plan of its answer.
        limits: Those of the service.
    """
    request = copy.deepcopy(request)
    order = rng.choice(orders_of(request))
    for name in ("window", "windows"):
        request["stops"][order].pop(name, None)
    request["stops"][order]["prize"] = 0.0
    judge = Judge(request)
    driven = [judge.driven(route) for route in plan["routes"]]
    routes = [(vehicle, tuple(s for s in stops if s != order)) for vehicle, stops in driven]
    routes = [each for each in routes if each[1]]
    subject = _parsed(request, limits)
    if subject is None or isinstance(judge.beside(routes), str):
        return None
    slots = [sorted(round(rng.uniform(0, 120), 1) for _ in range(2)) for _ in range(SLOTS)]
    numbers = {(each.id, each.shift or 0, each.route): n for n, each in enumerate(subject.vehicles)}
    plan = Plan(tuple(Route(numbers[name_of(vehicle)], stops) for vehicle, stops in routes))
    found = find_offers(subject.fleet(), plan, order, [(a, b) for a, b in slots]).offers
    return _differences(request, routes, order, found)


def _parsed(request: Json, limits: Limits) -> Any:
    """Return the fleet of a request; None if the stop was all that an objective needs."""
    try:
        task = parse_task(TaskSource("fleet", json.dumps(request).encode()), limits, {})
    except Refusal:
        return None
    return task.subject


def _differences(
    request: Json, routes: Routes, order: int, offers: Sequence[Offer]
) -> Iterator[str]:
    """Yield where offers differ from what all places say."""
    for offer in offers:
        slot = [*offer.slot]
        inside = copy.deepcopy(request)
        inside["stops"][order]["window"] = slot
        judge = Judge(inside)
        base = judge.beside(routes)
        assert not isinstance(base, str)
        before = judge.lengths(base)
        longer = (judge.beside(each) for each in _insertions(judge, routes, order))
        rises = [
            tuple(b - a for a, b in zip(before, judge.lengths(each), strict=True))
            for each in longer
            if not isinstance(each, str)
        ]
        if fault := _wrong(offer, rises):
            yield f"offer of {order} in {slot} beside {[stops for _, stops in routes]}: {fault}"


def _insertions(judge: Judge, routes: Routes, order: int) -> Iterator[Routes]:
    """Yield all routes with the order in one of them, alone or beside a stop to load again."""
    used = Counter(name_of(vehicle) for vehicle, _ in routes)
    new: Routes = [(v, ()) for v in judge.vehicles if used[name_of(v)] < v.get("count", 1)]
    for number, (vehicle, stops) in (*enumerate(routes), *((len(routes), each) for each in new)):
        for place in range(len(stops) + 1):
            for reload in (None, *vehicle.get("reload", ())):
                for added in permutations({order, reload} - {None}):
                    longer = (vehicle, (*stops[:place], *added, *stops[place:]))
                    yield [*routes[:number], longer, *routes[number + 1 :]]


def _wrong(offer: Offer, rises: list[Point]) -> str:
    """Return what is wrong with the offer of a slot, given what all places cost."""
    if not offer.complete or bool(offer.choices) != bool(rises):
        return f"{offer}, and all places are {rises}"
    best = undominated(sorted({tuple(round(x, 6) + 0.0 for x in each) for each in rises}))
    told = [choice.rise for choice in offer.choices]
    if len(told) > MOST_CHOICES or (len(told) < MOST_CHOICES and not _reach(told, best)):
        return f"rises {told} are {best}"
    least = [
        tuple(x if m == n else inf for n, x in enumerate(each))
        for each in best
        for m in range(len(each))
    ]
    if not _reach(told, least) or not _reach(rises, told):
        return f"rises {told} are {best}"
    return ""


def _reach(some: list[Point], others: list[Point]) -> bool:
    """Return whether for each of the others one of some is as good."""
    return all(
        any(all(x <= y + _EQUAL for x, y in zip(one, other, strict=True)) for one in some)
        for other in others
    )


def _numbers(item: Any) -> Iterator[int]:
    """Yield all whole numbers in JSON."""
    if isinstance(item, dict):
        item = [*item.values()]
    if isinstance(item, list):
        for each in item:
            yield from _numbers(each)
    elif isinstance(item, int):
        yield item
