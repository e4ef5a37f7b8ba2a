"""The rest of a fleet's day: what is left of the plan that is driven, and what has changed."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from math import inf
from typing import Any

import numpy as np

from service.actor_info import ActorInfo
from service.errors import Fault, Refusal, invalid
from service.errors.parts import by_stop
from service.fleet.plans import Route
from service.fleet.vehicles import Shipment, Span, VehicleType, Visit
from service.requests.limits import (
    Limits,
    check_fleet,
    check_limit,
    check_router,
    within_limits,
)
from service.requests.parser import actor_for_plans
from service.requests.replan.changes import objectives_with, promised_begin, tolerance_of
from service.requests.replan.costs import AllStops, all_stops
from service.requests.replan.day import Way, day_of, removed_stops
from service.requests.replan.fields import NewStop
from service.requests.replan.fleet_costs import sources_of_rest, spreads_of_rest
from service.requests.replan.fleet_fields import ReplanFleetRequest
from service.requests.replan.vehicles import changed_fleet, vehicles_of_rest
from service.requests.replan.way import ReplanSource, StoredFront
from service.requests.stops import Labels, Stops, locations_of
from service.requests.task import Task, UnmeasuredFleet, types_by_id
from service.requests.validation import parse_json, too_many_cities

_LATER = 1e-6  # of the greatest time: what cannot be loaded now is released this much later


def rest_of_fleet(
    fleet: UnmeasuredFleet,
    task: Task,
    source: ReplanSource,
    limits: Limits,
    actors: Mapping[str, ActorInfo],
) -> Task:
    """Return what is left to plan of a fleet.

    Raises:
        Refusal: The request is over a limit, or the front cannot be replanned so.
    """
    assert task.labels is not None
    request = parse_json(ReplanFleetRequest, source.body)
    check_limit("routes", limits.fleet_stops, len(request.routes))
    rest = _Rest(request, source.front, fleet, task.labels)
    n = len(rest.labels.stops)
    if n > limits.fleet_stops:
        raise too_many_cities("add", limits.fleet_stops, n, "too-many-left")
    # Each stop may come in a route, and depots again in each of as many routes.
    id_bytes = 3 * rest.labels.id_bytes + sum(len(name.id) for name in rest.names)
    request = within_limits(request, n, limits, id_bytes)
    try:
        subject = rest.subject
    except Refusal as refusal:
        raise by_stop(refusal, rest.labels.city_names) from None
    most = (limits, request.time_limit, "too-many-left-unless-straight")
    check_fleet("add", subject.stops, *most)
    check_router(subject.stops.sources, limits)
    return Task(
        subject=subject,
        options=request.options(len(subject.rules.over)),
        actor=actor_for_plans(actors),
        labels=rest.labels,
        geometry=request.geometry,
    )


class _Rest:
    """The rest that is to be planned. Indexes of stops count those of the front, then new ones."""

    def __init__(
        self,
        request: ReplanFleetRequest,
        stored: StoredFront,
        fleet: UnmeasuredFleet,
        labels: Labels,
    ) -> None:
        if (request.now is None) != (fleet.rules.clock is None):
            timed = fleet.rules.clock is not None
            raise invalid("now", "fleet-has-clock" if timed else "fleet-has-no-clock")
        ids = {stop.id: index for index, stop in enumerate(labels.stops)}
        fleet = changed_fleet(request, fleet, ids)
        self._request, self._fleet, self._rules, self._known = request, fleet, fleet.rules, labels
        self._day = day_of(request, stored, fleet, ids)
        self._all = _all_stops(request, labels)
        self._removed = removed_stops(request, self._day, fleet.rules, ids)
        gone = self._day.done | self._removed
        self._left = [stop for stop in fleet.rules.clients if stop not in gone]
        self._carried = self._carriers()
        known, changes = labels.objectives, request.changes
        self._objectives, self._over = objectives_with(changes, known, fleet.rules)
        self._tolerance = tolerance_of(changes, self._over, fleet.rules)
        by_routes = "changes" in self._over
        self._vehicles = vehicles_of_rest(
            request, fleet, self._day, self._place_of, by_routes=by_routes
        )
        self.names = tuple(name for name, _, _ in self._vehicles.left)
        self._types = [vehicle for _, vehicle, _ in self._vehicles.left]
        self._old = [old for _, _, old in self._vehicles.all]
        if not self._types:
            raise Refusal("no-plan", errors=[Fault("no-vehicle-left")])

    @property
    def _added(self) -> range:
        return range(self._all.n, self._all.n + len(self._request.add))

    @cached_property
    def _ends(self) -> frozenset[int]:
        """The stops at which the vehicles start, end or load again."""
        return self._vehicles.ends

    @cached_property
    def _place(self) -> dict[int, int]:
        """The index of each stop in the rest."""
        chosen = sorted({*self._left, *self._added, *self._ends})
        return {stop: index for index, stop in enumerate(chosen)}

    @cached_property
    def labels(self) -> Labels:
        """The names of the stops of the rest, and of the objectives."""
        return Labels(
            tuple(self._all.stops[stop] for stop in self._place),
            self._objectives,
            tuple(self._all.parts[stop] for stop in self._place),
        )

    @property
    def subject(self) -> UnmeasuredFleet:
        """The fleet of the rest."""
        rules = replace(
            self._rules,
            visits=tuple(self._visit(stop) for stop in self._place),
            vehicles=tuple(self._placed(vehicle) for vehicle in self._types),
            shipments=tuple(self._shipments()),
            over=self._over,
            layers=(*self._rules.layers, 0)[: len(self._over)],
            slack=self._rules.slack if self._request.slack is None else self._request.slack,
            tolerance=self._tolerance,
            groups=self._rules.groups.among({stop: self._place[stop] for stop in self._left}),
        )
        changed = self._request.costs, self._all
        chosen = np.array(list(self._place), np.int64)
        sources = sources_of_rest(self._fleet, self._known.objectives, *changed, chosen)
        spreads = spreads_of_rest(self._fleet, sources, chosen)
        stops = Stops(locations_of(self.labels.stops), sources, spreads=spreads)
        return UnmeasuredFleet(
            rules,
            self.names,
            stops,
            tuple(self._driven()),
            self._fleet.clock,
            self._fleet.profiles,
            spares=tuple(self._placed(vehicle) for _, vehicle, _ in self._vehicles.spares),
            names_of_spares=tuple(name for name, _, _ in self._vehicles.spares),
            changes={"stops": self._changed_stops(), "vehicles": self._changed("vehicles")},
        )

    def _changed(self, name: str) -> list[dict[str, Any]]:
        found = self._request.model_dump(include={name}, exclude_unset=True)
        return [each for _, items in found.items() for each in items]

    def _changed_stops(self) -> list[dict[str, Any]]:
        """Return what is asked otherwise of stops, which are named by their ids."""
        ids = [stop.id for stop in self._known.stops]
        named = ((each, each["stop"]) for each in self._changed("stops"))
        return [{**each, "stop": ids[x] if isinstance(x, int) else x} for each, x in named]

    @cached_property
    def _pickups(self) -> dict[int, int]:
        """Where what is brought to a stop is picked up, by the stop."""
        return {each.delivery: each.pickup for each in self._rules.shipments}

    def _carriers(self) -> dict[int, int]:
        """Return, by stop, the type of the vehicle on its way that carries what it brings there."""
        carried = {}
        for number, way in enumerate(self._day.working):
            reload = self._rules.vehicles[way.type].reload
            reloads = [place for place, stop in enumerate(way.left) if stop in reload]
            for place, stop in enumerate(way.left):
                picked_up = self._pickups.get(stop) in way.done
                loaded = stop not in self._rules.shipped and place < min(reloads, default=inf)
                if picked_up or loaded:
                    carried[stop] = number
        return carried

    def _place_of(self, way: Way) -> int:
        """Return the index of the new position of a vehicle."""
        return self._all.n + list(self._all.new).index(f"{way.part}/position")

    @property
    def _now(self) -> float:
        return self._request.now or 0.0

    def _visit(self, stop: int) -> Visit:
        """Return what a stop of the rest asks for."""
        if stop in self._ends:
            return Visit()
        if stop >= self._all.n:
            index = stop - self._all.n
            types = types_by_id((*self._fleet.vehicles, *self._fleet.names_of_spares))
            visit = self._request.add[index].visit(f"add/{index}", types)
        else:
            visit = self._known_visit(stop)
        visit = replace(visit, windows=self._windows(stop, visit))
        services = visit.services and tuple(visit.services[old] for old in self._old)
        servers, release = self._servers(stop, visit), self._release(stop, visit)
        vehicle, begin = self._promise(stop)
        return replace(
            visit,
            vehicles=servers,
            release=release,
            services=services,
            promised_to=vehicle,
            promised_by=begin,
        )

    def _windows(self, stop: int, visit: Visit) -> tuple[Span, ...]:
        """Return the windows of a stop from when on it may begin, after visits that are done."""
        firsts = [first for first, _ in self._firsts.get(stop, ()) if first in self._day.done]
        since = self._waits_until(stop, {first: self._ended(first) for first in firsts})
        if since <= self._now:
            return visit.windows
        later = [(max(opens, since), closes) for opens, closes in visit.windows if since <= closes]
        return tuple(later) or ((since, visit.windows[-1][1]),)

    def _waits_until(self, stop: int, ends: Mapping[int, float]) -> float:
        """Return until when a visit waits for others, of which some have ended; 0 for none."""
        firsts = self._firsts.get(stop, ())
        return max((ends[first] + gap for first, gap in firsts if first in ends), default=0.0)

    @cached_property
    def _firsts(self) -> dict[int, list[tuple[int, float]]]:
        """The stops for which the visit of each stop waits, and how long after each."""
        found: dict[int, list[tuple[int, float]]] = {}
        for (first, then), gap in self._rules.groups.waiting.items():
            found.setdefault(then, []).append((first, gap))
        return found

    def _ended(self, stop: int) -> float:
        """Return when a visit that is done has ended: now at the latest, or when it is left."""
        way = next(way for way in self._day.ways if stop in way.done)
        if stop == way.done[-1] and way.leaves > self._now:
            return way.leaves
        return min(self._now, self._day.ends.get(stop, self._now))

    def _promise(self, stop: int) -> tuple[int | None, float]:
        """Return the vehicle that visits a stop in the plan so far, and when, if changes count."""
        if "changes" not in self._over or stop not in self._promised_to:
            return None, inf
        visit, arrival = self._rules.visits[stop], self._day.arrivals.get(stop)
        if arrival is not None:
            arrival = max(arrival, self._waits_until(stop, self._day.ends))
        begin = promised_begin(self._rules, visit, arrival, self._tolerance or 0.0)
        return self._promised_to[stop], begin

    @cached_property
    def _promised_to(self) -> dict[int, int]:
        """The type of vehicles of each stop in the plan so far; -1 for one that is gone."""
        found = dict.fromkeys(self._left, -1)
        for index, stops in self._routes_left():
            found |= dict.fromkeys(stops, index)
        return found

    def _known_visit(self, stop: int) -> Visit:
        """Return what a stop of the front asks for, also of shipments on board."""
        visit = self._rules.visits[stop]
        if self._pickups.get(stop) not in self._day.done:
            return visit
        pickup = self._rules.visits[self._pickups[stop]]
        return replace(visit, demand=pickup.demand, prize=pickup.prize)

    def _servers(self, stop: int, visit: Visit) -> tuple[int, ...]:
        """Return the types of the rest that may visit a stop, and spares; empty for all of them.

        What a vehicle carries stays with it. Vehicles on their way cannot load what they do not
        carry, unless they come to a stop for loading again, or are back.
        """
        if stop in self._carried:
            return (self._carried[stop],)
        able = [
            index
            for index, old in enumerate(self._old)
            if (not visit.vehicles or old in visit.vehicles) and self._may_ride(stop, index)
        ]
        if self._must_be_loaded(stop, visit):
            out = [i for i, way in enumerate(self._day.working) if not way.is_back]
            able = [i for i in able if i not in out or self._types[i].reload]
        nobody = len(self._old)
        return () if len(able) == nobody else tuple(able or [nobody])

    def _may_ride(self, stop: int, index: int) -> bool:
        """Return whether a stop may ride with what vehicles of a type have visited by now.

        What rode with it on a vehicle that is out of service does not matter.
        """
        groups, working = self._rules.groups, self._day.working
        rivals = {other for one, other in groups.rivals if one == stop}
        mates = groups.mates.get(stop, frozenset())
        before = [{*way.done} & mates for way in working]
        if index >= len(working):
            return not any(before)
        return not rivals & {*working[index].done} and (bool(before[index]) or not any(before))

    def _must_be_loaded(self, stop: int, visit: Visit) -> bool:
        return any(visit.demand) and stop not in self._shipped and stop not in self._carried

    @cached_property
    def _shipped(self) -> frozenset[int]:
        """The stops of the shipments that nobody has picked up."""
        left = self._left_shipments()
        return frozenset(stop for each in left for stop in (each.pickup, each.delivery))

    def _release(self, stop: int, visit: Visit) -> float:
        """Return when what is brought to a stop can be loaded: not by who is on the way now."""
        loading = any(each.leaves_by < inf and each.reload for each in self._types)
        if not loading or not self._must_be_loaded(stop, visit):
            return 0.0 if stop in self._carried else visit.release
        latest = max(each.shift[1] for each in self._types if each.shift[1] < inf)
        return max(visit.release, self._now + _LATER * max(latest, self._now, 1.0))

    def _left_shipments(self) -> Iterator[Shipment]:
        """Yield the shipments that nobody has picked up."""
        left = set(self._left)
        return (s for s in self._rules.shipments if s.pickup in left and s.delivery in left)

    def _shipments(self) -> Iterator[Shipment]:
        for each in self._left_shipments():
            yield Shipment(self._place[each.pickup], self._place[each.delivery])

    def _placed(self, vehicle: VehicleType) -> VehicleType:
        start, end = (None if e is None else self._place[e] for e in (vehicle.start, vehicle.end))
        reload = tuple(self._place[stop] for stop in vehicle.reload)
        home = None if vehicle.home is None else self._place.get(vehicle.home)
        return replace(vehicle, start=start, end=end, reload=reload, home=home)

    def _driven(self) -> Iterator[Route]:
        """Yield what is left of the routes of the plan."""
        for index, stops in self._routes_left():
            yield from self._rest_of_route(index, stops)

    def _routes_left(self) -> Iterator[tuple[int, tuple[int, ...]]]:
        """Yield the types of vehicles that may still drive their routes, with what is left."""
        working = self._day.working
        for index, way in enumerate(working):
            yield index, way.left
        for number, route in self._day.waiting.items():
            types = range(len(working), len(self._types))
            own = [i for i in types if self.names[i].route == number]
            for index in own or [i for i in types if self._old[i] == route.vehicle]:
                yield index, route.stops

    def _rest_of_route(self, vehicle: int, stops: Sequence[int]) -> Iterator[Route]:
        reload = self._types[vehicle].reload
        rest: list[int] = []
        for stop in stops:
            if (stop in reload and rest[-1:] != [stop]) or stop in self._left:
                rest.append(stop)
        if rest and rest[-1] in reload:
            rest.pop()
        if rest:
            yield Route(vehicle, tuple(self._place[stop] for stop in rest))


def _all_stops(request: ReplanFleetRequest, labels: Labels) -> AllStops:
    """Return the stops of the front, the added ones, and new positions."""
    items: dict[str, Any] = {f"add/{index}": item for index, item in enumerate(request.add)}
    for index, way in enumerate(request.routes):
        if isinstance(way.position, NewStop):
            items[f"routes/{index}/position"] = way.position
    return all_stops(labels.stops, items)
