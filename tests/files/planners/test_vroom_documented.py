"""Every member that VROOM's API documents: it changes what is planned, or a note names it."""

from typing import Any

import pytest
from pydantic_core import to_json

from service.kinds.parsing import parse_task
from service.requests.task import TaskSource
from tests.files.planners.test_vroom_members import (
    CARS,
    FAR,
    METRES,
    NEAR,
    SECONDS,
    Members,
    notes,
    problem,
    read,
)
from tests.files.test_examples import ACTORS
from tests.helpers.serving import LIMITS

SHIPMENT = {
    "pickup": {"id": 7, "location": NEAR, "service": 60},
    "delivery": {"id": 8, "location": FAR, "time_windows": [[0, 9000]]},
    "amount": [1],
}
BREAK = {"id": 1, "time_windows": [[3600, 7200]], "service": 900}
VEHICLE: dict[str, Any] = {
    "profile": "bike",
    "description": "the red one",
    "start": NEAR,
    "end": FAR,
    "capacity": [5],
    "costs": {"fixed": 60},
    "skills": [1, 2],
    "time_window": [0, 36_000],
    "breaks": [BREAK],
    "speed_factor": 1.4,
    "max_tasks": 2,
    "max_travel_time": 7200,
    "max_distance": 50_000,
    "steps": [{"type": "job", "id": 2}, {"type": "job", "id": 1, "service_after": 600}],
}
COSTS = {"per_hour": 5000, "per_km": 20, "per_task_hour": 1800}
JOB: dict[str, Any] = {
    "description": "ring twice",
    "setup": 120,
    "service": 300,
    "delivery": [2],
    "amount": [2],
    "skills": [1],
    "priority": 40,
    "setup_per_type": {"bike": 60},
    "service_per_type": {"bike": 200},
    "time_windows": [[0, 3600], [7200, 9000]],
}
STEP = {**JOB, "time_windows": [[0, 3600]]}
OF_STEPS = ("setup", "service", "setup_per_type", "service_per_type", "time_windows", "description")
ABLE = {"capacity": [5], "skills": [1], "type": "bike"}


def of_break(**members: Any) -> Members:
    return problem({"breaks": [{**BREAK, **members}]})


def of_shipment(role: str, **members: Any) -> Members:
    shipment: Members = {**SHIPMENT, role: {**SHIPMENT[role], **members}}  # type: ignore[dict-item]
    return problem(ABLE, shipments=[shipment])


# By the member, a problem with it and the same without.
PAIRS: dict[str, tuple[Members, Members]] = {
    **{f"vehicles {name}": (problem({name: value}), problem()) for name, value in VEHICLE.items()},
    **{
        f"costs {name}": (problem({"costs": {name: value}}, **CARS), problem(**CARS))
        for name, value in COSTS.items()
    },
    "vehicles type": (
        problem({"type": "bike"}, {"service_per_type": {"bike": 90}}),
        problem(None, {"service_per_type": {"bike": 90}}),
    ),
    "breaks service": (of_break(service=60), of_break()),
    "breaks time_windows": (of_break(time_windows=[[0, 9], [60, 90]]), problem()),
    "breaks max_load": (of_break(max_load=[0]), of_break()),
    "breaks description": (of_break(description="lunch"), of_break()),
    **{
        f"jobs {name}": (problem(ABLE, {name: value}), problem(ABLE)) for name, value in JOB.items()
    },
    "jobs pickup": (problem(ABLE, {"pickup": [2]}), problem(ABLE)),
    "jobs pickup and delivery": (
        problem(ABLE, {"pickup": [2], "delivery": [1]}),
        problem(ABLE, {"delivery": [1]}),
    ),
    "shipments amount": (
        problem(ABLE, shipments=[{**SHIPMENT, "amount": [3]}]),
        of_shipment("pickup"),
    ),
    "shipments skills": (
        problem(ABLE, shipments=[{**SHIPMENT, "skills": [1]}]),
        of_shipment("pickup"),
    ),
    "shipments priority": (
        problem(ABLE, shipments=[{**SHIPMENT, "priority": 9}]),
        of_shipment("pickup"),
    ),
    **{
        f"{role} {name}": (of_shipment(role, **{name: STEP[name]}), of_shipment(role))
        for role in ("pickup", "delivery")
        for name in OF_STEPS
    },
    "matrices of two profiles": (
        problem(matrices={"car": {"durations": SECONDS}, "bike": {"durations": METRES}}),
        problem(matrices={"car": {"durations": SECONDS}}),
    ),
    **{
        f"matrices {name}": (
            problem(matrices={"car": {"durations": SECONDS, name: METRES}}),
            problem(matrices={"car": {"durations": SECONDS}}),
        )
        for name in ("distances", "costs")
    },
    "a member of no release": (problem({"colour": "red"}), problem()),
}
# Names of breaks and vehicles are nothing to plan by.
UNSAID = {"vehicles description", "breaks description"}


@pytest.mark.parametrize("name", [name for name in PAIRS if name not in UNSAID])
def test_a_documented_member_changes_the_request_or_is_noted(name: str) -> None:
    given, without = (read(each) for each in PAIRS[name])
    task = parse_task(TaskSource("fleet", to_json(given.request)), LIMITS, ACTORS)
    assert task.stops is not None
    said = {note.text for note in given.notes} - {note.text for note in without.notes}
    member = name.split()[-1]
    told = [text for text in said if member in text or "not used" in text or "left out" in text]
    assert given.request != without.request or told or given.details != without.details, notes(
        given
    )
