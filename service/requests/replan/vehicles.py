"""The vehicles of the rest of a fleet's day: on their way, not yet gone, and spares."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

from service.errors import invalid
from service.fleet.rules import Rules
from service.fleet.vehicles import VehicleType
from service.requests.replan.changes import NamedType, by_route
from service.requests.replan.day import DaySoFar, Way
from service.requests.replan.fleet_fields import ReplanFleetRequest
from service.requests.task import UnmeasuredFleet, VehicleName, types_by_id, types_of


@dataclass(frozen=True)
class RestVehicles:
    """The types of vehicles of the rest, each with its name and its number among the front's.

    Args:
        left: Those on their way, then those that have not left. If there are none, the types of
            which there may be more, with no vehicle.
        spares: Those of which none is left, of which there may be more.
    """

    left: tuple[NamedType, ...]
    spares: tuple[NamedType, ...]

    @property
    def all(self) -> tuple[NamedType, ...]:
        """Those left, then the spares."""
        return (*self.left, *self.spares)

    @property
    def ends(self) -> frozenset[int]:
        """The stops at which those left start, end or load again."""
        return frozenset(end for _, each, _ in self.left for end in _ends_of(each))


def vehicles_of_rest(
    request: ReplanFleetRequest,
    fleet: UnmeasuredFleet,
    day: DaySoFar,
    place_of: Callable[[Way], int],
    *,
    by_routes: bool,
) -> RestVehicles:
    """Return the vehicles of the rest.

    Args:
        fleet: The fleet of the front, changed as they say.
        place_of: Returns the index of a vehicle's new position.
        by_routes: Whether each route that has not begun needs a type of its own.

    Raises:
        Refusal: Vehicles cannot be on their way, or more of them are not known.
    """
    now = request.now or 0.0
    left = [
        (
            replace(fleet.vehicles[way.type], route=way.number),
            _on_the_way(way, fleet, now, place_of),
            way.type,
        )
        for way in day.working
    ]
    used = [way.type for way in day.ways]
    known = list(_not_gone(request, fleet, used, now))
    able = [each for each in known if not _is_over(each[1])]
    waiting = [each for each in able if each[1].count > 0]
    if not waiting:  # with more overtime, those could leave whose shift is over
        waiting = [each for each in known if each[1].count > 0]
    if by_routes or any(name.route is not None for name, _, _ in waiting):
        waiting = list(by_route(waiting, day.waiting))
    spares = [(name, replace(each, count=0), old) for name, each, old in _first_of_each(able)]
    if not left and not waiting:
        return RestVehicles(tuple(spares), ())
    found = RestVehicles((*left, *waiting), ())
    names = {name for name, _, _ in waiting}
    return replace(
        found,
        spares=tuple(
            each
            for each in spares
            if each[0] not in names and found.ends.issuperset(_ends_of(each[1]))
        ),
    )


def _not_gone(
    request: ReplanFleetRequest, fleet: UnmeasuredFleet, used: Sequence[int], now: float
) -> Iterator[NamedType]:
    """Yield the types that may still leave, with as many vehicles as have not left, maybe none.

    Those whose last shift is over have what is left of their overtime, or what the request gives
    them from now on.
    """
    longer = {each.vehicle for each in request.vehicles if each.max_overtime is not None}
    more = {each.vehicle: (index, each.more) for index, each in enumerate(request.vehicles)}
    names = (*fleet.vehicles, *fleet.names_of_spares)
    types = (*fleet.rules.vehicles, *fleet.spares)
    ends = [(name.id, vehicle.shift[1]) for name, vehicle in zip(names, types, strict=True)]
    last = dict(sorted(ends, key=lambda each: each[1]))
    for old, (name, vehicle) in enumerate(zip(names, types, strict=True)):
        begin, end = max(vehicle.shift[0], now), vehicle.shift[1]
        if begin > vehicle.leaves_by or (begin > end and end < last[name.id]):
            continue
        left = replace(vehicle, shift=(begin, max(begin, end)))
        if begin > end and name.id not in longer:
            left = replace(left, max_overtime=max(0.0, vehicle.way[1] - begin))
        count = vehicle.count - used.count(old)
        if name.route is None and not _is_over(left):
            count += more.pop(name.id, (0, 0))[1]
        yield name, replace(left, count=count), old
    for vehicle_id, (index, count) in more.items():
        if count:
            raise invalid(f"vehicles/{index}/more", "no-more-vehicles", came=vehicle_id)


def _is_over(vehicle: VehicleType) -> bool:
    """Return whether no time is left of a vehicle's shift and overtime."""
    begin, end = vehicle.way
    return begin == end


