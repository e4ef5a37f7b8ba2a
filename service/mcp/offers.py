"""Write the offers of an order as a JSON text that is short enough for an agent to read."""

from collections.abc import Sequence
from typing import Any

from paretour import Offer, Offers

from service.amounts.said import amount, clock_time
from service.mcp.summaries import MOST_BYTES, as_text

_HINT = (
    "nothing is changed yet: to take an offer, call replan with the same arguments without slots"
    " and every, and with the order in add, together with its window"
)


def offers_text(offers: Offers, assumed: Sequence[str] = ()) -> str:
    """Return the text of offers: each slot that is possible with its price, and why others are not.

    Args:
        assumed: Sentences that say how the day so far was read.
    """
    possible = [_possible(offers, each) for each in offers.possible]
    not_possible = [_not_possible(offers, each) for each in offers.offers if not each.possible]
    count = f"{len(possible)} of {len(offers.offers)} slots are possible"
    document: dict[str, Any] = {
        "summary": count,
        "front": offers.front,
        "plan": offers.plan,
        "slots": possible,
        "not_possible": not_possible,
        "hint": _HINT,
    }
    if assumed:
        document["assumed"] = list(assumed)
    if offers.unassigned:
        document["left_out"] = list(offers.unassigned)
    for name in ("left_out", "not_possible", "slots"):
        while len(as_text(document).encode()) > MOST_BYTES and document.get(name):
            document[name] = document[name][:-1]
            document["shortened"] = "some slots are not in this text: ask for fewer"
    return as_text(document)


def _possible(offers: Offers, offer: Offer) -> dict[str, Any]:
    found = {
        "slot": _slot(offers, offer),
        "window": list(offer.slot),
        "rise": _rise(offers, offer.rise),
        "best": [
            {
                "rise": _rise(offers, choice.rise),
                "vehicle": choice.vehicle,
                "route": "new" if choice.route is None else choice.route,
                "after": choice.after,
                "arrives": clock_time(choice.arrival, offers.clock.unit),
            }
            for choice in offer.choices[:2]
        ],
    }
    return found if offer.complete else {**found, "complete": False}


def _not_possible(offers: Offers, offer: Offer) -> dict[str, Any]:
    reasons = [f"{each.vehicle}: {each.rule}, {each.detail}" for each in offer.reasons[:3]]
    return {"slot": _slot(offers, offer), "reasons": reasons}


def _slot(offers: Offers, offer: Offer) -> list[Any]:
    return [clock_time(time, offers.clock.unit) for time in offer.slot]


def _rise(offers: Offers, rise: Any) -> dict[str, str]:
    """Return what each length grows by, in words, as "12 min" or "-3.4 km"."""
    pairs = zip(offers.objectives, rise.tolist(), strict=True)
    return {
        each.name: f"{'-' if grown < 0 else ''}{amount(abs(grown), each.unit)}"
        for each, grown in pairs
    }
