"""The plan of a fleet that is driven or was promised, in requests of `POST /fleet`."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from pydantic import Field

from service.errors import invalid
from service.fleet.plans import Route
from service.fleet.promises import Types, promised, types_by_route
from service.fleet.vehicles import VehicleType, Visit
from service.requests.fields import (
    Items,
    NonNegativeInteger,
    SomeItems,
    StrictModel,
    Text,
    Time,
    empty_list,
    optional,
)
from service.requests.stop_fields import StopReference, find_indexes
from service.requests.task import VehicleName, types_by_id, types_of


class PromisedRouteItem(StrictModel):
    """A route of a plan that is driven or was promised, as answers have them."""

    vehicle: Text = Field(description="the id of the type of its vehicle")
    shift: NonNegativeInteger = Field(
        default=0, description="the number of its shift, if its vehicle has several"
    )
    stops: SomeItems[StopReference] = Field(
        description="in order, by index or id; with or without its start and end"
    )
    arrivals: Items[Time] = empty_list("when it reaches each of these; needed for a tolerance")


class PromisedItem(StrictModel):
    """A plan that is driven or was promised."""

    routes: SomeItems[PromisedRouteItem] = Field(description="its routes")
    tolerance: Time | None = optional(
        "how much later than in this plan a visit may begin, in the clock's unit, without being a"
        " change; null: only changes of vehicles count"
    )


@dataclass(frozen=True)
class PromisedPlan:
    """A plan that is driven or was promised, each of whose routes has a type of vehicles.

    Args:
        names: The name of each type of vehicles.
        arrivals: When its vehicle reaches each stop, if that is given.
    """

    types: Types
    names: tuple[VehicleName, ...]
    routes: tuple[Route, ...]
    arrivals: Mapping[int, float]

    def visits(self, visits: Sequence[Visit], slack: float) -> tuple[Visit, ...]:
        """Return stops of which those of the plan are promised."""
        vehicles = {stop: route.vehicle for route in self.routes for stop in route.stops}
        return tuple(
            promised(visit, vehicles[stop], self.arrivals.get(stop), slack)
            if stop in vehicles and stop not in self.depots
            else visit
            for stop, visit in enumerate(visits)
        )

    @property
    def depots(self) -> frozenset[int]:
        """The stops at which its vehicles load again."""
        return frozenset(stop for each in self.types.vehicles for stop in each.reload)


def promised_plan(
    item: PromisedItem,
    vehicles: Sequence[VehicleType],
    names: Sequence[VehicleName],
    ids: Mapping[str, int],
) -> PromisedPlan:
    """Return the plan that a request says is driven or was promised.

    Raises:
        Refusal: It names a vehicle or a stop that is not there, or more routes than vehicles.
    """
    by_id, used = types_by_id(names), Counter[int]()
    for index, each in enumerate(item.routes):
        part = f"promised/routes/{index}"
        kind = _kind(each, part, by_id)
        used[kind] += 1
        if used[kind] > vehicles[kind].count:
            raise invalid(f"{part}/vehicle", "more-than-vehicles", limit=vehicles[kind].count)
        if len(each.arrivals) != len(each.stops) and (each.arrivals or item.tolerance is not None):
            numbers, came = len(each.stops), len(each.arrivals)
            raise invalid(f"{part}/arrivals", "not-as-stops", numbers=numbers, came=came)
    types = types_by_route(vehicles, [_kind(each, "", by_id) for each in item.routes])
    stops = [
        dict(_stops(each, f"promised/routes/{i}", types.vehicles[types.of_routes[i]], ids))
        for i, each in enumerate(item.routes)
    ]
    _check_stops(item, stops, vehicles)
    numbers_of = {kind: number for number, kind in enumerate(types.of_routes)}
    return PromisedPlan(
        types=types,
        names=tuple(
            replace(names[old], route=numbers_of.get(kind)) for kind, old in enumerate(types.old)
        ),
        routes=tuple(
            Route(kind, tuple(each.values()))
            for kind, each in zip(types.of_routes, stops, strict=True)
            if each
        ),
        arrivals={
            stop: route.arrivals[place]
            for route, each in zip(item.routes, stops, strict=True)
            for place, stop in each.items()
            if route.arrivals
        },
    )


def _kind(item: PromisedRouteItem, part: str, by_id: Mapping[str, tuple[int, ...]]) -> int:
    """Return the type of the vehicle of a route."""
    shifts = types_of(item.vehicle, by_id, part)
    if item.shift >= len(shifts):
        raise invalid(f"{part}/shift", "no-such-shift", shifts=len(shifts), came=item.shift)
    return shifts[item.shift]


def _stops(
    item: PromisedRouteItem, part: str, vehicle: VehicleType, ids: Mapping[str, int]
) -> Iterator[tuple[int, int]]:
    """Yield the places and the stops of a route, without its start and end."""
    stops = find_indexes(item.stops, ids, f"{part}/stops")
    first = int(stops[0] == vehicle.start)
    last = len(stops) - int(len(stops) > first and stops[-1] == vehicle.end)
    return zip(range(first, last), stops[first:last], strict=True)


def _check_stops(
    item: PromisedItem, routes: Sequence[Mapping[int, int]], vehicles: Sequence[VehicleType]
) -> None:
    """Raise a refusal if a depot is visited, or a stop twice."""
    reload = {stop for each in vehicles for stop in each.reload}
    ends = {end for each in vehicles for end in (each.start, each.end)} - reload
    found = set[int]()
    for index, stops in enumerate(routes):
        for place, stop in stops.items():
            part = f"promised/routes/{index}/stops/{place}"
            if stop in ends:
                raise invalid(part, "promised-depot")
            if stop in found:
                came = item.routes[index].stops[place]
                raise invalid(part, "given-twice", came=came)
            found |= {stop} - reload
