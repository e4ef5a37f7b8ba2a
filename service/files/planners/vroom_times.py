"""Read how long the tasks of VROOM's JSON take, and what they bring or take away."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from service.files.fleets import Stop
from service.files.json_files.records import is_number
from service.files.reading import Source


class VroomTask(NamedTuple):
    """A job, or a step of a shipment, and the stop that it became."""

    task: Mapping[str, Any]
    of: str  # jobs, or steps of shipments
    where: str
    stop: Stop
    place: str  # by which tasks at one place are known


def add_services(
    source: Source,
    vehicles: Sequence[tuple[str, str]],
    tasks: Sequence[VroomTask],
    depots: set[str],
) -> None:
    """Add to stops how long their visits take: the set-up, and the service.

    VROOM asks for one set-up where a vehicle visits several tasks at one place in a row.

    Args:
        vehicles: The id and the type of each vehicle. Types may have times of their own.
        depots: The places where vehicles start.

    Raises:
        UnreadableFile: A time is not a number.
    """
    shared = Counter(each.place for each in tasks)
    types = list(dict.fromkeys(kind for _, kind in vehicles))
    for each in tasks:
        services, setups = (_times(source, each, name, types) for name in ("service", "setup"))
        taken = {kind: services[kind] + setups[kind] for kind in types}
        usual = taken[types[0]]
        own = [(name, taken[kind]) for name, kind in vehicles if taken[kind] != usual]
        if usual:
            each.stop["service"] = usual
        if own:
            each.stop["services"] = [{"vehicle": name, "service": time} for name, time in own]
        if any(setups.values()) and (shared[each.place] > 1 or each.place in depots):
            text = "is part of each service here, also where tasks at one place follow each other"
            source.note_once("times", f"setup of {each.of} {text}.")


def _times(source: Source, task: VroomTask, name: str, types: Sequence[str]) -> dict[str, Any]:
    """Return a time of a task by the types of vehicles."""
    usual, of_types = task.task.get(name) or 0, task.task.get(f"{name}_per_type") or {}
    if not isinstance(of_types, dict):
        raise source.refusal("not-an-object", f"{task.where}/{name}_per_type", came=of_types)
    found = {kind: of_types.get(kind, usual) for kind in types}
    for value in found.values():
        if not is_number(value):
            raise source.refusal("no-seconds", f"{task.where}/{name}", came=value)
    return found


def load_of_jobs(problem: Mapping[str, Any]) -> str:
    """Return the member that is the demand of jobs: delivery; or pickup if there is nothing else.

    Vehicles that only bring things back have room for as much as those that only take things along.
    """
    found = problem.get("jobs")
    jobs = [each for each in found if isinstance(each, dict)] if isinstance(found, list) else []
    if not any(each.get("pickup") not in (None, []) and each["pickup"] != [0] for each in jobs):
        return "delivery"
    brought = any(each.get("delivery") or each.get("amount") for each in jobs)
    return "delivery" if brought or problem.get("shipments") else "pickup"
