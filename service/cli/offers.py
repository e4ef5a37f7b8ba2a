"""Print in which slots an order can be promised, and what each costs the plan that is driven."""

import json
from pathlib import Path
from typing import cast

from paretour import Offer, Offers, OffersRequest
from rich.console import Console

from service.amounts.said import clock_time
from service.cli.backends import RemoteBackend
from service.cli.data import print_data
from service.cli.errors import exit_on_error
from service.cli.inputs import read_object
from service.cli.output import table_of
from service.errors.printable import printable


def run_offers(front: str, asked: Path, as_json: bool, backend: RemoteBackend) -> None:
    """Ask a service for offers, and print them.

    Args:
        front: The id of a front of the service.
        asked: A file with the order, the slots, and what has changed, as JSON.
        as_json: Whether to print the answer as the service gives it.
        backend: The service.
    """
    with exit_on_error():
        request = cast(OffersRequest, read_object(asked))
        offers = backend.offers(front, request)
    if as_json:
        print_data(json.dumps(offers.document))
        return
    labels = [printable(each.label) for each in offers.objectives]
    headings = ("from", "to", *(f"{each}, more" for each in labels), "vehicle", "after", "arrives")
    rows = (_row(offers, offer) for offer in offers.possible)
    console = Console()
    console.print(table_of(headings, rows))
    for offer in offers.offers:
        if not offer.possible:
            begin, end = (clock_time(time, offers.clock.unit) for time in offer.slot)
            reasons = "; ".join(f"{each.vehicle}: {each.detail}" for each in offer.reasons)
            console.print(
                f"{begin} to {end}: not possible. {printable(reasons)}",
                highlight=False,
                markup=False,
            )


def _row(offers: Offers, offer: Offer) -> list[str]:
    """Return the cells of an offer that is possible: its slot, and the best compromise in it."""
    best, unit = offer.choices[0], offers.clock.unit
    rises = [f"{each:.6g}" for each in best.rise.tolist()]
    times = [str(clock_time(time, unit)) for time in (*offer.slot, best.arrival)]
    return [*times[:2], *rises, printable(best.vehicle), printable(best.after or ""), times[2]]
