"""Offers: the slots in which an order can be promised, and what each costs the plan."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from paretour.expect import Members, members, value_of
from paretour.fronts import Array, Objective
from paretour.plans import Reason


def _object(value: Any, where: str) -> Mapping[str, Any]:
    return members(value, where).document


@dataclass(frozen=True, kw_only=True, eq=False)
class OfferChoice:
    """A place for the order in the plan.

    Attributes:
        rise: What each length of the plan grows by, shape (m,).
        vehicle: The id of the type of the vehicle.
        arrival: When it arrives; it waits until the slot begins.
        route: The number of its route in the plan; None for a vehicle that does not leave without
            the order.
        after: The stop before the order; None where the route begins there.
        shift: The number of its shift, if its vehicle has several.
    """

    rise: Array
    vehicle: str
    arrival: float
    route: int | None = None
    after: str | None = None
    shift: int | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Offer:
    """Whether the order can be visited in a slot, and at what price.

    Attributes:
        slot: When the visit may begin, from and to.
        possible: Whether some vehicle can visit it then.
        complete: Whether all places were tried. If not, another may be better.
        rise: The least that each length of the plan grows by, shape (m,); None if not possible.
        choices: The places of which none is better in all objectives; the first one is the best
            compromise.
        replan: Takes the offer: the members for `replan_fleet` that add the order in this slot.
        reasons: If it is not possible, for each type of vehicles the rule that forbids it.
    """

    slot: tuple[float, ...]
    possible: bool
    complete: bool = True
    rise: Array | None = None
    choices: tuple[OfferChoice, ...] = ()
    replan: Mapping[str, Any] | None = field(default=None, metadata={"read": lambda _: _object})
    reasons: tuple[Reason, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class Offers:
    """The offers of an order beside the plan of a fleet that is driven.

    Attributes:
        front: The id of the front.
        plan: The number of the plan.
        objectives: The objectives, as the request for the front named them.
        clock: The name and unit of all times.
        lengths: The lengths of the plan from now on, without the order, shape (m,).
        unassigned: The ids of the stops that the plan leaves out.
        offers: One for each slot, in their order.
        document: The answer of the service.
    """

    front: str
    plan: int
    objectives: tuple[Objective, ...]
    clock: Objective
    lengths: Array
    unassigned: tuple[str, ...]
    offers: tuple[Offer, ...]
    document: Mapping[str, Any] = field(metadata={"read": lambda _: _object})

    @property
    def possible(self) -> tuple[Offer, ...]:
        """The offers that can be made, in the order of their slots."""
        return tuple(offer for offer in self.offers if offer.possible)


def parse_offers(answer: Members) -> Offers:
    """Return the offers in a JSON answer of the service.

    Raises:
        UnexpectedAnswer: A member is missing or wrong.
    """
    rest = {**answer.document, "document": answer.document}
    return value_of(Offers)(rest, answer.where)
