"""Find in which slots an order can be inserted into a plan, and the best places for each.

All places are bounded for all slots at once (`screen.py`). Then the judge of fleets evaluates them
by ascending bounds, until no other place can be better in any objective.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from typing import get_args

import numpy as np

from service.fleet.evaluation import (
    Broken,
    first_broken,
    joined_lengths,
    plan_lengths,
    route_lengths,
    routes_broken,
)
from service.fleet.fleet import Array, Fleet
from service.fleet.left_out import Reason, exchanged, is_same_everywhere, with_stops
from service.fleet.plans import Plan, Route, path_of
from service.fleet.rules import Rule
from service.fleet.schedule import schedule, with_waits
from service.fleet.vehicles import Span
from service.offers.least_rises import LeastRises
from service.offers.places import Places, places_in
from service.offers.screen import bounds
from service.offers.slots import SlottedFleet, with_slots

MOST_CHOICES = 5  # of an offer
_ROUNDING = 1e-9  # of the scale: lengths that differ by less are equal
_RULES: tuple[Rule, ...] = get_args(Rule)  # from those that never change to those that may
_MENDED_BY_WAITS: tuple[Rule, ...] = ("longest", "shortest")
_SAME_IN_ALL_SLOTS = ("skills", "vehicle", "way", "capacity", "max_stops", "max_trips", "apart")


@dataclass(frozen=True)
class Choice:
    """A place for the order, and what it costs.

    Attributes:
        rise: What each length of the plan grows by.
        number: The number of the route in the plan; None for a vehicle that does not leave yet.
        vehicle: The type of the vehicle.
        after: The stop before the order; None if it is the first and the route has no start.
        arrival: When the vehicle arrives. It may wait until the slot begins.
    """

    rise: tuple[float, ...]
    number: int | None
    vehicle: int
    after: int | None
    arrival: float


@dataclass(frozen=True)
class Offer:
    """Whether the order can be visited in a slot, and at what price.

    Attributes:
        slot: When the visit may begin, from and to.
        choices: The places of which none is better in all objectives; first the one whose lengths
            grow the least in all, in units of the fleet's scale. None if it cannot be visited.
        reasons: If it cannot, for each type of vehicles the rule that forbids it.
        complete: Whether all places were tried.
    """

    slot: Span
    choices: tuple[Choice, ...]
    reasons: tuple[Reason, ...]
    complete: bool

    @property
    def rise(self) -> tuple[float, ...] | None:
        """The least that each length grows by; they may be of several choices."""
        if not self.choices:
            return None
        return tuple(min(column) for column in zip(*(c.rise for c in self.choices), strict=True))


@dataclass(frozen=True, eq=False)
class Offers:
    """The offers of an order beside a plan.

    Attributes:
        plan: The plan, with the stops that it had to visit and did not.
        lengths: Its lengths.
        offers: One for each slot.
    """

    plan: Plan
    lengths: tuple[float, ...]
    offers: tuple[Offer, ...]


def find_offers(
    fleet: Fleet,
    plan: Plan,
    order: int,
    slots: Sequence[Span],
    ended: Callable[[], bool] = lambda: False,
) -> Offers:
    """Return for each slot whether an order fits into a plan, and the best places for it.

    Other stops stay with their vehicles, in their order. A stop that must be visited and is not is
    inserted first, where it costs the least; if it fits nowhere, the plan goes without it.

    Args:
        fleet: The fleet, which has a clock. The order is one of its stops.
        plan: The plan, without the order.
        order: The stop. Its windows do not count.
        slots: When its visit may begin, from and to.
        ended: Called before each place is evaluated; once it returns True, the offers are what was
            found so far.
    """
    required = [stop for stop in fleet.rules.clients if stop in fleet.rules.required]
    plan = with_stops(fleet, plan, (stop for stop in required if stop != order))
    slotted = with_slots(fleet, order, slots)
    search = _Search(slotted, plan, ended)
    found = [_Found(np.empty((0, len(fleet.rules.over)))) for _ in slots]
    for most in (1, None):  # first a place for each slot, as the time may not suffice for more
        for slot, each in enumerate(found):
            search.extend(slot, each, most)
    offers = tuple(search.offer(slot, each) for slot, each in enumerate(found))
    lengths = plan_lengths(fleet, plan)
    return Offers(plan, lengths, offers)


@dataclass(eq=False)
class _Found:
    """What was found for a slot: rises, shape (k, m), and the k places; and the places tried."""

    rises: Array
    rows: list[int] = field(default_factory=list)
    tried: set[int] = field(default_factory=set)
    complete: bool = False


class _Search:
    """The places of a plan as rows: bounds for all slots, and what the judge says of each."""

    def __init__(self, slotted: SlottedFleet, plan: Plan, ended: Callable[[], bool]) -> None:
        self._slotted, self._plan, self._ended = slotted, plan, ended
        self._fleet = slotted.fleet
        self._rows: list[tuple[Places, int]] = []
        self._dead: dict[int, Broken] = {}  # rows that break a rule whatever the slot
        self._waits = bool(self._fleet.rules.groups.waiting)
        self._known = {*routes_broken(self._fleet, plan)} if self._waits else set()
        self._of_routes = [route_lengths(self._fleet, route) for route in plan.routes]
        self._base = np.array(plan_lengths(self._fleet, plan))
        late, least, rises = [], [], LeastRises(slotted, plan)
        for each in places_in(self._fleet, plan):
            known = bounds(slotted, each)
            late.append(known.late)
            least.append(rises.at(each, known))
            self._rows += [(each, place) for place in each.places]
        self._late = np.concatenate(late)  # (p, s)
        self._least = np.concatenate(least)  # (p, s, m)

    @cached_property
    def _scale(self) -> Array:
        return self._slotted.scale

    def extend(self, slot: int, found: _Found, most: int | None) -> None:
        """Add the best places for a slot: all, or until there are so many."""
        if found.complete:
            return
        least = self._least[:, slot]
        rows = np.flatnonzero(self._late[:, slot] == 0)
        rows = rows[np.argsort((least[rows] / self._scale).sum(axis=1), kind="stable")]
        for row in rows.tolist():
            if row in found.tried or row in self._dead or _is_beaten(least[row], found.rises):
                continue
            if self._ended():
                return
            found.tried.add(row)
            self._try(row, slot, found)
            if len(found.rows) == most:
                return
        found.complete = True

    def _try(self, row: int, slot: int, found: _Found) -> None:
        """Evaluate a place, and add it unless another one is as good in everything."""
        route = self._route(row, self._slotted.copy(slot))
        if self._broken(row, route) is not None:
            return
        rise = self._rise(row, route)
        if _is_beaten(rise, found.rises):
            return
        better = [n for n, each in enumerate(found.rises) if not (rise <= each).all()]
        found.rises = np.vstack((found.rises[better], rise))
        found.rows = [*(found.rows[n] for n in better), row]

    def _broken(self, row: int, route: Route) -> Broken | None:
        """Return the first rule that a place breaks, by itself or beside the other routes.

        Of other routes those rules do not count that they break without the order.
        """
        broken = first_broken(self._fleet, route)
        if broken is not None and not (self._waits and broken.rule in _MENDED_BY_WAITS):
            self._note(row, broken)
            return broken
        if not self._waits:
            return None
        longer = routes_broken(self._fleet, self._with(row, route))
        return next((pair[1] for pair in longer if pair not in self._known), None)

    def _with(self, row: int, route: Route) -> Plan:
        """Return the plan with a route in its place."""
        return exchanged(self._plan, self._rows[row][0].number, route)

    def _note(self, row: int, broken: Broken) -> None:
        """Remember a rule that a place breaks in all slots, or that all of its route do."""
        if broken.rule not in _SAME_IN_ALL_SLOTS:
            return
        self._dead[row] = broken
        places, _ = self._rows[row]
        if is_same_everywhere(self._fleet.rules, places.vehicle, broken.rule):
            for other, (each, _) in enumerate(self._rows):
                if each.number == places.number and each.vehicle == places.vehicle:
                    self._dead[other] = broken

    def _rise(self, row: int, route: Route) -> Array:
        """Return what the lengths of the plan grow by with a route, without roundings."""
        number, longer = self._rows[row][0].number, self._with(row, route)
        if self._waits:  # then other routes may change as well
            joined = plan_lengths(self._fleet, longer)
        else:
            lengths = [*self._of_routes]
            lengths[number : number + 1] = [route_lengths(self._fleet, route)]
            joined = joined_lengths(self._fleet, longer, lengths)
        grown = np.array(joined) - self._base
        return np.where(np.abs(grown) < _ROUNDING * self._scale, 0.0, grown)

    def _route(self, row: int, stop: int) -> Route:
        places, place = self._rows[row]
        return places.route(place, stop)

    def offer(self, slot: int, found: _Found) -> Offer:
        """Return the offer for a slot."""
        span = self._slotted.slots[slot]
        if not found.rows:
            reasons = () if self._ended() else self._reasons(slot)
            return Offer(span, (), reasons, found.complete)
        chosen = _spread(found.rises, self._scale)
        choices = tuple(self._choice(found.rows[n], slot, found.rises[n]) for n in chosen)
        return Offer(span, choices, (), found.complete)

    def _choice(self, row: int, slot: int, rise: Array) -> Choice:
        places, _ = self._rows[row]
        stop = self._slotted.copy(slot)
        longer = with_waits(self._fleet, self._with(row, self._route(row, stop)))
        route = longer.routes[places.number]
        path = path_of(self._fleet.rules, route)
        at = path.index(stop)
        return Choice(
            rise=tuple(rise.tolist()),
            number=places.number if places.number < len(self._plan.routes) else None,
            vehicle=places.vehicle,
            after=path[at - 1] if at else None,
            arrival=schedule(self._fleet, route).arrivals[at],
        )

    def _reasons(self, slot: int) -> tuple[Reason, ...]:
        """Return for each type of vehicles the rule that keeps it from a slot.

        Of several rules it is the one that the fewest places get as far as.
        """
        reasons: dict[int, Broken] = {}
        for row in np.argsort(self._late[:, slot], kind="stable").tolist():
            vehicle = self._rows[row][0].vehicle
            known = reasons.get(vehicle)
            if known is not None and known.rule not in _SAME_IN_ALL_SLOTS:
                continue
            broken = self._dead.get(row)
            if broken is None:
                if self._ended():
                    break
                broken = self._broken(row, self._route(row, self._slotted.copy(slot)))
                if broken is None:
                    continue
            if known is None or _RULES.index(broken.rule) > _RULES.index(known.rule):
                reasons[vehicle] = broken
        return tuple(Reason(*each) for each in sorted(reasons.items()))


def _is_beaten(rise: Array, rises: Array) -> bool:
    """Return whether one of these rises, shape (k, m), is nowhere larger."""
    return bool((rises <= rise).all(axis=1).any())


def _spread(rises: Array, scale: Array) -> list[int]:
    """Return the rises of an offer: the least in all, those least in one, and others."""
    order = np.argsort((rises / scale).sum(axis=1), kind="stable").tolist()
    least = [int(column.argmin()) for column in rises.T]
    return list(dict.fromkeys(chain(order[:1], least, order)))[:MOST_CHOICES]
