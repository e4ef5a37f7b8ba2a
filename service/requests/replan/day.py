"""A fleet's day so far: the plan that is driven, and how far each vehicle on its way has come."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from paretour.choice import knee
from pydantic_core import from_json

from service.errors import invalid
from service.fleet.plans import Route
from service.fleet.rules import Rules
from service.requests.replan.fields import NewStop
from service.requests.replan.fleet_fields import ReplanFleetRequest, RouteOnTheWay
from service.requests.replan.way import StoredFront, not_replannable
from service.requests.stop_fields import find_index
from service.requests.task import UnmeasuredFleet, VehicleName


@dataclass(frozen=True, eq=False)
class Way:
    """A vehicle on its way, in indexes of the front's stops.

    Args:
        part: The part of the request that is about it.
        number: The number of its route in the plan.
        position: Where it goes on; None for a new place.
        left: What is left of its route, with the stops where it loads again.
        done: The stops that it has visited.
        trips: The number of trips that have ended.
        departure: When it left; None without a clock.
        leaves: When it leaves its position, if that is after the present time; else 0.
        broken_down: Whether it is out of service.
        home: Where it loads before it leaves: where it started the day, if it did at a stop.
        is_back: Whether all is done, and it stands where it loads: it can load what it brings next.
        distance: How far it has driven; None where that is not known.
        driving: How long it has driven; None where that is not known.
    """

    part: str
    number: int
    type: int
    position: int | None
    left: tuple[int, ...]
    done: tuple[int, ...]
    trips: int
    departure: float | None
    leaves: float
    broken_down: bool
    home: int | None
    is_back: bool
    distance: float | None
    driving: float | None


@dataclass(frozen=True, eq=False)
class DaySoFar:
    """The day so far.

    Args:
        ways: The vehicles on their way, in the order of the request.
        waiting: The routes whose vehicles have not left, by their numbers in the plan.
        arrivals: When each stop is reached in the plan; nothing without a clock.
        ends: When each visit ends in the plan; nothing without a clock.
    """

    ways: tuple[Way, ...]
    waiting: Mapping[int, Route]
    arrivals: Mapping[int, float]
    ends: Mapping[int, float]

    @property
    def working(self) -> list[Way]:
        """The vehicles on their way that are in service."""
        return [way for way in self.ways if not way.broken_down]

    @property
    def done(self) -> frozenset[int]:
        """All stops that were visited."""
        return frozenset(stop for way in self.ways for stop in way.done)


class _Driven(NamedTuple):
    """A route of the plan that is driven.

    Attributes:
        route: The route.
        stops: Its stops, with its start and its end if these are stops.
        departure: When its vehicle leaves; None without a clock.
        distance: How far it has driven at each of these stops; empty where no limit is on that.
        driving: How long it has driven at each of them, or empty.
    """

    route: Route
    stops: tuple[int, ...]
    departure: float | None
    distance: tuple[float, ...]
    driving: tuple[float, ...]

    def reached(self, done: Sequence[int], position: int | None, *, is_done: bool) -> int | None:
        """Return the place in `stops` where its vehicle goes on; None where it is none of them."""
        first = max(map(self.stops.index, done), default=0)
        places = [at for at in range(first, len(self.stops)) if self.stops[at] == position]
        return (places[-1] if is_done else places[0]) if places else None


def _so_far(given: float | None, planned: Sequence[float], reached: int | None) -> float | None:
    """Return what was driven: as is given, or else as planned; None where neither says it."""
    if given is not None or not planned or reached is None:
        return given
    return planned[reached]


def day_of(
    request: ReplanFleetRequest, stored: StoredFront, fleet: UnmeasuredFleet, ids: Mapping[str, int]
) -> DaySoFar:
    """Return the day so far.

    Args:
        ids: The index of each stop of the front by its id.

    Raises:
        Refusal: The request names a plan, a route or a stop that is not there, or one twice.
    """
    driven, arrivals, ends = _driven(request, stored, fleet, ids)
    ways: dict[int, Way] = {}
    for index, item in enumerate(request.routes):
        part = f"routes/{index}"
        if item.route >= len(driven):
            raise invalid(f"{part}/route", "no-such-route", routes=len(driven), came=item.route)
        if item.route in ways:
            raise invalid(f"{part}/route", "given-twice", came=item.route)
        if item.leaves is not None and fleet.rules.clock is None:
            raise invalid(f"{part}/leaves", "fleet-has-no-clock")
        ways[item.route] = _way(item, part, fleet, driven[item.route], ids)
    waiting = {at: each.route for at, each in enumerate(driven) if at not in ways}
    return DaySoFar(tuple(ways.values()), waiting, arrivals, ends)


def _driven(
    request: ReplanFleetRequest, stored: StoredFront, fleet: UnmeasuredFleet, ids: Mapping[str, int]
) -> tuple[list[_Driven], dict[int, float], dict[int, float]]:
    """Return the routes of the plan that is driven, and when each visit is reached and ends."""
    plans = stored.found.split()
    if not plans:
        raise not_replannable(stored.id, "it has no plan")
    number = knee(stored.found.lengths) if request.plan is None else request.plan
    if number >= len(plans):
        raise invalid("plan", "no-such-plan", plans=len(plans), came=number)
    types = {name: index for index, name in enumerate(fleet.vehicles)}
    routes: list[_Driven] = []
    arrivals: dict[int, float] = {}
    ends: dict[int, float] = {}
    for item in from_json(plans[number])["routes"]:
        kind = types[VehicleName(item["vehicle"], item.get("shift"), item.get("route"))]
        vehicle = fleet.rules.vehicles[kind]
        stops = [ids[stop] for stop in item["stops"]]
        first = 0 if vehicle.start is None else 1
        last = len(stops) - (0 if vehicle.end is None else 1)
        route, times = Route(kind, tuple(stops[first:last])), item.get("arrivals", ())
        limited = (tuple(item.get(name, ())) for name in ("distance", "driving"))
        routes.append(_Driven(route, tuple(stops), times[0] if times else None, *limited))
        arrivals |= zip(stops, times, strict=False)
        ends |= zip(stops, item.get("ends", ()), strict=False)
    return routes, arrivals, ends


def _way(
    item: RouteOnTheWay,
    part: str,
    fleet: UnmeasuredFleet,
    driven: _Driven,
    ids: Mapping[str, int],
) -> Way:
    rules, route = fleet.rules, driven.route
    done = _done(item, part, rules, route, ids)
    after = max((route.stops.index(stop) for stop in done), default=-1) + 1
    vehicle = rules.vehicles[route.vehicle]
    reload = vehicle.reload
    is_rest = fleet.vehicles[route.vehicle].route is not None
    home = vehicle.home if is_rest else vehicle.start
    position = _position(item, part, rules, route, done, ids)
    skipped = [s for s in route.stops[:after] if s not in done and s not in reload]
    left = (*skipped, *route.stops[after:])
    is_done = set(left) <= {*reload}
    reached = driven.reached(done, position, is_done=is_done)
    return Way(
        part=part,
        number=item.route,
        type=route.vehicle,
        position=position,
        left=left,
        done=done,
        trips=sum(stop in reload for stop in route.stops[:after]),
        departure=driven.departure,
        leaves=item.leaves or 0.0,
        broken_down=item.broken_down,
        home=home,
        is_back=position is not None and position == home and is_done,
        distance=_so_far(item.distance, driven.distance, reached),
        driving=_so_far(item.driving, driven.driving, reached),
    )


def _done(
    item: RouteOnTheWay, part: str, rules: Rules, route: Route, ids: Mapping[str, int]
) -> tuple[int, ...]:
    """Return the stops that were visited; those to load again may be named too, and are skipped."""
    done: list[int] = []
    for index, reference in enumerate(item.done):
        where = f"{part}/done/{index}"
        stop = find_index(reference, ids, where, len(ids))
        if stop not in route.stops:
            raise invalid(where, "not-of-route", came=reference)
        if stop in done:
            raise invalid(where, "given-twice", came=reference)
        if stop not in rules.depots:
            done.append(stop)
    return tuple(done)


def _position(
    item: RouteOnTheWay,
    part: str,
    rules: Rules,
    route: Route,
    done: Sequence[int],
    ids: Mapping[str, int],
) -> int | None:
    """Return the stop where a vehicle goes on, None for a new place."""
    where = f"{part}/position"
    if isinstance(item.position, NewStop):
        return None
    if item.position is None:
        position = done[-1] if done else rules.vehicles[route.vehicle].start
        if position is None:
            raise invalid(where, "no-position")
        return position
    position = find_index(item.position, ids, where, len(ids))
    if position not in done and position not in rules.depots:
        raise invalid(where, "not-a-position", came=item.position)
    return position


def removed_stops(
    request: ReplanFleetRequest, day: DaySoFar, rules: Rules, ids: Mapping[str, int]
) -> frozenset[int]:
    """Return the stops that the request takes out of the plan.

    Raises:
        Refusal: One is not a stop, done or a depot, or only half of a shipment.
    """
    removed = []
    for index, reference in enumerate(request.remove):
        part = f"remove/{index}"
        stop = find_index(reference, ids, part, len(ids))
        if stop in rules.depots or stop in day.done:
            code = "removed-depot" if stop in rules.depots else "removed-done"
            raise invalid(part, code, came=reference)
        removed.append(stop)
    for each in rules.shipments:
        halves = [stop for stop in (each.pickup, each.delivery) if stop in removed]
        if len(halves) == 1 and each.pickup not in day.done:
            raise invalid(f"remove/{removed.index(halves[0])}", "half-a-shipment")
    return frozenset(removed)
