"""Name the members of VROOM's JSON that are read, and note every other one that is given."""

from collections.abc import Iterable, Mapping
from typing import Any

from service.files.reading import Source

_MOST_NAMED, _LONGEST_SHOWN = 20, 60
_STEP = {
    *("id", "description", "location", "location_index"),
    *("setup", "service", "setup_per_type", "service_per_type", "time_windows"),
}
_READ: Mapping[str, set[str]] = {
    "the problem": {"jobs", "shipments", "vehicles", "matrices", "matrix"},
    "jobs": _STEP | {"amount", "delivery", "pickup", "skills"},
    "shipments": {"pickup", "delivery", "amount", "skills"},
    "steps of shipments": _STEP,
    "vehicles": {
        *("id", "profile", "description", "start", "start_index", "end", "end_index"),
        *("capacity", "costs", "skills", "type", "time_window", "breaks", "speed_factor"),
        *("max_tasks", "max_travel_time", "max_distance"),
    },
    "costs of vehicles": {"fixed", "per_hour", "per_km"},
    "breaks of vehicles": {"id", "description", "service", "time_windows"},
    "matrices": {"durations", "distances", "costs"},
}


def note_others(source: Source, items: Iterable[Mapping[str, Any]], of: str) -> None:
    """Note each member of objects that is not read, once for all of them.

    Args:
        of: What the objects are, such as jobs.
    """
    others = {
        name: None
        for item in items
        for name, value in item.items()
        if name not in _READ[of] and value not in (None, 0, [], {}, False)
    }
    for name in list(others)[:_MOST_NAMED]:
        note_unused(source, name, of)
    if len(others) > _MOST_NAMED:
        note_unused(source, f"{len(others) - _MOST_NAMED} more members", of)


def note_unused(source: Source, name: str, of: str, why: str = "") -> None:
    """Note a member that is not used, and why, if that is not the same for all fleets."""
    because = f": {why}." if why else ": it is not supported for fleets."
    source.note_once("left-out", f"{name[:_LONGEST_SHOWN]} of {of} was not used{because}")
