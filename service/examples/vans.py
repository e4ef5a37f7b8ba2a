"""Deliveries in central Helsinki by six vans, some within an hour that the customer named.

Stops and times of driving are those of the example with one van.
"""

from typing import Any

import numpy as np

VANS = 6
CAPACITY = 24  # parcels
OPENS, CLOSES = 8 * 3600, 12 * 3600  # when the first van may leave, and the last must be back
_SERVICE = 240  # seconds at a customer
_TIMED = 3  # every third customer has named an hour


def vans(one_van: dict[str, Any]) -> dict[str, Any]:
    """Return the request for a fleet at the stops of a request for one van."""
    random = np.random.default_rng(6)
    depot, *customers = one_van["stops"]
    seconds = one_van["objectives"][0]["matrix"]
    return {
        "stops": [
            depot,
            *(_order(customer, number, random) for number, customer in enumerate(customers)),
        ],
        "vehicles": [
            {
                "id": "van",
                "count": VANS,
                "start": depot["id"],
                "end": depot["id"],
                "capacity": [CAPACITY],
                "shift": [OPENS, CLOSES],
            }
        ],
        "objectives": [
            {"name": "driving", "unit": "s", "matrix": seconds},
            {"name": "longest route", "unit": "s", "matrix": seconds, "over": "max"},
        ],
        "clock": "longest route",
        "time_limit": 3,
    }


def _order(customer: dict[str, Any], number: int, random: np.random.Generator) -> dict[str, Any]:
    """Return a customer with an order of one to three parcels, and maybe an hour."""
    begin = OPENS + 1800 * int(random.integers(1, 5))
    window = {"window": [begin, begin + 3600]} if number % _TIMED == 0 else {}
    parcels = int(random.integers(1, 4))
    return {**customer, "demand": [parcels], "service": _SERVICE, **window}
