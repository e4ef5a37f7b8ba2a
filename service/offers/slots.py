"""A fleet in which an order is a stop of its own for each slot, so that one fleet has them all."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

import numpy as np

from service.fleet.fleet import Array, Fleet
from service.fleet.vehicles import ALWAYS, Span

_LENIENT = 1e-9  # of the largest time: more than roundings, and less than anything real


@dataclass(frozen=True, eq=False)
class SlottedFleet:
    """A fleet with an order that may be visited at any time, and a copy of it for each slot.

    Args:
        fleet: The fleet, with the copies as its last stops.
        order: The order that may be visited at any time.
        slots: When the visit may begin, from and to: one for each copy.
        scale: The unit of each objective, shape (m,).
    """

    fleet: Fleet
    order: int
    slots: tuple[Span, ...]
    scale: Array

    def copy(self, slot: int) -> int:
        """Return the stop that is the order in a slot, by the number of the slot."""
        return self.fleet.rules.n - len(self.slots) + slot

    @cached_property
    def lenient(self) -> float:
        """A time that is less than any real difference, and more than that of roundings."""
        times = [time for span in self.fleet.rules.spans for time in span if time < inf]
        return _LENIENT * max((1.0, *times))


def with_slots(fleet: Fleet, order: int, slots: Sequence[Span]) -> SlottedFleet:
    """Return a fleet with a copy of a stop for each slot. No copy has to be visited.

    The order itself keeps its prize, without which a fleet may have no prizes to measure. All
    plans leave it out, so it changes no difference between them.
    """
    visits = list(fleet.rules.visits)
    visits[order] = replace(visits[order], windows=(ALWAYS,))
    copies = [replace(visits[order], windows=(slot,), prize=None) for slot in slots]
    of_order = (order,) * len(slots)
    rules = replace(fleet.rules, visits=(*visits, *copies), copies=of_order)
    chosen = np.array([*range(fleet.rules.n), *of_order])
    return SlottedFleet(fleet.chosen(rules, chosen), order, tuple(slots), fleet.scale)
