"""Offers: the slots in which an order can be promised, and what each costs the plan."""

from collections.abc import Mapping
from typing import Annotated, Any

from paretour.described import Lengths, Shape, answer, member
from paretour.expect import Members, read_rest
from paretour.fronts import FleetObjective, Objective
from paretour.plans import Reason


@answer("ChoiceItem")
class OfferChoice:
    """A place for the order in the plan, and its price."""

    rise: Lengths = member("what each length of the plan grows by")
    vehicle: str = member("the id of the type of the vehicle")
    shift: int | None = member("the number of its shift, if its vehicle has several", default=None)
    route: int | None = member(
        "the number of its route in the plan; none for a vehicle that does not leave without the"
        " order",
        default=None,
    )
    after: str | None = member(
        "the stop before the order; none where the route begins there", default=None
    )
    arrival: float = member("when the vehicle arrives; it waits until the slot begins")


@answer("OfferItem")
class Offer:
    """Whether the order can be visited in a slot, and at what price."""

    slot: Annotated[tuple[float, ...], Shape(2)] = member("when the visit may begin, from and to")
    possible: bool
    complete: bool = member(
        "false where the time did not suffice for all places: another may be better", default=True
    )
    rise: Lengths | None = member(
        "the least that each length of the plan grows by: each of its own choice", default=None
    )
    choices: tuple[OfferChoice, ...] = member(
        "the places of which none is better in all objectives, up to five; the first one is the"
        " best compromise",
        default=(),
    )
    replan: Mapping[str, Any] | None = member(
        "takes the offer: the request for `POST /front/{id}/replan` that adds the order in this"
        " slot",
        default=None,
    )
    reasons: tuple[Reason, ...] = member(
        "if it is not possible: for each type of vehicles the rule that forbids it", default=()
    )


@answer("OffersAnswer")
class Offers:
    """The offers of an order beside the plan that is driven, in the order of the slots."""

    front: str = member("the front's id")
    plan: int = member("the number of the plan that is driven")
    objectives: tuple[FleetObjective, ...]
    clock: Objective = member("the name and unit of all times")
    lengths: Lengths = member("of the plan from now on, without the order")
    unassigned: tuple[str, ...] = member("the ids of stops that the plan leaves out")
    offers: tuple[Offer, ...]
    timings_ms: Mapping[str, float] = member(default={}, always=True)
    document: Mapping[str, Any] = member("the whole answer", named="")

    @property
    def possible(self) -> tuple[Offer, ...]:
        """The offers that can be made, in the order of their slots."""
        return tuple(offer for offer in self.offers if offer.possible)


def parse_offers(answer: Members) -> Offers:
    """Return the offers in a JSON answer of the service.

    Raises:
        UnexpectedAnswer: A member is missing or wrong.
    """
    return read_rest(Offers, answer, {"document": answer.document})
