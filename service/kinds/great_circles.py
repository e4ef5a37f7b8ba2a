"""The remedy of tours by road where no routing engine is configured: great circles."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from pydantic_core import from_json, to_json

from service.errors import Refusal, Remedy
from service.remedies.patch import Operation, put
from service.requests.stops import ROAD_MEASURES
from service.requests.task import Task, TaskSource

_SPEED = 30.0  # km/h, about that of vans in a city


def with_great_circles(
    refusal: Refusal, source: TaskSource, parse: Callable[[TaskSource], Task]
) -> Refusal:
    """Return a refusal with great circles as a remedy, if a request for tours needs roads alone."""
    if refusal.code != "no-router" or source.kind != "front":
        return refusal
    request = from_json(source.body)
    patch: list[Operation] = []
    for index, objective in enumerate(request["objectives"]):
        members = _without_roads(objective)
        objective.update(members)
        patch += [put(f"/objectives/{index}/{name}", value) for name, value in members.items()]
    try:
        parse(replace(source, body=to_json(request)))
    except Refusal:
        return refusal
    return refusal.with_remedies([Remedy("great-circles", tuple(patch), {"speed": _SPEED})])


def _without_roads(objective: Mapping[str, Any]) -> dict[str, Any]:
    """Return what replaces a measure by road: nothing if an objective has none."""
    measure = objective.get("from")
    if measure not in ROAD_MEASURES or objective.get("traffic") is not None:
        return {}
    return {"from": "great_circle", **({"speed": _SPEED} if measure == "road_time" else {})}
