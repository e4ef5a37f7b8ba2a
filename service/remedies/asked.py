"""A fleet that has no plan, as its request names it, and the trial of other rules."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from operator import le
from typing import Any, TypeVar

from service.errors import Remedy
from service.fleet.fleet import Fleet
from service.fleet.plans import FleetFront
from service.fleet.rules import Rules
from service.fleet.vehicles import VehicleType, Visit
from service.remedies.patch import Operation, put, remove

Amount = TypeVar("Amount")
# Returns the changed members of the vehicles of an id.
Members = Mapping[str, Any]
ChangeOfVehicles = Callable[[str, VehicleType], Members]
Patch = tuple[Operation, ...]
# Returns the front of the fleet under other rules; None if no plan was found soon.
Try = Callable[[Rules], FleetFront | None]


@dataclass(frozen=True, kw_only=True)
class AskedFleet:
    """A fleet and the names that its request has for it.

    Args:
        vehicles: The id of each type of vehicles; those of several shifts have the same.
        unit: The unit of the clock, if there is one.
        at_fault: The stops that its refusal names, if it names some.
    """

    fleet: Fleet
    stops: Sequence[str]
    vehicles: Sequence[str]
    unit: str | None
    at_fault: Sequence[int] = ()

    @property
    def rules(self) -> Rules:
        """The rules of the fleet."""
        return self.fleet.rules

    @cached_property
    def items(self) -> list[str]:
        """The ids of the types of vehicles in the order of the request."""
        return list(dict.fromkeys(self.vehicles))

    @cached_property
    def required(self) -> list[int]:
        """The stops that must be visited; a shipment counts as its pick-up alone."""
        deliveries = {each.delivery for each in self.rules.shipments}
        return [
            stop
            for stop in self.rules.clients
            if stop not in deliveries and self.rules.visits[stop].prize is None
        ]

    @property
    def likely(self) -> list[str]:
        """The ids of vehicles, first those of which one can serve the most stops."""
        pairs = enumerate(zip(self.vehicles, self.rules.vehicles, strict=True))
        served = {number: (item, self.serves(number, each)) for number, (item, each) in pairs}
        most = {item: max(n for of, n in served.values() if of == item) for item in self.items}
        return sorted(self.items, key=lambda item: -most[item])

    def serves(self, number: int, vehicle: VehicleType) -> int:
        """Return how many stops a type of vehicles may visit, has the skills for, and can load.

        Of the stops that its refusal names, or else of all. `number` is that of the type.
        """
        visits = [self.rules.visits[stop] for stop in self.at_fault or self.required]
        named = [each for each in visits if not each.vehicles or number in each.vehicles]
        able = [each for each in named if {*each.skills} <= {*vehicle.skills}]
        loads = [(each.demand, each.pickup) for each in able]
        return sum(all(map(le, load, vehicle.capacity)) for both in loads for load in both)

    def first_of(self, item: str) -> VehicleType:
        """Return the first type of vehicles of an id."""
        return self.rules.vehicles[self.vehicles.index(item)]

    def changed(self, change: ChangeOfVehicles) -> tuple[Rules, Patch]:
        """Return the rules with changed members of vehicles, and the operations that change them.

        `change` returns the changed members of the vehicles of an id, given the first of their
        types; a member that becomes None is removed.
        """
        changes = {item: change(item, self.first_of(item)) for item in self.items}
        pairs = zip(self.vehicles, self.rules.vehicles, strict=True)
        vehicles = tuple(replace(each, **changes[item]) for item, each in pairs)
        return replace(self.rules, vehicles=vehicles), self.patch_of_vehicles(changes)

    def patch_of_vehicles(self, changes: Mapping[str, Members]) -> Patch:
        """Return the operations that change members of the vehicles of each id."""
        return tuple(
            _operation(f"/vehicles/{index}/{name}", value)
            for index, item in enumerate(self.items)
            for name, value in changes[item].items()
        )

    def patch_of_stops(self, changes: Mapping[int, Members]) -> Patch:
        """Return the operations that change members of stops."""
        return tuple(
            put(f"/stops/{stop}/{name}", value)
            for stop, members in changes.items()
            for name, value in members.items()
        )

    def least_change(
        self,
        amounts: Sequence[Amount],
        change: Callable[[Amount, str, VehicleType], Members],
        tried: "Try",
    ) -> tuple[Amount, Patch] | None:
        """Return the least of ascending amounts by which a change of vehicles works, and its patch.

        `change` gets an amount before the other arguments.
        """
        found = least_that_works(
            amounts, lambda amount: self.changed(partial(change, amount))[0], tried
        )
        return found and (found[0], self.changed(partial(change, found[0]))[1])

    def with_visits(self, visits: dict[int, Visit]) -> Rules:
        """Return the rules with other demands of some stops."""
        changed = tuple(visits.get(stop, each) for stop, each in enumerate(self.rules.visits))
        return replace(self.rules, visits=changed)


# Returns a remedy of one kind for a fleet that has no plan, if it finds one that works.
Look = Callable[[AskedFleet, Try], Remedy | None]


def least_that_works(
    amounts: Sequence[Amount], rules_with: Callable[[Amount], Rules], tried: Try
) -> tuple[Amount, FleetFront] | None:
    """Return the least of ascending amounts that works, and its front; None if none does in time.

    What is between the last that was too little and one that works is bisected. If the time ends,
    the least that has worked by then is returned.
    """
    low, high, at, step = 0, len(amounts), 0, 1
    found: tuple[Amount, FleetFront] | None = None
    while low < high:
        if front := tried(rules_with(amounts[at])):
            found, high = (amounts[at], front), at
        else:
            low = at + 1
        at = (low + high) // 2 if found else min(low + step - 1, high - 1)
        step *= 2
    return found


def _operation(path: str, value: object) -> Operation:
    if value is None:
        return remove(path)
    return put(path, list(value) if isinstance(value, tuple) else value)
