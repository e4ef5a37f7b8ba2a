"""Remedies by the clock: longer shifts, at either end, later windows, and longer routes."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from math import inf

from service.amounts.said import duration
from service.errors import CityNames, Remedy
from service.fleet.fleet import Fleet
from service.fleet.plans import FleetFront, Plan, path_of
from service.fleet.rules import Rules
from service.fleet.schedule import schedule, with_waits
from service.fleet.vehicles import VehicleType
from service.remedies.amounts import time_rounded_up
from service.remedies.asked import AskedFleet, Members, Try, least_that_works
from service.remedies.patch import Operation, put

_LATER = (1 / 16, 1 / 8, 1 / 4, 1 / 2, 1, 2, 4, 8)  # shares of the longest shift, or of all windows
_LONGER = (25, 50, 100, 200, 400)  # per cent


def longer_shifts(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Let all vehicles be back later than the end of their shift."""
    found = asked.least_change(_amounts(asked, _longest_shift(asked)), _with_overtime, tried)
    if found is None:
        return None
    over = any(begin == end for begin, end in (each.shift for each in asked.rules.vehicles))
    code = "later-than-now" if over else "longer-shifts"
    return Remedy(code, found[1], _values(asked, found[0]))


def _with_overtime(more: float, _: str, vehicle: VehicleType) -> Members:
    return {"max_overtime": vehicle.max_overtime + more} if vehicle.shift[1] < inf else {}


def earlier_shifts(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Let all vehicles leave earlier than their shift begins."""
    amounts = _amounts(asked, _longest_shift(asked))
    found = asked.least_change(amounts, partial(_with_earlier, asked), tried)
    if found is None:
        return None
    more, changes = found
    patch = tuple(operation for change in changes for operation in _shifts(change))
    return Remedy("earlier-shifts", patch, _values(asked, more))


def _with_earlier(asked: AskedFleet, more: float, item: str, vehicle: VehicleType) -> Members:
    """Return an earlier shift of the vehicles of an id, if they have one that begins."""
    begin, end = vehicle.shift
    several = asked.vehicles.count(item) > 1
    return {} if several or begin <= 0 else {"shift": (max(0.0, begin - more), end)}


def _shifts(change: Operation) -> tuple[Operation, Operation]:
    """Return the operations that give vehicles their shift, whether it stood alone or in a list."""
    return put(f"{change['path']}s", [change["value"]]), put(change["path"], None)


def later_windows(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Let the last windows of some stops close later: of those that need it."""
    windows = {stop: asked.rules.visits[stop].windows for stop in asked.rules.clients}
    closing = [stop for stop, each in windows.items() if each[-1][1] < inf]
    closing = [stop for stop in closing if stop in asked.at_fault] or closing
    times = [time for stop in closing for span in windows[stop] for time in span]
    longest = max(max(times) - min(times), _longest_shift(asked)) if times else 0.0
    amounts = _amounts(asked, longest)
    found = least_that_works(amounts, partial(_later, asked, closing), tried)
    if found is None:
        return None
    more, front = found
    late = _fewest_late(asked, front, closing)
    if not late or tried(_later(asked, late, more)) is None:
        late = closing  # with which it was tried
    rules = _later(asked, late, more)
    patch = asked.patch_of_stops({stop: _windows(rules, stop) for stop in late})
    named = CityNames("stop", asked.stops).of(late)
    return Remedy("later-windows", patch, {"named": named, **_values(asked, more)})


def _later(asked: AskedFleet, stops: Sequence[int], more: float) -> Rules:
    visits = asked.rules.visits
    later = {}
    for stop in stops:
        *others, (opens, closes) = visits[stop].windows
        later[stop] = replace(visits[stop], windows=(*others, (opens, closes + more)))
    return asked.with_visits(later)


def _windows(rules: Rules, stop: int) -> Members:
    """Return the members that give a stop its windows, whether it had one or several."""
    return {"windows": [list(span) for span in rules.visits[stop].windows], "window": None}


def _fewest_late(asked: AskedFleet, front: FleetFront, closing: Sequence[int]) -> list[int]:
    """Return the stops that a plan visits after the windows close that were asked for.

    The plan is the one with the fewest.
    """
    return min((_late_of(asked, front.fleet, plan, closing) for plan in front.plans), key=len)


def _late_of(asked: AskedFleet, fleet: Fleet, plan: Plan, closing: Sequence[int]) -> list[int]:
    arrivals = {
        stop: arrival
        for route in with_waits(fleet, plan).routes
        for stop, arrival in zip(
            path_of(fleet.rules, route), schedule(fleet, route).arrivals, strict=True
        )
    }
    closes = {stop: asked.rules.windows[stop][-1][1] for stop in closing}
    return [stop for stop in closing if arrivals.get(stop, 0.0) > closes[stop]]


def no_slack(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Let vehicles reach stops as late as their windows close."""
    if not asked.rules.slack or tried(replace(asked.rules, slack=0.0)) is None:
        return None
    return Remedy("no-slack", (put("/slack", 0.0),), {})


def no_waits(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Let no visit wait for those of other vehicles; the order on each route stays."""
    groups = asked.rules.groups
    if not groups.waiting or tried(replace(asked.rules, groups=replace(groups, gaps=()))) is None:
        return None
    items = [f"/before/{index}" for index, gap in enumerate(groups.gaps) if gap is not None]
    changes = (
        put(f"{item}/{k}", v) for item in items for k, v in (("vehicles", "one"), ("gap", 0))
    )
    return Remedy("no-waits", tuple(changes), {})


def longer_routes(asked: AskedFleet, tried: Try) -> Remedy | None:
    """Let all routes be longer that have limits of their own, on them or on what they drive."""
    limited = asked.rules.has_longest or asked.rules.capped
    found = asked.least_change(_LONGER if limited else (), _with_longer, tried)
    return None if found is None else Remedy("longer-routes", found[1], {"share": found[0]})


def _with_longer(share: int, _: str, vehicle: VehicleType) -> Members:
    limits = {name: getattr(vehicle, name) for name in ("longest", "max_distance", "max_driving")}
    return {name: most * (100 + share) / 100 for name, most in limits.items() if most < inf}


def _longest_shift(asked: AskedFleet) -> float:
    """Return the length of the longest shift that ends; 0 without one.

    Where some are over, it is at least about the time for all stops, each on a way of its own.
    """
    shifts = [vehicle.shift for vehicle in asked.rules.vehicles]
    lengths = [end - begin for begin, end in shifts if end < inf]
    if 0.0 in lengths:
        lengths.append(_time_for_all(asked.fleet))
    return max(lengths, default=0.0)


def _time_for_all(fleet: Fleet) -> float:
    rules, [vehicle, *_] = fleet.rules, fleet.rules.vehicles
    assert rules.clock is not None
    ends = [end for end in (vehicle.start, vehicle.end) if end is not None]
    legs = [fleet.leg(rules.clock, end, stop, 0) for stop in rules.clients for end in ends]
    services = [rules.service(0, stop) for stop in rules.clients]
    return sum(leg for leg in legs if leg < inf) + sum(services)


def _amounts(asked: AskedFleet, longest: float) -> list[float]:
    """Return the times to try, ascending, as shares of the longest; none if that is 0."""
    shares = _LATER if longest > 0 else ()
    return sorted({time_rounded_up(share * longest, asked.unit) for share in shares})


def _values(asked: AskedFleet, more: float) -> dict[str, float | str]:
    return {"more": more, "text": duration(more, asked.unit)}
