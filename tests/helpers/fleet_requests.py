"""A request of POST /fleet, and the fleet that it is about."""

from typing import Any

import numpy as np

from service.fleet.fleet import Fleet
from service.requests.fleet import parse_fleet_request
from service.requests.limits import Limits

STOPS = 8
LIMITS = Limits(body_bytes=10**6, cities=50, cells=900, preferences=20, size=30, seconds=0.2)


def fleet_request() -> dict[str, Any]:
    """Return a request that uses every field: two vans and a bike, windows, a prize, a shipment."""
    random = np.random.default_rng(1)
    locations = random.uniform((24.9, 60.15), (25.0, 60.2), (STOPS, 2)).tolist()
    minutes = random.integers(1, 20, (STOPS, STOPS)).astype(float).tolist()
    stops: list[dict[str, Any]] = [
        {"id": f"stop-{i}", "location": location} for i, location in enumerate(locations)
    ]
    stops[1] |= {"demand": [2], "service": 3, "window": [480, 600]}
    stops[2] |= {"demand": [1], "prize": 4000}
    stops[3] |= {"demand": [3]}
    return {
        "stops": stops,
        "shipments": [{"pickup": "stop-3", "delivery": 4}],
        "vehicles": [
            {
                "id": "van",
                "count": 2,
                "start": "stop-0",
                "end": "stop-0",
                "capacity": [5],
                "shift": [470, 700],
                "longest": 200,
                "fixed": 50,
            },
            {"id": "bike", "start": "stop-0", "capacity": [2]},
        ],
        "objectives": [
            {"name": "distance", "from": "great_circle"},
            {"name": "time", "unit": "min", "matrix": minutes, "over": "max"},
        ],
        "clock": "time",
        "time_limit": 0.15,
        "size": 20,
        "seed": 1,
    }


def fleet_of(request: dict[str, Any]) -> Fleet:
    """Return the fleet of a request."""
    import json

    return parse_fleet_request(json.dumps(request).encode(), LIMITS).subject().fleet()
