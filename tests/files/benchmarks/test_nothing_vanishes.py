"""Every documented keyword of LKH and VRPLIB, and member of VROOM, changes or says something."""

import json
from typing import Any

import pytest

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, UnreadableFile
from tests.files.benchmarks.test_vrplib import text
from tests.files.planners.test_vroom_members import CARS, problem

# The keywords of LKH-3's ReadProblem and of PyVRP's page on VRPLIB, each with a value.
HEADS = {
    **dict.fromkeys(("CAPACITY", "DISTANCE", "MAX_DURATION", "RISK_THRESHOLD"), "7"),
    **dict.fromkeys(("SALESMEN", "VEHICLE", "VEHICLES", "EXTERNAL_SALESMEN"), "2"),
    **dict.fromkeys(("SERVICE_TIME", "RELEASE_TIME", "SCALE", "DEMAND_DIMENSION"), "3"),
    **dict.fromkeys(("VEHICLES_MAX_DISTANCE", "VEHICLES_MAX_DURATION"), "80"),
    **dict.fromkeys(("VEHICLES_MAX_RELOADS", "VEHICLES_FIXED_COST"), "4"),
    **dict.fromkeys(("VEHICLES_UNIT_DISTANCE_COST", "COST_LIMIT", "ENERGY_CAPACITY"), "5"),
    "TYPE": "TSPTW",
    "EDGE_WEIGHT_TYPE": "MAN_2D",
}
OF_NODES = "1 0\n2 3\n3 4\n4 5\n"
OF_VEHICLES = "1 2\n2 3\n"
SECTIONS = {
    **dict.fromkeys(("BACKHAUL", "SERVICE_TIME", "RELEASE_TIME", "PRIZE"), OF_NODES),
    **dict.fromkeys(("DRAFT_LIMIT", "NODE_SCORE", "LINEHAUL", "STAND_TIME"), OF_NODES),
    **dict.fromkeys(("CTSP_SET", "GTSP_SET", "GVRP_SET", "MUTUALLY_EXCLUSIVE_GROUP"), "1 2 3 -1\n"),
    **dict.fromkeys(("REQUIRED_NODES", "FIXED_EDGES", "TOUR"), "1\n2\n-1\n"),
    "TIME_WINDOW": "1 0 90\n2 0 50\n3 0 50\n4 0 50\n",
    "PICKUP_AND_DELIVERY": "1 0 0 0 0 0 0\n2 1 0 0 0 0 3\n3 -1 0 0 0 2 0\n4 1 0 0 0 0 0\n",
    "EDGE_DATA": "1 2\n-1\n",
    "VEHICLES_ALLOWED_CLIENTS": "1 2 3\n2 3 4\n",
    "VEHICLES_RELOAD_DEPOT": "1 1\n2 1\n",
    "VEHICLES_DEPOT": "1 1\n2 2\n",
    **{f"VEHICLES_{each}": OF_VEHICLES for each in ("MAX_DISTANCE", "MAX_DURATION")},
    **{f"VEHICLES_{each}": OF_VEHICLES for each in ("MAX_RELOADS", "FIXED_COST")},
    **{f"VEHICLES_{each}": OF_VEHICLES for each in ("UNIT_DISTANCE_COST", "CAPACITY")},
    "CAPACITY": "1 9\n2 8\n",
}


def outcome(name: str, content: str) -> Any:
    """What a file becomes: its request with its notes, or the sentence that refuses it."""
    try:
        reading = read_files([NamedFile(name, content.encode())], Bounds(), wanted=None)
    except UnreadableFile as error:
        return str(error)
    return reading.request, [note.text for note in reading.notes], reading.details


@pytest.mark.parametrize("name", HEADS)
def test_no_keyword_vanishes(name: str) -> None:
    plain = text()
    lines = [line for line in plain.splitlines() if not line.startswith(f"{name} ")]
    changed = "\n".join([f"{name} : {HEADS[name]}", *lines])
    assert outcome("a.vrp", changed) != outcome("a.vrp", plain)


@pytest.mark.parametrize("name", SECTIONS)
def test_no_section_vanishes(name: str) -> None:
    plain = text("VEHICLES : 2\n")
    changed = text("VEHICLES : 2\n", f"{name}_SECTION\n{SECTIONS[name]}")
    assert outcome("a.vrp", changed) != outcome("a.vrp", plain)


JOB = {
    **{"setup": 5, "service": 5, "setup_per_type": {"": 5}, "service_per_type": {"": 5}},
    **{"amount": [1], "delivery": [1], "pickup": [1], "skills": [1], "priority": 5},
    **{"time_windows": [[0, 5]], "description": "bell"},
}
VEHICLE = {
    **{"capacity": [3], "skills": [1], "time_window": [0, 9], "speed_factor": 2},
    **{"max_tasks": 1, "max_travel_time": 5, "max_distance": 5, "steps": [{"type": "start"}]},
    **{"profile": "bike", "breaks": [{"id": 1, "time_windows": [[0, 9]], "max_load": [1]}]},
    "costs": {"fixed": 5},
}
RATES = {"per_hour": 5, "per_km": 5, "per_task_hour": 5}
MEMBERS = [
    *(({}, {name: value}, {}) for name, value in JOB.items()),
    *(({name: value}, {}, {}) for name, value in VEHICLE.items()),
    *(({"costs": {name: value}}, {}, CARS) for name, value in RATES.items()),
    *(({"costs": {name: value}}, {}, {}) for name, value in RATES.items()),
]


@pytest.mark.parametrize(("vehicle", "job", "members"), MEMBERS)
def test_no_member_of_vroom_vanishes(
    vehicle: dict[str, Any], job: dict[str, Any], members: dict[str, Any]
) -> None:
    plain = outcome("a.json", json.dumps(problem(**members)))
    assert outcome("a.json", json.dumps(problem(vehicle, job, **members))) != plain