def _first_of_each(known: Iterable[NamedType]) -> Iterator[NamedType]:
    """Yield the first type of each id that is of no route: of which there may be more."""
    seen: set[str] = set()
    for each in known:
        name = each[0]
        if name.route is None and name.id not in seen:
            seen.add(name.id)
            yield each


def _ends_of(vehicle: VehicleType) -> list[int]:
    ends = (vehicle.start, vehicle.end, *vehicle.reload)
    return [end for end in ends if end is not None]


def _on_the_way(
    way: Way, fleet: UnmeasuredFleet, now: float, place_of: Callable[[Way], int]
) -> VehicleType:
    """Return a vehicle on its way as a type of its own."""
    vehicle = fleet.rules.vehicles[way.type]
    position = place_of(way) if way.position is None else way.position
    timed = fleet.rules.clock is not None
    leaves = max(now, way.leaves)
    gone = 0.0 if way.departure is None else max(0.0, leaves - way.departure)
    visits, trips = vehicle.max_stops, vehicle.max_trips
    return replace(
        vehicle,
        count=1,
        start=position,
        home=way.home,
        shift=(leaves, max(leaves, vehicle.shift[1])) if timed else vehicle.shift,
        leaves_by=leaves if timed and not way.is_back else inf,
        longest=max(0.0, vehicle.longest - gone),
        max_distance=_left(vehicle.max_distance, way.distance, f"{way.part}/distance"),
        max_driving=_left(vehicle.max_driving, way.driving, f"{way.part}/driving"),
        fixed=0.0,
        max_stops=None if visits is None else max(0, visits - len(way.done)),
        min_stops=max(0, vehicle.min_stops - len(way.done)),
        shortest=max(0.0, vehicle.shortest - gone),
        max_trips=None if trips is None else max(1, trips - way.trips),
        initial_load=_on_board(way, fleet.rules, vehicle),
    )


def _left(limit: float, driven: float | None, part: str) -> float:
    """Return what is left of a limit on driving."""
    if limit == inf:
        return inf
    if driven is None:
        raise invalid(part, "not-driven", member=f"max_{part.rpartition('/')[2]}")
    return max(0.0, limit - driven)


def _on_board(way: Way, rules: Rules, vehicle: VehicleType) -> tuple[int, ...]:
    """Return the load that stays on board to the end: from the start, and from stops.

    A vehicle that holds too much takes on no more.
    """
    taken = [rules.visits[stop].pickup for stop in way.done]
    if way.trips or way.is_back:
        return ()
    if not any(map(any, taken)):
        return vehicle.initial_load
    loads = [load for load in (vehicle.initial_load, *taken) if load]
    return tuple(map(min, map(sum, zip(*loads, strict=True)), vehicle.capacity))


def changed_fleet(
    request: ReplanFleetRequest, fleet: UnmeasuredFleet, ids: Mapping[str, int]
) -> UnmeasuredFleet:
    """Return the fleet of a front with what is asked otherwise of its stops and vehicles.

    Raises:
        Refusal: A stop or an id of vehicles is not known.
    """
    if not request.stops and not request.vehicles:
        return fleet
    rules = fleet.rules
    visits = list(rules.visits)
    for index, stop in enumerate(request.stops):
        at = stop.index(f"stops/{index}", ids, rules.depots)
        visits[at] = stop.of(visits[at], f"stops/{index}")
    types = [*rules.vehicles, *fleet.spares]
    names: tuple[VehicleName, ...] = (*fleet.vehicles, *fleet.names_of_spares)
    for index, item in enumerate(request.vehicles):
        own = types_of(item.vehicle, types_by_id(names), f"vehicles/{index}")
        if item.max_overtime is not None:
            for at in own:
                types[at] = replace(types[at], max_overtime=item.max_overtime)
    n = len(rules.vehicles)
    changed = replace(rules, visits=tuple(visits), vehicles=tuple(types[:n]))
    return replace(fleet, rules=changed, spares=tuple(types[n:]))
