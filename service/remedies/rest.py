"""The rest of a fleet's day that has no plan, and how a request to replan changes its rules."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from service.fleet.rules import Rules
from service.fleet.vehicles import VehicleType, Visit
from service.remedies.asked import AskedFleet, Members, Patch
from service.remedies.patch import Operation, put

Items = Sequence[Mapping[str, Any]]


@dataclass(frozen=True, kw_only=True)
class AskedRest(AskedFleet):
    """The rest of a day. Its stops and vehicles are not in the request, so changes name them.

    Args:
        parts: The part of the request that has each stop, such as add/0; empty if it is of the
            front.
        changed_stops: The member `stops` of the request.
        changed_vehicles: Its member `vehicles`.
        spares: The types of vehicles of which none is left, though there may be more.
        more: The type of which there may be more by its id: its number, where the first spare
            follows the last type of the rules.
    """

    parts: Sequence[str]
    changed_stops: Items
    changed_vehicles: Items
    spares: Sequence[VehicleType]
    more: Mapping[str, int]

    def patch_of_vehicles(self, changes: Mapping[str, Members]) -> Patch:
        """Return the operations that change members of the vehicles of each id."""
        given = {item: members for item, members in changes.items() if members}
        found = _merged(self.changed_vehicles, "vehicle", given)
        return (put("/vehicles", found),) if given else ()

    def patch_of_stops(self, changes: Mapping[int, Members]) -> Patch:
        """Return the operations that change members of stops."""
        known = {self.stops[stop]: each for stop, each in changes.items() if not self.parts[stop]}
        found = _merged(self.changed_stops, "stop", known)
        return (*([put("/stops", found)] if known else []), *self._patch_of_added(changes))

    def _patch_of_added(self, changes: Mapping[int, Members]) -> Iterator[Operation]:
        for stop, members in changes.items():
            if self.parts[stop]:
                yield from (put(f"/{self.parts[stop]}/{each}", members[each]) for each in members)

    @property
    def likely(self) -> list[str]:
        """The ids of which there may be more, first those of which one can serve the most stops."""
        types = (*self.rules.vehicles, *self.spares)
        served = {item: self.serves(at, types[at]) for item, at in self.more.items()}
        return sorted(self.more, key=lambda item: -served[item])

    def with_more(self, item: str, more: int) -> tuple[Rules, Patch]:
        """Return the rules with more vehicles of an id, and the operation that adds them."""
        known = [each.get("more", 0) for each in self.changed_vehicles if each["vehicle"] == item]
        patch = self.patch_of_vehicles({item: {"more": sum(known) + more}})
        number, types = self.more[item], list(self.rules.vehicles)
        if number < len(types):
            types[number] = replace(types[number], count=types[number].count + more)
            return replace(self.rules, vehicles=tuple(types)), patch
        visits = tuple(_by_spare(each, number, len(types)) for each in self.rules.visits)
        types.append(replace(self.spares[number - len(types)], count=more))
        return replace(self.rules, visits=visits, vehicles=tuple(types)), patch


def _merged(items: Items, key: str, changes: Mapping[str, Members]) -> list[dict[str, Any]]:
    """Return items of a list with changed members, and further items; each is named by a key."""
    found: dict[str, dict[str, Any]] = {}
    for item in items:
        found[item[key]] = {**found.get(item[key], {}), **item}
    for name, members in changes.items():
        given = {each: value for each, value in members.items() if value is not None}
        found[name] = {**found.get(name, {key: name}), **given}
    return list(found.values())


def _by_spare(visit: Visit, spare: int, last: int) -> Visit:
    """Return a visit under rules with one of the spares alone, as the last type."""
    vehicles = [last if each == spare else each for each in visit.vehicles]
    vehicles = [each if each <= last else last + 1 for each in vehicles]
    services = visit.services and (*visit.services[:last], visit.services[spare])
    return replace(visit, vehicles=tuple(vehicles), services=services)
