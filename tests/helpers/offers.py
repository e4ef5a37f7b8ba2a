"""A fleet whose plan is made by hand, as a front that is stored, to ask it for offers."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
from pydantic_core import to_json

from service.fleet.evaluation import plan_lengths, route_lengths
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route, path_of
from service.fleet.schedule import schedule
from service.jobs.record import Record
from service.kinds.front_document import joined
from service.kinds.parsing import parse_task
from service.requests.limits import Limits
from service.requests.replan.way import StoredFront
from service.requests.task import TaskSource
from service.requests.task_codec import encode_task
from tests.helpers.stores import record

HOUR = 3600
NINE, FIVE = 9 * HOUR, 17 * HOUR
LIMITS = Limits(body_bytes=10**6, cities=50, cells=900, preferences=20, size=30, seconds=60)
_PLACES = np.random.default_rng(4).uniform((24.90, 60.15), (25.00, 60.20), (14, 2)).tolist()
NEW_PLACE = _PLACES[13]
_ROUTES = ((1, 3, 5, 2, 4, 6), (7, 9, 8, 10, 12))


def fleet_request() -> dict[str, Any]:
    """Return a request of orders for the morning or the afternoon, and three vans."""
    orders = [
        {
            "id": f"order-{i}",
            "location": _PLACES[i],
            "demand": [1],
            "service": 600,
            "window": [NINE, 12 * HOUR] if i % 2 else [13 * HOUR, FIVE],
        }
        for i in (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12)
    ]
    van = {"id": "van", "count": 3, "start": "depot", "end": "depot", "capacity": [7]}
    return {
        "stops": [{"id": "depot", "location": _PLACES[0]}, *orders],
        "vehicles": [{**van, "shift": [NINE, FIVE], "fixed": 1000}],
        "objectives": [
            {"name": "distance", "from": "great_circle"},
            {"name": "time", "from": "great_circle", "speed": 30, "over": "max"},
        ],
        "clock": "time",
    }


def stored_fleet(request: dict[str, Any]) -> Record:
    """Return the record of a front with one plan of two routes."""
    task = parse_task(TaskSource("fleet", json.dumps(request).encode()), LIMITS, {})
    subject: Any = task.subject
    fleet, ids = subject.fleet(), [stop["id"] for stop in request["stops"]]
    routes = [
        Route(0, tuple(ids.index(f"order-{number}") for number in numbers)) for numbers in _ROUTES
    ]
    plan = {
        "lengths": plan_lengths(fleet, Plan(tuple(routes))),
        "routes": [
            {
                "vehicle": "van",
                "stops": [ids[stop] for stop in path_of(fleet.rules, route)],
                "lengths": route_lengths(fleet, route),
                **_times(fleet, route),
            }
            for route in routes
        ],
    }
    tours, ends = joined([to_json(plan)])
    made = record("the-front", caller="anonymous")
    lengths = np.array([plan["lengths"]])
    front = replace(made.front, kind="fleet", tours=tours, ends=ends, lengths=lengths)
    return replace(made, front=front, task=encode_task(task))


def _times(fleet: Fleet, route: Route) -> dict[str, Any]:
    return {} if fleet.rules.clock is None else {"arrivals": schedule(fleet, route).arrivals}


def as_stored(made: Record) -> StoredFront:
    """Return the front of a record, as it is read from the store."""
    assert made.task is not None
    return StoredFront(made.id, made.task, made.front)
