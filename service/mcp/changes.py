"""Make the members of a request to replan from what an agent says of a fleet's day."""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from paretour import FleetFront, FleetPlan, FleetRoute, FrontOfAnyKind, Refused
from paretour.choice import knee

from service.amounts.said import clock_time
from service.mcp.times import with_times
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.fleet_fields import ReplanFleetRequest
from service.requests.replan.offers import OffersRequest

AS_PLANNED = "as planned"
Named = Mapping[str, Any]
_PART = re.compile(r"routes/\d+/\w+(?:/\d+)?")  # of a request to replan a fleet


@dataclass(frozen=True)
class Day:
    """What has changed since a front was planned.

    Args:
        assumed: What was taken for granted, in sentences.
        parts: What the agent calls parts of the request: done/van/1 for routes/0/done/1.
    """

    members: dict[str, Any]
    assumed: Sequence[str] = ()
    parts: Mapping[str, str] = field(default_factory=dict)

    @contextmanager
    def refused_in_its_words(self) -> Iterator[None]:
        """Have a refusal name the parts of the request as the agent does."""
        try:
            yield
        except Refused as error:
            raise Refused(self._renamed(error.document)) from None

    def _renamed(self, value: Any) -> Any:
        """Return a problem document, or a member of it, with other names of parts in sentences."""
        if isinstance(value, list):
            return [self._renamed(each) for each in value]
        if not isinstance(value, Mapping):
            return value
        return {
            name: self._in_words(each) if name == "detail" else self._renamed(each)
            for name, each in value.items()
        }

    def _in_words(self, sentence: str) -> str:
        return _PART.sub(lambda found: self.parts.get(found[0], found[0]), sentence)


def changes_of(front: FrontOfAnyKind, asked: Named) -> Day:
    """Return the changes that an agent tells.

    Of a fleet `done` says by vehicle which stops were visited, or that all went as planned until
    now, and `broken_down` which vehicles are out of service.

    Raises:
        ValueError: A time cannot be read, or a vehicle is not named by its only route.
    """
    if isinstance(front, FleetFront):
        unit = None if front.clock is None else front.clock.unit
        return _of_fleet(front, with_times(asked, unit, ReplanFleetRequest, OffersRequest))
    return Day(with_times(asked, "s", ReplanRequest))


def _of_fleet(front: FleetFront, members: dict[str, Any]) -> Day:
    number = members.get("plan")
    number = knee(front.lengths) if number is None else number
    if not isinstance(number, int) or not 0 <= number < len(front):
        raise ValueError(f"plan must be below {len(front)}, got {number!r:.80}")
    plan, done = front[number], members.pop("done", None)
    ways: dict[int, dict[str, Any]] = {}
    assumed: list[str] = []
    parts: dict[int, dict[str, str]] = {}
    depots = _depots(plan)
    if done == AS_PLANNED:
        unit = None if front.clock is None else front.clock.unit
        ways, assumed = _as_planned(plan, members.get("now"), unit)
        parts = {at: {"done": f"done of {plan.routes[at].vehicle}"} for at in ways}
    elif isinstance(done, Mapping):
        for name, stops in done.items():
            route = _route(plan, number, name)
            visited = [(at, stop) for at, stop in enumerate(stops) if stop not in depots]
            ways[route] = {"route": route, "done": [stop for _, stop in visited]}
            items = {f"done/{new}": f"done/{name}/{at}" for new, (at, _) in enumerate(visited)}
            parts[route] = {"route": f"done/{name}", "done": f"done/{name}", **items}
    elif done:
        raise ValueError(f'done of a fleet must name vehicles or routes, or be "{AS_PLANNED}"')
    for at, name in enumerate(members.pop("broken_down", None) or ()):
        route = _route(plan, number, name)
        ways.setdefault(route, {"route": route})["broken_down"] = True
        parts.setdefault(route, {})["broken_down"] = f"broken_down/{at}"
        parts[route].setdefault("route", f"broken_down/{at}")
    given = members.get("routes", ())
    if ways:
        members["routes"] = [*given, *ways.values()]
    named = {
        f"routes/{at}/{part}": words
        for at, route in enumerate(ways, len(given))
        for part, words in parts.get(route, {}).items()
    }
    return Day({**members, "plan": number}, assumed, named)


def _as_planned(
    plan: FleetPlan, now: float | None, unit: str | None
) -> tuple[dict[int, dict[str, Any]], list[str]]:
    """Return what each vehicle has done by now if it drives as planned, and say it."""
    if now is None:
        raise ValueError(f'now is needed with done "{AS_PLANNED}", such as "11:00"')
    ways, assumed, depots = {}, [], _depots(plan)
    for number, route in enumerate(plan.routes):
        if route.arrivals is None:
            raise ValueError("the fleet has no clock, so done must name the stops of each vehicle")
        if route.arrivals[0] > now:
            continue
        reached = int((route.arrivals <= now).sum())
        done = [stop for stop in route.stops[:reached] if stop not in depots]
        where = _where(route, reached - 1, now, depots)
        ways[number] = {"route": number, "done": done, **where}
        stops = ", ".join(done) or "no stop yet"
        begun = f", the last until {clock_time(where['leaves'], unit)}" if "leaves" in where else ""
        assumed.append(f"route {number} ({route.vehicle}) has visited as planned: {stops}{begun}")
    return ways, assumed


def _where(route: FleetRoute, last: int, now: float, depots: Collection[str]) -> dict[str, Any]:
    """Return where a vehicle goes on, unless at the last visit, and when, if a visit has begun.

    Args:
        last: The place in it that it has reached last.
        depots: The stops that are no visits.
    """
    stop = route.stops[last]
    found: dict[str, Any] = {"position": stop} if last and stop in depots else {}
    if route.ends is not None and route.ends[last] > now:
        found["leaves"] = float(route.ends[last])
    return found


def _depots(plan: FleetPlan) -> set[str]:
    """Return the first and last stops of routes that other routes, or other ends, have as well."""
    ends = [stop for route in plan.routes for stop in (route.stops[0], route.stops[-1])]
    return {stop for stop in ends if ends.count(stop) > 1}


def _route(plan: FleetPlan, number: int, name: Any) -> int:
    """Return the number of a route, by itself or by a vehicle that has no other."""
    count = len(plan.routes)
    if str(name).isdecimal() and int(name) < count:
        return int(name)
    found = [at for at, route in enumerate(plan.routes) if route.vehicle == name]
    if len(found) == 1:
        return found[0]
    known: Sequence[str] = [f"{at} ({route.vehicle})" for at, route in enumerate(plan.routes)]
    demand = "is no vehicle with a route" if not found else "has several routes"
    routes = ", ".join(known)
    raise ValueError(f"{name!r:.80} {demand} in plan {number}: name one of its routes, {routes}")
