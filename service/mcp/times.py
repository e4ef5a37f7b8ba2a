"""Read the times in the members of a request that agents may write as texts, as "10:00"."""

from collections.abc import Mapping, Sequence
from typing import Any

from service.amounts.read import number_in

# The members of requests that are times or durations, in the unit of the clock.
TIMED = frozenset(
    (
        *("arrivals", "at", "departure", "driving", "due", "earliest", "latest", "leaves"),
        *("length", "longest", "max_driving", "max_overtime", "now", "over_the_day", "release"),
        *("service", "shift", "shifts", "shortest", "slack", "slots", "tolerance", "window"),
        "windows",
    )
)
# What such members may be in; below other members the same names mean something else.
_HOLDERS = frozenset(
    (
        *("add", "breaks", "changes", "clock", "departure", "objectives", "order", "position"),
        *("promised", "routes", "services", "stops", "traffic", "vehicles"),
    )
)
# Members whose own members are times under names that mean something else elsewhere.
_OWN = {"every": ("from", "to", "length", "step"), "slices": ("from",)}


def with_times(members: Mapping[str, Any], unit: str | None) -> dict[str, Any]:
    """Return the members of a request with numbers, in a unit, for the times that are texts.

    Raises:
        ValueError: As of `number_in`.
    """
    return {name: _member(name, value, unit) for name, value in members.items()}


def _member(name: str, value: Any, unit: str | None) -> Any:
    """Return a member of a request with numbers for the times in it that are texts."""
    if name in _OWN:
        return _own(value, _OWN[name], unit)
    if name in TIMED and not isinstance(value, Mapping):
        return _numbers(value, unit)
    return _inside(value, unit) if name in _HOLDERS else value


def _own(value: Any, names: Sequence[str], unit: str | None) -> Any:
    if isinstance(value, list):
        return [_own(each, names, unit) for each in value]
    if not isinstance(value, Mapping):
        return value
    return {name: _numbers(x, unit) if name in names else x for name, x in value.items()}


def _inside(value: Any, unit: str | None) -> Any:
    if isinstance(value, list):
        return [_inside(each, unit) for each in value]
    return with_times(value, unit) if isinstance(value, Mapping) else value


def _numbers(value: Any, unit: str | None) -> Any:
    if isinstance(value, list):
        return [_numbers(each, unit) for each in value]
    return number_in(value, unit) if isinstance(value, str) else value


def clock_unit(request: Mapping[str, Any]) -> str | None:
    """Return the unit of the clock in a request for a fleet that is not checked yet."""
    clock, objectives = request.get("clock"), request.get("objectives")
    named = [each for each in objectives or () if isinstance(each, Mapping)]
    found = next((each for each in named if each.get("name") == clock), clock)
    if not isinstance(found, Mapping):
        return None
    measured = "s" if found.get("from") == "road_time" or found.get("speed") is not None else None
    unit = found.get("unit") or measured
    return unit if isinstance(unit, str) else None
