"""Remedies by what vehicles can do: more of them, larger ones, more trips, stops and skills."""

from collections.abc import Sequence
from functools import partial

from service.errors import Remedy
from service.fleet.vehicles import VehicleType
from service.remedies.asked import AskedFleet, Members, Try, least_that_works
from service.remedies.rest import AskedRest

_MOST_ITEMS = 3  # ids of vehicles that are tried, the likely ones
_MORE = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
_LARGER = (25, 50, 100, 200, 400)  # per cent


def load_again(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Let vehicles load again where they start, as often as needed."""
    if asked.rules.shipments or asked.rules.takes or not asked.rules.dimensions:
        return None
    rules, patch = asked.changed(_with_trips)
    return Remedy("load-again", patch, {}) if patch and tried(rules) else None


def _with_trips(_: str, vehicle: VehicleType) -> Members:
    if vehicle.reload:
        return {} if vehicle.max_trips is None else {"max_trips": None}
    may = any(vehicle.capacity) and vehicle.start is not None and vehicle.max_stops is None
    return {"reload": (vehicle.start,)} if may else {}


def more_vehicles(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Have more vehicles of one id: as few as are needed, of the first id that helps."""
    amounts = [more for more in _MORE if more <= len(asked.rules.clients)]
    for item in asked.likely[:_MOST_ITEMS]:
        if found := asked.least_change(amounts, partial(_with_more, item), tried):
            more, patch = found
            before = asked.first_of(item).count
            counts = {"count": before + more, "before": before}
            return Remedy("more-vehicles", patch, {"vehicle": item, **counts})
    return None


def send_more(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Have more vehicles of one id leave from now on: as few as are needed."""
    assert isinstance(asked, AskedRest)
    amounts = [more for more in _MORE if more <= len(asked.rules.clients)]
    for item in asked.likely[:_MOST_ITEMS]:
        with_more = partial(asked.with_more, item)
        if found := least_that_works(amounts, lambda more: with_more(more)[0], tried):  # noqa: B023
            more, _ = found
            text = "1 more vehicle" if more == 1 else f"{more} more vehicles"
            return Remedy("send-more", with_more(more)[1], {"vehicle": item, "text": text})
    return None


def _with_more(item: str, more: int, name: str, vehicle: VehicleType) -> Members:
    return {"count": vehicle.count + more} if name == item else {}


def larger_vehicles(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Have larger vehicles of one id: as little larger as is needed."""
    for item in asked.likely[:_MOST_ITEMS] if asked.rules.dimensions else ():
        if found := asked.least_change(_LARGER, partial(_with_larger, item), tried):
            share, patch = found
            before = asked.first_of(item)
            after = _larger(share, before)
            amounts = {"holds": _listed(after), "before": _listed(before.capacity)}
            return Remedy("larger-vehicles", patch, {"vehicle": item, "share": share, **amounts})
    return None


def _listed(capacity: Sequence[int]) -> str:
    return " and ".join(map(str, capacity))


def _larger(share: int, vehicle: VehicleType) -> tuple[int, ...]:
    return tuple(-(-each * (100 + share) // 100) for each in vehicle.capacity)


def _with_larger(item: str, share: int, name: str, vehicle: VehicleType) -> Members:
    return {"capacity": _larger(share, vehicle)} if name == item else {}


def more_stops(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Let routes have more stops."""
    limited = any(vehicle.max_stops is not None for vehicle in asked.rules.vehicles)
    found = asked.least_change(_MORE if limited else (), _with_stops, tried)
    return None if found is None else Remedy("more-stops", found[1], {"more": found[0]})


def _with_stops(more: int, _: str, vehicle: VehicleType) -> Members:
    return {} if vehicle.max_stops is None else {"max_stops": vehicle.max_stops + more}


def more_skills(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Give all vehicles the skills that stops ask for which none may visit, or any stops."""
    rules = asked.rules
    unserved = [stop for stop in asked.required if not rules.servers(stop)]
    needed = {skill for stop in unserved or asked.required for skill in rules.visits[stop].skills}
    changed, patch = asked.changed(partial(_with_skills, needed))
    if not patch or tried(changed) is None:
        return None
    return Remedy("more-skills", patch, {"skills": ", ".join(map(repr, sorted(needed)))})


def _with_skills(needed: set[str], _: str, vehicle: VehicleType) -> Members:
    lacking = sorted(needed.difference(vehicle.skills))
    return {"skills": (*vehicle.skills, *lacking)} if lacking else {}
