"""Remedies that ask less of the visits: stops are left out, or any vehicle may visit them."""

from collections.abc import Sequence
from dataclasses import replace

from service.errors import CityNames, Remedy
from service.fleet.plans import FleetFront
from service.remedies.amounts import rounded_up
from service.remedies.asked import AskedFleet, Patch, Try
from service.remedies.patch import remove

_DETOURS = 3.0  # prizes, in largest legs: more than a visit costs


def leave_out(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Let the stops that the refusal names be left out, or all, for more than a visit costs."""
    rules = asked.rules
    if rules.over[0] == "max" or not asked.required:
        return None
    prize = _more_than_a_visit(asked)
    if (few := [stop for stop in asked.required if stop in asked.at_fault]) and (
        len(few) < len(asked.required) and _without(asked, few, prize, tried)
    ):
        named = CityNames("stop", asked.stops).of(few)
        return Remedy(
            "leave-these-out", _prizes(asked, few, prize), {"prize": prize, "named": named}
        )
    front = _without(asked, asked.required, prize, tried)
    if front is None:
        return None
    visited = max(len(set(plan.visited()) & {*rules.clients}) for plan in front.plans)
    counts = {"prize": prize, "visited": visited, "stops": len(rules.clients)}
    return Remedy("leave-out", _prizes(asked, asked.required, prize), counts) if visited else None


def _without(
    asked: AskedFleet, stops: Sequence[int], prize: float, tried: Try
) -> FleetFront | None:
    """Return the front of the fleet if some stops may be left out."""
    visits = {stop: replace(asked.rules.visits[stop], prize=prize) for stop in stops}
    return tried(asked.with_visits(visits))


def _prizes(asked: AskedFleet, stops: Sequence[int], prize: float) -> Patch:
    return asked.patch_of_stops({stop: {"prize": prize} for stop in stops})


def _more_than_a_visit(asked: AskedFleet) -> float:
    """Return more than any visit adds to the first length, with its way there and back."""
    rules = asked.rules
    prize = _DETOURS * float(asked.fleet.scale[0])
    prize += max(vehicle.fixed for vehicle in rules.vehicles)
    price = max(vehicle.per_time for vehicle in rules.vehicles)
    if rules.clock == rules.layers[0]:
        price += max(vehicle.per_distance for vehicle in rules.vehicles)
    if price:
        ends = [end for span in rules.spans for end in span if end < float("inf")]
        slowest = max(vehicle.service_factor for vehicle in rules.vehicles)
        service = slowest * max(visit.longest_service for visit in rules.visits)
        prize += price * (service + max(ends, default=0.0))
    return rounded_up(prize)


def any_vehicle(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Let any vehicle visit the stops that name one."""
    pinned = [stop for stop, visit in enumerate(asked.rules.visits) if visit.vehicles]
    visits = {stop: replace(asked.rules.visits[stop], vehicles=()) for stop in pinned}
    if not pinned or tried(asked.with_visits(visits)) is None:
        return None
    patch = tuple(remove(f"/stops/{stop}/vehicle") for stop in pinned)
    return Remedy("any-vehicle", patch, {"stops": len(pinned)})
